"""Conditions: states and weathers, with scores under them; and scenarios of what moves."""

import json
from typing import Any

from bpy.types import Context, PropertyGroup, UILayout

from ..engine import sight
from ..panel_text import draw_label
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


@row_list("PE_UL_states")
def states_rows(context: Context, layout: UILayout, settings: Any, item: Any) -> None:
    """The states: used, name, and a button that shows the state"""
    row = _draw_row(layout, item)
    row_index = list(settings.states).index(item)
    icon = "HIDE_OFF" if item.frame == context.scene.frame_current else "HIDE_ON"
    row.operator("pe.show_state", text="", icon=icon, emboss=False).index = row_index


@row_list("PE_UL_weathers")
def weathers_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The weathers: used and name"""
    _draw_row(layout, item)


@panel("Conditions", bl_ui_units_x=17)
def conditions(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """States and weathers in which the rig is scored, too; and scenarios of what moves"""
    for name, title, draw in SECTIONS:
        inside = section(layout, name, title, count=str(len(getattr(settings, name)) or ""))
        if inside is not None:
            draw(inside, settings, context)
    if settings.states or settings.weathers:
        draw_properties(layout, settings, ("search_conditions",))
    for line in settings.result.conditions if settings.has_result else ():
        draw_sentence(layout, context, line)


def draw_states(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw the states of the vehicle, and the button that shows it as drawn."""
    draw_list(layout, states_rows, settings, "states")
    if settings.states:
        row = layout.row(align=True)
        row.operator("pe.show_state", text="Show as Drawn", icon="LOOP_BACK").index = -1
        row.operator("pe.read_states", text="", icon="FILE_REFRESH")
        draw_properties(layout, settings, ("drawn_frame",))
    else:
        draw_sentence(layout, context, "Pose the vehicle at another frame, then add the frame")


def draw_weathers(layout: UILayout, settings: PropertyGroup, _context: Context) -> None:
    """Draw the weathers, and the settings of the selected one."""
    draw_list(layout, weathers_rows, settings, "weathers")
    if settings.weather_index < len(settings.weathers):
        draw_declared(layout, settings.weathers[settings.weather_index], "weather")


@row_list("PE_UL_scenarios")
def scenarios_rows(_context: Context, layout: UILayout, _settings: Any, item: Any) -> None:
    """The scenarios: used, name, and the smallest margin"""
    row = layout.row(align=True)
    row.prop(item, "enabled", text="")
    found = json.loads(item.result) if item.result else None
    icon = "BLANK1" if found is None else "CHECKMARK" if found["met"] else "CANCEL"
    name, margin = columns(row, 0.7)
    name.alert = found is not None and not found["met"]
    name.prop(item, "name", text="", emboss=False, icon=icon)
    margin.alignment = "RIGHT"
    if found is not None:
        seconds = found["shown_margin_s"]
        draw_label(margin, "never" if seconds is None else f"{seconds:+.1f} s")


def draw_scenarios(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw the scenarios: when a track is confirmed, and whether the vehicle stops in time."""
    draw_list(layout, scenarios_rows, settings, "scenarios")
    if settings.scenarios:
        row = layout.row(align=True)
        row.operator("pe.check_requirements", text="Check", icon="VIEWZOOM")
        row.operator("pe.play_scenario", text="", icon="PLAY")
        row.operator("pe.export_file", text="", icon="RENDER_ANIMATION").format = "film"
    if settings.scenario_index < len(settings.scenarios):
        row = settings.scenarios[settings.scenario_index]
        told = json.loads(row.result or "{}")
        if told:
            draw_sentence(layout, context, f"Stops in {sight.shown_end(told['stop_m']):.1f} m")
        for body in told.get("bodies", ()):
            draw_sentence(layout, context, _body_text(body))
        draw_declared(layout, row, "scenario")
        layout.separator()
    draw_declared(layout, settings, "time")


def _body_text(body: dict[str, Any]) -> str:
    """Return when a body's track is confirmed, as a sentence."""
    moments = {
        chance: "{:.1f} s before, at {:.1f} m".format(
            *map(sight.shown_start, (-at["time_s"], at["distance_m"]))
        )
        for chance, at in body["confirmed"].items()
        if at is not None
    }
    if not moments:
        return f"{body['name']}: never confirmed"
    texts = [f"{float(chance):.0%} {text}" for chance, text in moments.items()]
    lost = f"; then lost for {sight.shown_end(body['lost_s']):.1f} s" if body["lost_s"] else ""
    return f"{body['name']}: confirmed with {', '.join(texts)}{lost}"


def _draw_row(layout: UILayout, item: PropertyGroup) -> UILayout:
    """Draw whether a condition is used, its name and its weight; return the row."""
    row = layout.row(align=True)
    row.prop(item, "enabled", text="")
    name, weight = columns(row, 0.62)
    name.active = item.enabled
    name.prop(item, "name", text="", emboss=False)
    weight.prop(item, "weight", text="")
    return row


SECTIONS = (
    ("states", "States", draw_states),
    ("weathers", "Weathers", draw_weathers),
    ("scenarios", "Seen in Time", draw_scenarios),
)
"""By the property of the rows: title, and what draws the list."""
CLASSES = (states_rows, weathers_rows, scenarios_rows, conditions)
