"""Conditions: lists of states and weathers, and the scores of the last run under them."""

from __future__ import annotations

from typing import Any

from bpy.types import Context, PropertyGroup, UILayout

from .layout import (
    columns,
    draw_declared,
    draw_list,
    draw_properties,
    draw_sentence,
    panel,
    row_list,
)


@row_list("PE_UL_states")
def states_rows(context: Context, layout: UILayout, settings: Any, item: Any) -> None:
    """The states: used, name, and a button that shows the state"""
    row, row_index = _draw_row(layout, item), list(settings.states).index(item)
    icon = "HIDE_OFF" if item.frame == context.scene.frame_current else "HIDE_ON"
    row.operator("pe.show_state", text="", icon=icon, emboss=False).index = row_index


@row_list("PE_UL_weathers")
def weathers_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The weathers: used and name"""
    _draw_row(layout, item)


@panel("Conditions", bl_ui_units_x=17)
def conditions(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """States of the vehicle and weathers in which the rig is scored, too"""
    names, buttons = ("states", "state_index"), ("pe.add_state", "pe.remove_state")
    draw_list(layout, states_rows, settings, names, buttons)
    if settings.states:
        row = layout.row(align=True)
        row.operator("pe.show_state", text="Show as Drawn", icon="LOOP_BACK").index = -1
        row.operator("pe.read_states", text="", icon="FILE_REFRESH")
        draw_properties(layout, settings, ("drawn_frame",))
    else:
        draw_sentence(layout, context, "Pose the vehicle at another frame, then add the frame")
    names, buttons = ("weathers", "weather_index"), ("pe.add_weather", "pe.remove_weather")
    draw_list(layout, weathers_rows, settings, names, buttons, menu="weather")
    if settings.weather_index < len(settings.weathers):
        draw_declared(layout, settings.weathers[settings.weather_index], "weather")
    if settings.states or settings.weathers:
        draw_properties(layout, settings, ("search_conditions",))
    for line in settings.result.conditions if settings.has_result else ():
        draw_sentence(layout, context, line)


def _draw_row(layout: UILayout, item: PropertyGroup) -> UILayout:
    """Draw whether a condition is used, its name and its weight; return the row."""
    row = layout.row(align=True)
    row.prop(item, "enabled", text="")
    name, weight = columns(row, 0.62)
    name.active = item.enabled
    name.prop(item, "name", text="", emboss=False)
    weight.prop(item, "weight", text="")
    return row


CLASSES = (states_rows, weathers_rows, conditions)
