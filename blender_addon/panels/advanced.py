"""What is seldom changed: own sensors, AP curves, the space that is scored, clearance."""

from __future__ import annotations

import bpy

from .layout import Tab, draw_properties
from .words import draw_sentence

SCALARS = {
    "lidar": ("channels", "elevations", "azimuths", "azimuth_step", "min_range", "max_range"),
    "camera": ("width", "height", "hfov", "lens"),
}
"""Figures of an own sensor by its kind."""
KIND_LABELS = {"lidar": "LiDAR", "camera": "Camera"}


class PE_UL_own_sensors(bpy.types.UIList):
    """This file's own sensors: name, kind"""

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
        layout.prop(item, "name", text="", emboss=False, icon="ERROR" if item.problem else "NONE")
        layout.label(text=KIND_LABELS[item.kind])


class PE_PT_advanced(Tab, bpy.types.Panel):
    """What is seldom changed: own sensors, AP curves, space, clearance"""

    bl_idname = "PE_PT_advanced"
    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        settings = context.scene.perception_entropy
        draw_own_sensors(self.layout, context)
        draw_curves(self.layout, settings)
        column = self.layout.column()
        column.label(text="Space and Voxels")
        for name in ("space_x", "space_y", "space_z"):
            row = column.row(align=True)
            row.alert = getattr(settings, name)[0] >= getattr(settings, name)[1]
            row.label(text=name[-1].upper())
            row.prop(settings, name, index=0, text="")
            row.prop(settings, name, index=1, text="")
        draw_properties(column, settings, ("space_interval", "clearance"))


def draw_own_sensors(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the file's own sensors, and the figures of the one that is selected."""
    settings = context.scene.perception_entropy
    layout.label(text="Own Sensors")
    row = layout.row()
    name = PE_UL_own_sensors.__name__
    row.template_list(name, "", settings, "own_sensors", settings, "own_index", rows=2)
    buttons = row.column(align=True)
    buttons.operator_menu_enum("pe.add_own_sensor", "kind", text="", icon="ADD")
    buttons.operator("pe.remove_own_sensor", text="", icon="REMOVE")
    if settings.own_index < len(settings.own_sensors):
        own = settings.own_sensors[settings.own_index]
        draw_properties(layout.column(), own, ("kind", *SCALARS[own.kind]))
        if own.problem:
            draw_sentence(layout, context, own.problem, icon="ERROR")


def draw_curves(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the AP curve of each kind."""
    layout.label(text="AP = a ln m + b")
    if not settings.curves:
        layout.operator("pe.own_curves")
    for curve in settings.curves:
        row = layout.row(align=True)
        row.prop(curve, "own", text=KIND_LABELS.get(curve.name, curve.name))
        pair = row.row(align=True)
        pair.active = curve.own
        pair.prop(curve, "a")
        pair.prop(curve, "b")


CLASSES = (PE_UL_own_sensors, PE_PT_advanced)
