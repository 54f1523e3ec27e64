"""The tab's first panel: vehicle, sensors, score and search."""

from __future__ import annotations

import bpy

from ..operators import listed_sensors, offers, running
from .layout import Tab

KIND = "pe_kind"
"""What a button tells its menu, in Blender's context: the kind of sensor to list."""


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
        row.prop(settings.live, "on", toggle=True, icon="REC")
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
)
