"""Which sensors: the models that may take a sensor's place, and the front of price and entropy."""

from __future__ import annotations

import bpy

from .layout import Tab, columns, draw_properties


class PE_PT_selection(Tab, bpy.types.Panel):
    """Which models sit where, or none, at what price"""

    bl_idname = "PE_PT_selection"
    bl_label = "Sensor Choices"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        obj = context.active_object
        if obj is not None and obj.perception_entropy.is_sensor:
            draw_options(layout, obj)
        else:
            layout.label(text="Select a sensor to offer models for", icon="INFO")
        draw_limits(layout.column(), settings)
        layout.operator("pe.choose_sensors", icon="VIEWZOOM")
        if settings.front:
            draw_front(layout, settings)


def draw_options(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    """Draw the models that may take a sensor's place, with their prices."""
    own = obj.perception_entropy
    layout.label(text=obj.name, icon="EMPTY_AXIS", translate=False)
    column = layout.column(align=True)
    for number, option in enumerate(own.options):
        model, price = columns(column, 0.66)
        model.prop(option, "model", text="")
        price.prop(option, "price", text="")
        price.operator("pe.remove_option", text="", icon="REMOVE", emboss=False).index = number
    column.operator("pe.add_option", icon="ADD")
    if own.options:
        layout.prop(own, "may_be_left_out")


def draw_limits(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw what every design keeps to, and beside a limit of 0 that there is none."""
    draw_properties(layout, settings, ("currency",))
    for name in ("max_price", "max_sensors"):
        row = layout.row(align=True)
        row.prop(settings, name)
        if not getattr(settings, name):
            row.label(text="No Limit")


def draw_front(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the front: price, entropy and name, with the way to each design's variant."""
    column = layout.box().column(align=True)
    _row(column.row(), "BLANK1", (settings.currency or "Price", "Entropy", "Design"))
    for row in settings.front:
        icon = "RADIOBUT_ON" if row.key == settings.variant_key else "RADIOBUT_OFF"
        line = column.row()
        figures = (f"{row.price:,.7g}", f"{row.entropy:.2f}", row.name)
        _row(line, icon, figures, row.key)
    column.label(text=settings.front_told, translate=False)


def _row(
    line: bpy.types.UILayout, icon: str, texts: tuple[str, str, str], key: int | None = None
) -> None:
    """Draw a line of the table: a button that switches to the variant, if there is one."""
    if key is None:
        line.label(text="", icon=icon)
        line.active = False
    else:
        line.operator("pe.switch_variant", text="", icon=icon, emboss=False).key = key
    figures, name = columns(line, 0.5)
    for text in texts[:2]:
        cell = figures.row()
        cell.alignment = "RIGHT"
        cell.label(text=text, translate=False)
    name.label(text=texts[2], translate=False)


CLASSES = (PE_PT_selection,)
