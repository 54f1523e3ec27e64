"""What is scored: prior, targets, focus; and advanced settings: own sensors, AP curves, space."""

from typing import Any

from bpy.types import Context, PropertyGroup, UILayout

from ..choices import CUSTOM, FROM_BOXES, OBJECTS, REGIONS
from ..engine import search
from ..panel_text import draw_label
from ..sensor_kinds import kind_label, row_of
from .layout import (
    columns,
    draw_declared,
    draw_list,
    draw_properties,
    draw_sentence,
    panel,
    row_list,
    section,
)


@row_list("PE_UL_focus")
def focus_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The focus weights: name, region, factor"""
    name, figures = columns(layout, 0.4)
    name.prop(item, "name", text="", emboss=False)
    region, factor = columns(figures, 0.61)
    draw_label(region, REGIONS[item.region].short)
    factor.alignment = "RIGHT"
    factor.label(text=f"× {item.factor:g}", translate=False)


@panel("Scoring", chosen="prior")
def scoring(layout: UILayout, settings: PropertyGroup, _context: Context) -> None:
    """Where objects are expected, which targets are scored, and what counts more"""
    boxes = ("boxes",) if settings.prior == FROM_BOXES else ()
    draw_properties(layout, settings, ("prior", *boxes))
    draw_declared(layout, settings, "metric")
    draw_declared(layout, settings, "ap" if settings.targets == OBJECTS else "", ("figures",))
    shown = len(settings.figures)
    inside = section(layout, "figures", "Figures", count=f"{shown} of {len(search.SHOWN)}")
    if inside is not None:
        inside.column(align=True).prop(settings, "figures")
    inside = section(layout, "focus", "Focus", count=str(len(settings.focus) or ""))
    if inside is not None:
        draw_focus(inside, settings)


def draw_focus(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw the regions and classes with a weight of their own."""
    draw_list(layout, focus_rows, settings, "focus")
    if settings.focus_index < len(settings.focus):
        focus = settings.focus[settings.focus_index]
        draw_properties(layout, focus, ("factor", "region"))
        if focus.region == CUSTOM:
            draw_declared(layout, focus, "prior.focus", ("factor",))
        layout.column().prop(focus, "classes")


@row_list("PE_UL_own_sensors")
def own_sensors_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """This file's own sensors: name, kind"""
    layout.prop(item, "name", text="", emboss=False, icon="ERROR" if item.problem else "NONE")
    draw_label(layout, kind_label(item.kind))


@panel("Advanced")
def advanced(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Settings that are rarely changed: own sensors, AP curves, space, clearance"""
    draw_label(layout, "Own Sensors")
    draw_list(layout, own_sensors_rows, settings, "own_sensors", height=2)
    if settings.own_index < len(settings.own_sensors):
        sensor = settings.own_sensors[settings.own_index]
        draw_properties(layout.column(), sensor, ("kind", *row_of(sensor.kind).own_fields))
        if sensor.problem:
            draw_sentence(layout, context, sensor.problem, icon="ERROR")
    draw_label(layout, "AP = a ln m - c ln R + b")
    if not settings.curves:
        layout.operator("pe.add_row", text="Own AP Curves").rows = "curves"
    for curve in settings.curves:
        layout.prop(curve, "own", text=kind_label(curve.name), translate=False)
        numbers = layout.row(align=True)
        for name in "abc" if curve.own else "":
            numbers.prop(curve, name)
    column = layout.column()
    draw_label(column, "Space and Voxels")
    draw_declared(column, settings, "space")
    draw_declared(column, settings, "vehicle")


CLASSES = (focus_rows, scoring)
ADVANCED_CLASSES = (own_sensors_rows, advanced)
"""These come last in the tab."""
