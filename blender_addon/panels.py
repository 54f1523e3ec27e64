"""The sidebar tab: draws what is stored, computes nothing."""

from __future__ import annotations

import bpy

from .choices import CUSTOM, FROM_BOXES, REGIONS
from .operators import listed_sensors, offers, running
from .properties import AXIS_LABELS

KIND = "pe_kind"
"""What a button tells its menu, in Blender's context: the kind of sensor to list."""


class Tab:
    """Where all panels are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Perception"


class PE_PT_main(Tab, bpy.types.Panel):
    """Vehicle, sensors, score and search"""

    bl_idname = "PE_PT_main"
    bl_label = "Perception Entropy"

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        self.layout.prop(settings, "vehicle")
        draw_add(self.layout)
        draw_sensors(self.layout, context)
        if running.current is not None:
            draw_progress(self.layout)
        row = self.layout.row()
        row.scale_y = 1.5
        row.operator("pe.score", icon="VIEWZOOM")
        if settings.has_result:
            draw_result(self.layout, settings)
        row = self.layout.row()
        row.scale_y = 1.5
        row.operator("pe.optimize", icon="ORIENTATION_GIMBAL")


def draw_add(layout: bpy.types.UILayout) -> None:
    """Draw for each kind a button for its usual sensor, and a menu of all of them."""
    row = layout.row()
    for offer in offers():
        pair = row.row(align=True)
        pair.operator("pe.add_sensor", text=f"Add {offer.label}", icon="ADD").model = offer.usual
        pair.context_string_set(KIND, offer.kind)
        pair.menu(PE_MT_add_sensor.bl_idname, text="", icon="DOWNARROW_HLT")


def draw_sensors(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw a row for each sensor: beams shown, name, model, entropy alone."""
    objects = listed_sensors(context.scene)
    box = layout.box().column(align=True)
    if not objects:
        box.label(text="No sensors yet", icon="INFO")
    for obj in objects:
        settings = obj.perception_entropy
        row = box.row(align=True)
        eye = "HIDE_OFF" if settings.show else "HIDE_ON"
        row.prop(settings, "show", text="", icon=eye, emboss=False)
        split = row.split(factor=0.38, align=True)
        split.active = obj.visible_get()  # what is hidden is not scored
        active = obj == context.active_object
        split.operator("pe.select_sensor", text=obj.name, depress=active).name = obj.name
        figures = split.split(factor=0.68, align=True)
        figures.label(text=settings.model)
        figures.label(text=f"{settings.entropy:.2f}" if settings.has_result else "")


def draw_progress(layout: bpy.types.UILayout) -> None:
    """Draw how far the running job is, and the button that stops it."""
    row = layout.row()
    row.progress(text=running.current.text, factor=running.current.progress.fraction)
    row.operator("pe.cancel", text="", icon="CANCEL")


def draw_result(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the last result."""
    column = layout.box().column(align=True)
    error = f" ± {settings.result_stderr:.4f}" if settings.result_stderr else ""
    column.label(text=f"Entropy  {settings.result_entropy:.4f}{error} nats", icon="CHECKMARK")
    if settings.result_kind == "optimize":
        column.label(text=f"Before  {settings.result_before:.4f} nats", icon="BLANK1")
    column.label(text=f"Coverage  {settings.result_coverage:.1%}", icon="BLANK1")
    if settings.result_stale:
        column.label(text="Changed since this was scored", icon="ERROR")


class PE_PT_sensor(Tab, bpy.types.Panel):
    """Settings of the sensor that is selected"""

    bl_idname = "PE_PT_sensor"
    bl_label = "Sensor"
    bl_parent_id = "PE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return obj is not None and obj.perception_entropy.is_sensor

    def draw(self, context: bpy.types.Context) -> None:
        obj = context.active_object
        settings = obj.perception_entropy
        layout = self.layout
        layout.prop(settings, "model")
        layout.prop(settings, "fusion")
        layout.label(text=f"The search may change, for {obj.name}:")
        row = layout.row(align=True)
        for index, label in enumerate(AXIS_LABELS):
            row.prop(settings, "free", index=index, text=label, toggle=True)
        if settings.has_result:
            draw_sensor_result(layout, settings)


def draw_sensor_result(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw what the last result says of one sensor."""
    column = layout.box().column(align=True)
    column.label(text=f"Alone  {settings.entropy:.4f} nats, covers {settings.coverage:.1%}")
    if settings.stopped:
        share = settings.stopped / settings.beams
        column.label(text=f"The vehicle stops {share:.1%} of its beams:")
        column.label(text=settings.stopped_text, icon="BLANK1")


class PE_PT_part(Tab, bpy.types.Panel):
    """Settings of the part of the vehicle that is selected"""

    bl_idname = "PE_PT_part"
    bl_label = "Vehicle Part"
    bl_parent_id = "PE_PT_main"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return obj is not None and obj.type != "EMPTY" and not obj.perception_entropy.is_sensor

    def draw(self, context: bpy.types.Context) -> None:
        obj = context.active_object
        self.layout.label(text=obj.name, icon="OBJECT_DATA")
        self.layout.prop(obj.perception_entropy, "see_through")


class PE_PT_search(Tab, bpy.types.Panel):
    """How to score and to search"""

    bl_idname = "PE_PT_search"
    bl_label = "Search"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        boxes = ("boxes",) if settings.prior == FROM_BOXES else ()
        figures = ("candidates", "seed", "search_samples", "score_samples")
        draw_properties(self.layout, settings, ("prior", *boxes, *figures))


class PE_UL_focus(bpy.types.UIList):
    """The focus weights: name, region, factor"""

    def draw_item(
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _settings: bpy.types.PropertyGroup,
        item: bpy.types.PropertyGroup,
        _icon: int,
        _active_data: bpy.types.PropertyGroup,
        _active_property: str,
    ) -> None:
        name, figures = columns(layout, 0.4)
        name.prop(item, "name", text="", emboss=False)
        region, factor = columns(figures, 0.61)
        region.label(text=REGIONS[item.region].short, translate=False)
        factor.alignment = "RIGHT"
        factor.label(text=f"× {item.factor:g}", translate=False)


class PE_PT_focus(Tab, bpy.types.Panel):
    """What counts more than the prior says, or less"""

    bl_idname = "PE_PT_focus"
    bl_label = "Focus"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        count = len(context.scene.perception_entropy.focus)
        self.layout.label(text=str(count or ""), translate=False)  # to be seen also when closed

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        row = layout.row()
        row.template_list(
            PE_UL_focus.__name__, "", settings, "focus", settings, "focus_index", rows=3
        )
        buttons = row.column(align=True)
        buttons.operator("pe.add_focus", text="", icon="ADD")
        buttons.operator("pe.remove_focus", text="", icon="REMOVE")
        if settings.focus_index < len(settings.focus):
            draw_focus(layout, settings.focus[settings.focus_index])


def draw_focus(layout: bpy.types.UILayout, focus: bpy.types.PropertyGroup) -> None:
    """Draw the settings of one focus."""
    draw_properties(layout, focus, ("factor", "region"))
    if focus.region == CUSTOM:
        for name in ("x_range", "y_range"):
            low, high = getattr(focus, name)
            pair = layout.column(align=True)
            pair.alert = low >= high
            label = focus.bl_rna.properties[name].name
            pair.prop(focus, name, index=0, text=f"{label} From")
            pair.prop(focus, name, index=1, text="To")
    layout.column().prop(focus, "classes")


def columns(
    layout: bpy.types.UILayout, factor: float
) -> tuple[bpy.types.UILayout, bpy.types.UILayout]:
    """Return two rows beside each other; the first takes that share of the width."""
    split = layout.split(factor=factor)
    return split.row(), split.row()


class PE_PT_overlay(Tab, bpy.types.Panel):
    """What is drawn in the 3D view"""

    bl_idname = "PE_PT_overlay"
    bl_label = "Overlay"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.perception_entropy, "show_overlay", text="")

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        self.layout.active = settings.show_overlay
        draw_properties(self.layout, settings, ("beam_limit", "beam_length"))


class PE_PT_export(Tab, bpy.types.Panel):
    """Files to take away"""

    bl_idname = "PE_PT_export"
    bl_label = "Export"
    bl_parent_id = "PE_PT_main"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.operator("pe.export_study", icon="EXPORT")
        self.layout.operator("pe.render_review", icon="RENDER_STILL")


def draw_properties(
    layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, names: tuple[str, ...]
) -> None:
    """Draw properties below each other, their names in a column of its own."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    for name in names:
        layout.prop(settings, name)


class PE_MT_add_sensor(bpy.types.Menu):
    """All sensors of this kind in the catalogue"""

    bl_idname = "PE_MT_add_sensor"
    bl_label = "Add Sensor"

    def draw(self, context: bpy.types.Context) -> None:
        kind = getattr(context, KIND, None)  # of none in particular: all
        for offer in offers():
            for name in offer.models if kind in (None, offer.kind) else ():
                self.layout.operator("pe.add_sensor", text=name, translate=False).model = name


CLASSES = (
    PE_MT_add_sensor,
    PE_PT_main,
    PE_PT_sensor,
    PE_PT_part,
    PE_UL_focus,
    PE_PT_search,
    PE_PT_focus,
    PE_PT_overlay,
    PE_PT_export,
)
