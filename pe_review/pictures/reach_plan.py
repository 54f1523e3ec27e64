"""Reach: how far away objects of a class are still found, by direction, as a plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe, sight
from ..markup import Markup
from .plan import PlanDrawing, PlanEdges
from .svg import hexadecimal

Floats = NDArray[np.float64]

RIG, BEFORE = "#0b5cad", "#8c959f"
GRID = "#c8cfd6"
KEY_HIGH = 24.0
FIGURES = 8
"""At how many bearings metres are written."""
LEAST_FIGURE_M = 3.0


def reach_plan(
    found: sight.Reach,
    before: sight.Reach | None,
    rig: pe.Rig,
    vehicle: pe.Vehicle | None,
    bounds: PlanEdges,
    alt: str,
) -> Markup:
    """Return a plan of a rig's reach, of each sensor's alone, and of the rig's before a search."""
    plan = PlanDrawing(bounds, alt, KEY_HIGH)
    for radius in (20.0, 40.0, 60.0, 80.0):
        plan.ring(radius, color=GRID)
    size: dict[str, Any] = {"fill": "none", "stroke_linejoin": "round"}
    for number, sensor in enumerate(rig):
        color = hexadecimal(graphics.sensor_color_on_paper(number))
        line = plan.at(_line(found, found.per_sensor[sensor.name], bounds))
        plan.canvas.path([line], stroke=color, stroke_width=1.2, stroke_opacity="0.85", **size)
    if before is not None:
        line = plan.at(_line(before, before.distance, bounds))
        plan.canvas.path([line], stroke=BEFORE, stroke_width=1.6, stroke_dasharray="5 4", **size)
    line = plan.at(_line(found, found.distance, bounds))
    plan.canvas.path([line], fill=RIG, fill_opacity="0.09", stroke=RIG, stroke_width=2.2)
    plan.vehicle(vehicle)
    _figures(plan, found)
    plan.frame()
    _key(plan, before is not None)
    return plan.canvas.svg()


def reach_to(found: sight.Reach, bearing_deg: float) -> str:
    """Say how far the reach is in a direction, counter-clockwise from ahead."""
    away = np.abs(np.angle(np.exp(1j * (found.bearings - np.radians(bearing_deg)))))
    k = int(np.argmin(away))
    distance = float(found.distance[k])
    if distance <= 0.0:
        return "nowhere"
    return f"{'≥ ' if _ends_with_space(found, k) else ''}{distance:.0f} m"


def reach_key(rig: pe.Rig) -> list[tuple[str, str]]:
    """Return each sensor's colour and name."""
    numbered = enumerate(rig)
    return [(hexadecimal(graphics.sensor_color_on_paper(number)), s.name) for number, s in numbered]


def _line(found: sight.Reach, distance: Floats, bounds: PlanEdges) -> Floats:
    """(N, 2) the closed line of a reach, held at the plan's edges: lone objects are beyond them."""
    low, high = np.transpose(bounds)
    return np.clip(sight.reach_line(found, distance).points, low, high)


def _figures(plan: PlanDrawing, found: sight.Reach) -> None:
    bearings = found.bearings.tolist()
    for k in range(0, len(bearings), max(1, len(bearings) // FIGURES)):
        distance = float(found.distance[k])
        if distance < LEAST_FIGURE_M:
            continue
        x, y = plan.place(distance * math.cos(bearings[k]), distance * math.sin(bearings[k]))
        words = f"{'≥ ' if _ends_with_space(found, k) else ''}{distance:.0f} m"
        away, down = math.cos(bearings[k]), -math.sin(bearings[k])
        x = min(max(x + 24.0 * away, plan.left + 20.0), plan.left + plan.wide - 22.0)
        y = min(max(y + 13.0 * down + 4.0, 22.0), plan.bottom - 6.0)
        plan.canvas.text(x, y, words, text_anchor="middle", css="strong halo")


def _ends_with_space(found: sight.Reach, k: int) -> bool:
    return bool(sight.ends_with_space(found, found.distance)[k])


def _key(plan: PlanDrawing, has_before: bool) -> None:
    lines: Mapping[str, dict[str, object]] = {
        "the rig": {"stroke": RIG, "stroke_width": 2.2},
        **({"before": {"stroke": BEFORE, "stroke_dasharray": "5 4"}} if has_before else {}),
        "a sensor alone": {
            "stroke": hexadecimal(graphics.sensor_color_on_paper(0)),
            "stroke_width": 1.2,
        },
    }
    at, down = plan.left, plan.bottom + 38.0
    for words, style in lines.items():
        plan.canvas.add("path", d=f"M{at:.1f} {down:.1f}h20", fill="none", **style)
        plan.canvas.text(at + 26.0, down + 4.0, words)
        at += 50.0 + 7.0 * len(words)
