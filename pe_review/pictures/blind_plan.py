"""Blind ground round the vehicle, as a plan with metres to each side."""

from __future__ import annotations

from typing import Any

from ..engine import pe, sight
from ..markup import Markup
from .plan import PlanDrawing

BLIND, INK = "#d55e00", "#1b1f24"
SIDES = {"front": (0, 1), "rear": (0, -1), "left": (1, 1), "right": (1, -1)}
"""By side: the axis that leads there, and which way."""
LEAST_M = 0.3
"""Less is a strip along the body that is not measured."""
WIDE = 330.0
ROOM_M = 2.0
"""A measure that ends this near to the border has no room for its words beyond it."""


def blind_plan(found: sight.BlindGround, vehicle: pe.Vehicle | None, alt: str) -> Markup:
    """Return a plan of blind ground, with metres to each side.

    A whisker is how far the blind ground that begins at the body reaches, and nothing else; a ring
    marks the nearest blind ground where none begins at the body.
    """
    plan = PlanDrawing(_bounds(found, vehicle), alt, wide=WIDE)
    lines = [plan.at(line) for line in found.outlines]
    style: dict[str, Any] = {
        "fill": BLIND,
        "fill_opacity": "0.32",
        "stroke": BLIND,
        "stroke_width": 1.0,
    }
    if lines:
        plan.canvas.path(lines, fill_rule="evenodd", **style)
    plan.vehicle(vehicle)
    if vehicle is not None:
        for side in SIDES:
            _measure(plan, found, vehicle, side)
    plan.frame()
    return plan.canvas.svg()


def side_words(found: sight.BlindGround, side: str) -> str:
    """Say in figures how blind a side is: where it begins, and how far it goes from the body."""
    spot, zone = found.nearest[side], found.zone[side]
    if spot is None:
        return "none"
    if zone is None:
        return f"at the body, beyond {found.within:g} m"
    if zone > 0.0:
        return f"at the body, to {sight.shown_end(zone):.1f} m"
    return f"at {sight.shown_start(spot.distance):.1f} m"


def _measure(plan: PlanDrawing, found: sight.BlindGround, vehicle: pe.Vehicle, side: str) -> None:
    """Draw a whisker as far as the blind ground at the body goes, else mark the nearest of it."""
    spot, zone = found.nearest[side], found.zone[side]
    if spot is None or (zone is not None and 0.0 < zone < LEAST_M):
        return
    axis, sign = SIDES[side]
    away = found.within if zone is None else (zone or spot.distance)
    edge = float(vehicle.bounds[1 if sign > 0 else 0][axis])
    start, end = list(spot.point), list(spot.point)
    start[axis], end[axis] = edge, edge + sign * away
    x, y = plan.place(*end)
    if zone == 0.0:
        words = f"from {sight.shown_start(away):.1f} m"
        plan.canvas.add("circle", cx=x, cy=y, r=3.5, fill="#fff", stroke=INK, stroke_width=1.2)
    else:
        words = f"> {away:g} m" if zone is None else f"{sight.shown_end(away):.1f} m"
        _whisker(plan, plan.place(*start), (x, y), axis)
    beside = _within if away > found.within - ROOM_M else _beside
    right, down, anchor = beside(axis, sign, x, y)
    plan.canvas.text(right, down, words, text_anchor=anchor, css="strong halo")


def _whisker(
    plan: PlanDrawing, start: tuple[float, float], end: tuple[float, float], axis: int
) -> None:
    (x0, y0), (x1, y1) = start, end
    cap = "v6m0 -12v12" if axis == 0 else "h6m-12 0h12"
    line = f"M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}m0 0{cap}"
    plan.canvas.add("path", d=line, fill="none", stroke=INK, stroke_width=1.0)


def _beside(axis: int, sign: int, x: float, y: float) -> tuple[float, float, str]:
    """Return where a text stands beside the end of a measure."""
    if axis == 1:
        return x + 8.0, y + 4.0, "start"
    return x + sign * 8.0, y + 4.0, "start" if sign > 0 else "end"


def _within(axis: int, sign: int, x: float, y: float) -> tuple[float, float, str]:
    """As `_beside`, on the vehicle's side of the end."""
    if axis == 1:
        return x + 8.0, y + (14.0 if sign > 0 else -6.0), "start"
    return x - sign * 6.0, y - 6.0, "end" if sign > 0 else "start"


def _bounds(
    found: sight.BlindGround, vehicle: pe.Vehicle | None
) -> tuple[tuple[float, float], tuple[float, float]]:
    low, high = ((-1.0, -1.0), (1.0, 1.0)) if vehicle is None else vehicle.bounds
    x, y = ((float(low[k]) - found.within, float(high[k]) + found.within) for k in (0, 1))
    return x, y
