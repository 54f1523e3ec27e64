"""What is scored: prior, targets, focus; and advanced settings: own sensors, AP curves, space."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.types import Context, PropertyGroup, UILayout

from ..choices import CUSTOM, FROM_BOXES, OBJECTS, REGIONS
from ..language import draw_label, shown
from ..operators import kind_label, own_fields
from .layout import Rows, Tab, columns, draw_declared, draw_list, draw_properties, draw_sentence


class PE_PT_prior(Tab, bpy.types.Panel):
    """Where objects are expected"""

    bl_idname = "PE_PT_prior"
    bl_label = "Prior"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: Context) -> None:
        draw_chosen(self.layout, context.scene.perception_entropy, "prior")

    def draw(self, context: Context) -> None:
        settings = context.scene.perception_entropy
        boxes = ("boxes",) if settings.prior == FROM_BOXES else ()
        draw_properties(self.layout, settings, ("prior", *boxes))


class PE_PT_targets(Tab, bpy.types.Panel):
    """What is scored: voxels, or objects of the prior"""

    bl_idname = "PE_PT_targets"
    bl_label = "Targets"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: Context) -> None:
        draw_chosen(self.layout, context.scene.perception_entropy, "targets")

    def draw(self, context: Context) -> None:
        settings = context.scene.perception_entropy
        draw_declared(self.layout, settings, "metric")
        draw_declared(self.layout, settings, "ap" if settings.targets == OBJECTS else "score")


def draw_chosen(layout: UILayout, settings: PropertyGroup, name: str) -> None:
    """Draw the chosen entry of a menu: it is visible also when the panel is closed."""
    layout.label(
        text=layout.enum_item_name(settings, name, getattr(settings, name)), translate=False
    )


class PE_UL_focus(Rows, bpy.types.UIList):
    """The focus weights: name, region, factor"""

    def draw_row(self, _context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
        name, figures = columns(layout, 0.4)
        name.prop(item, "name", text="", emboss=False)
        region, factor = columns(figures, 0.61)
        draw_label(region, REGIONS[item.region].short)
        factor.alignment = "RIGHT"
        factor.label(text=f"× {item.factor:g}", translate=False)


class PE_PT_focus(Tab, bpy.types.Panel):
    """Regions and classes with a weight of their own"""

    bl_idname = "PE_PT_focus"
    bl_label = "Focus"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context: Context) -> None:
        count = len(context.scene.perception_entropy.focus)
        self.layout.label(text=str(count or ""), translate=False)  # visible also when closed

    def draw(self, context: Context) -> None:
        settings, layout = context.scene.perception_entropy, self.layout
        names, buttons = ("focus", "focus_index"), ("pe.add_focus", "pe.remove_focus")
        draw_list(layout, PE_UL_focus, settings, names, buttons)
        if settings.focus_index < len(settings.focus):
            focus = settings.focus[settings.focus_index]
            draw_properties(layout, focus, ("factor", "region"))
            if focus.region == CUSTOM:
                draw_declared(layout, focus, "prior.focus", ("factor",))
            layout.column().prop(focus, "classes")


class PE_UL_own_sensors(Rows, bpy.types.UIList):
    """This file's own sensors: name, kind"""

    def draw_row(self, _context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
        layout.prop(item, "name", text="", emboss=False, icon="ERROR" if item.problem else "NONE")
        draw_label(layout, kind_label(item.kind))


class PE_PT_advanced(Tab, bpy.types.Panel):
    """Settings that are rarely changed: own sensors, AP curves, space, clearance"""

    bl_idname = "PE_PT_advanced"
    bl_label = "Advanced"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        settings = context.scene.perception_entropy
        draw_own_sensors(self.layout, context)
        layout = self.layout
        draw_label(layout, "AP = a ln m + b")
        if not settings.curves:
            layout.operator("pe.own_curves")
        for curve in settings.curves:
            row = layout.row(align=True)
            row.prop(curve, "own", text=shown(kind_label(curve.name)), translate=False)
            pair = row.row(align=True)
            pair.active = curve.own
            pair.prop(curve, "a")
            pair.prop(curve, "b")
        column = self.layout.column()
        draw_label(column, "Space and Voxels")
        draw_declared(column, settings, "space")
        draw_declared(column, settings, "vehicle")


def draw_own_sensors(layout: UILayout, context: Context) -> None:
    """Draw the file's own sensors, and the figures of the one that is selected."""
    settings = context.scene.perception_entropy
    draw_label(layout, "Own Sensors")
    row = layout.row()
    name = PE_UL_own_sensors.__name__
    row.template_list(name, "", settings, "own_sensors", settings, "own_index", rows=2)
    buttons = row.column(align=True)
    buttons.operator_menu_enum("pe.add_own_sensor", "kind", text="", icon="ADD")
    buttons.operator("pe.remove_own_sensor", text="", icon="REMOVE")
    if settings.own_index < len(settings.own_sensors):
        sensor = settings.own_sensors[settings.own_index]
        draw_properties(layout.column(), sensor, ("kind", *own_fields(sensor.kind)))
        if sensor.problem:
            draw_sentence(layout, context, sensor.problem, icon="ERROR")


CLASSES = (PE_PT_prior, PE_PT_targets, PE_UL_focus, PE_PT_focus)
ADVANCED_CLASSES = (PE_UL_own_sensors, PE_PT_advanced)
"""These come last in the tab."""
