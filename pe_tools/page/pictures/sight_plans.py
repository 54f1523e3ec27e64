"""Plans of what the rig sees: blind ground near the vehicle, and reach by direction."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from markupsafe import Markup

import pe_core as pe
from pe_core.base.arrays import Floats
from pe_core.scoring import sight

from ... import graphics
from .ground_plan import PlanBounds, PlanDrawing

RIG, BEFORE = "#0b5cad", "#8c959f"
GRID = "#c8cfd6"
KEY_HEIGHT = 24.0
WRITTEN_BEARINGS = 8
"""Number of bearings at which the distance is written."""
MIN_WRITTEN_M = 3.0
"""Shorter distances are not written."""
BLIND, INK = "#d55e00", "#1b1f24"
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""Axis (0: x, 1: y) and sign of each side's direction."""
MIN_EXTENT_M = 0.3
"""Blind ground that extends less far from the body is not measured."""
BLIND_WIDTH = 330.0
MARGIN_M = 2.0
"""Space that the text of a measure needs between its end and the border."""


def blind_plan(blind: sight.BlindGround, vehicle: pe.Vehicle | None, alt: str) -> Markup:
    """Return a plan of blind ground, with its extent in metres on each side.

    A line from the body to a cap is the extent of blind ground that begins at the body. If none
    begins there, a ring marks the nearest blind ground.
    """
    plan = PlanDrawing(_bounds(blind, vehicle), alt, width=BLIND_WIDTH)
    if lines := [plan.points(line) for line in blind.outlines]:
        style = {"fill": BLIND, "fill_opacity": "0.32", "stroke": BLIND}
        plan.canvas.path(lines, True, fill_rule="evenodd", stroke_width=1.0, **style)
    plan.vehicle(vehicle)
    if vehicle is not None:
        for side in SIDES:
            _draw_extent(plan, blind, vehicle, side)
    plan.frame()
    return plan.canvas.svg()


def side_text(blind: sight.BlindGround, side: str) -> str:
    """Return where the blind ground of a side begins, and its extent from the body, as text."""
    spot, zone = blind.nearest[side], blind.zone[side]
    if spot is None:
        return "none"
    if zone is None:
        return f"at the body, beyond {blind.within:g} m"
    if zone > 0.0:
        return f"at the body, to {sight.shown_end(zone):.1f} m"
    return f"at {sight.shown_start(spot.distance):.1f} m"


def _draw_extent(
    plan: PlanDrawing, blind: sight.BlindGround, vehicle: pe.Vehicle, side: str
) -> None:
    """Draw the extent of blind ground at the body, else mark the nearest blind ground."""
    spot, zone = blind.nearest[side], blind.zone[side]
    if spot is None or (zone is not None and 0.0 < zone < MIN_EXTENT_M):
        return
    axis, sign = SIDES[side]
    away = blind.within if zone is None else (zone or spot.distance)
    edge = float(vehicle.bounds[1 if sign > 0 else 0][axis])
    start, end = list(spot.point), list(spot.point)
    start[axis], end[axis] = edge, edge + sign * away
    x, y = plan.point(*end)
    if zone == 0.0:
        words = f"from {sight.shown_start(away):.1f} m"
        plan.canvas.add("circle", cx=x, cy=y, r=3.5, fill="#fff", stroke=INK, stroke_width=1.2)
    else:
        words = f"> {away:g} m" if zone is None else f"{sight.shown_end(away):.1f} m"
        x0, y0 = plan.point(*start)
        cap = "v6m0 -12v12" if axis == 0 else "h6m-12 0h12"
        line = f"M{x0:.1f} {y0:.1f}L{x:.1f} {y:.1f}m0 0{cap}"
        plan.canvas.add("path", d=line, fill="none", stroke=INK, stroke_width=1.0)
    right, down, anchor = _text_place(axis, sign, away > blind.within - MARGIN_M)
    plan.canvas.text(x + right, y + down, words, text_anchor=anchor, css="strong halo")


def _text_place(axis: int, sign: int, on_vehicle_side: bool) -> tuple[float, float, str]:
    """Return offset and anchor of a text beside the end of a measure."""
    if axis == 1:
        return 8.0, (14.0 if sign > 0 else -6.0) if on_vehicle_side else 4.0, "start"
    ends = ("start", "end") if sign > 0 else ("end", "start")
    return (-sign * 6.0, -6.0, ends[1]) if on_vehicle_side else (sign * 8.0, 4.0, ends[0])


def _bounds(blind: sight.BlindGround, vehicle: pe.Vehicle | None) -> PlanBounds:
    low, high = ((-1.0, -1.0), (1.0, 1.0)) if vehicle is None else vehicle.bounds
    x, y = ((float(low[k]) - blind.within, float(high[k]) + blind.within) for k in (0, 1))
    return x, y


def reach_plan(
    reach: sight.Reach,
    before: sight.Reach | None,
    rig: pe.Rig,
    vehicle: pe.Vehicle | None,
    bounds: PlanBounds,
    alt: str,
) -> Markup:
    """Return a plan of the reach of a rig, of each sensor alone, and of the rig before a search."""
    plan = PlanDrawing(bounds, alt, KEY_HEIGHT)
    for radius in (20.0, 40.0, 60.0, 80.0):
        plan.ring(radius, color=GRID)
    size: dict[str, Any] = {"fill": "none", "stroke_linejoin": "round"}
    colors = graphics.sensor_colors_on_paper(rig)
    for sensor in rig:
        color = graphics.color_text(colors[sensor.name])
        line = plan.points(_reach_outline(reach, reach.per_sensor[sensor.name], bounds))
        plan.canvas.path([line], stroke=color, stroke_width=1.2, stroke_opacity="0.85", **size)
    if before is not None:
        line = plan.points(_reach_outline(before, before.distance, bounds))
        plan.canvas.path([line], stroke=BEFORE, stroke_width=1.6, stroke_dasharray="5 4", **size)
    line = plan.points(_reach_outline(reach, reach.distance, bounds))
    plan.canvas.path([line], fill=RIG, fill_opacity="0.09", stroke=RIG, stroke_width=2.2)
    plan.vehicle(vehicle)
    _write_distances(plan, reach)
    plan.frame()
    _draw_key(plan, before is not None, graphics.color_text(next(iter(colors.values()))))
    return plan.canvas.svg()


def reach_text(reach: sight.Reach, bearing_deg: float) -> str:
    """Return the reach in a direction as text; the bearing is counter-clockwise from ahead."""
    away = np.abs(np.angle(np.exp(1j * (reach.bearings - np.radians(bearing_deg)))))
    return _distance_text(reach, int(np.argmin(away)))


def _distance_text(reach: sight.Reach, k: int) -> str:
    distance = float(reach.distance[k])
    if distance <= 0.0:
        return "none"
    at_end = sight.ends_with_space(reach, reach.distance)[k]
    return f"{'≥ ' if at_end else ''}{distance:.0f} m"


def _reach_outline(reach: sight.Reach, distance: Floats, bounds: PlanBounds) -> Floats:
    """(N, 2) closed outline of a reach, clipped to the plan: lone objects may be beyond it."""
    low, high = np.transpose(bounds)
    return np.clip(sight.reach_line(reach, distance).points, low, high)


def _write_distances(plan: PlanDrawing, reach: sight.Reach) -> None:
    bearings = reach.bearings.tolist()
    for k in range(0, len(bearings), max(1, len(bearings) // WRITTEN_BEARINGS)):
        distance = float(reach.distance[k])
        if distance < MIN_WRITTEN_M:
            continue
        x, y = plan.point(distance * math.cos(bearings[k]), distance * math.sin(bearings[k]))
        away, down = math.cos(bearings[k]), -math.sin(bearings[k])
        x = min(max(x + 24.0 * away, plan.left + 20.0), plan.left + plan.width - 22.0)
        y = min(max(y + 13.0 * down + 4.0, 22.0), plan.bottom - 6.0)
        text = _distance_text(reach, k)
        plan.canvas.text(x, y, text, text_anchor="middle", css="strong halo")


def _draw_key(plan: PlanDrawing, has_before: bool, color: str) -> None:
    lines: Mapping[str, dict[str, object]] = {
        "whole rig": {"stroke": RIG, "stroke_width": 2.2},
        **({"before": {"stroke": BEFORE, "stroke_dasharray": "5 4"}} if has_before else {}),
        "sensor alone": {"stroke": color, "stroke_width": 1.2},
    }
    at, down = plan.left, plan.bottom + 38.0
    for text, style in lines.items():
        plan.canvas.add("path", d=f"M{at:.1f} {down:.1f}h20", fill="none", **style)
        plan.canvas.text(at + 26.0, down + 4.0, text)
        at += 50.0 + 7.0 * len(text)
