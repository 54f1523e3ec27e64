"""Plans of the ground: blind ground, reach by direction, and the zones of requirements."""

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.base.arrays import Flags, Floats
from pe_core.scoring import requirements, sight

from ... import graphics
from ...templating import Markup
from ..markup import number
from .ground_plan import PlanBounds, PlanDrawing

RIG = "#0b5cad"
BEFORE = "#8c959f"
GRID = "#c8cfd6"
KEY_HEIGHT = 24.0
BLIND = "#d55e00"
BLIND_WIDTH = 330.0
MET = "#1a7f4b"
NOT_MET = "#c4320a"
INK = "#1b1f24"
MET_RGBA = (26, 127, 75, 90)
NOT_MET_RGBA = (196, 50, 10, 235)
BETWEEN_RGBA = (196, 50, 10, 70)  # Between the lines of the hatching
PLAN_WIDTH = 330.0
PIXELS = 760
"""Width of the drawing, and pixels along the longer side of its zone."""
HATCH_PX = 4
AROUND_M = 1.0  # Ground that is shown round the vehicle and the zone with its margin
CONTOUR_CELLS = 220
LETTER = 7.5  # Width of a letter of a plan's text, at most


def blind_plan(blind: sight.BlindGround, vehicle: pe.Vehicle | None, alt: str) -> Markup:
    """Return a plan of blind ground."""
    plan = PlanDrawing(_bounds(blind, vehicle), alt, width=BLIND_WIDTH)
    if lines := [plan.points(line) for line in blind.outlines]:
        style = {"fill": BLIND, "fill_opacity": "0.32", "stroke": BLIND}
        plan.canvas.path(lines, True, fill_rule="evenodd", stroke_width=1.0, **style)
    plan.vehicle(vehicle)
    plan.frame()
    return plan.canvas.svg()


def side_text(blind: sight.BlindGround, side: str) -> str:
    """Return where the blind ground of a side begins, and its extent from the body, as text."""
    spot = blind.nearest[side]
    zone = blind.zone[side]
    if spot is None:
        return "none"
    if zone is None:
        return f"at the body, beyond {blind.within:g} m"
    if zone > 0.0:
        return f"at the body, to {sight.shown_end(zone):.1f} m"
    return f"at {sight.shown_start(spot.distance):.1f} m"


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
    plan.frame()
    _draw_key(plan, before is not None, graphics.color_text(next(iter(colors.values()))))
    return plan.canvas.svg()


def _reach_outline(reach: sight.Reach, distance: Floats, bounds: PlanBounds) -> Floats:
    """(N, 2) closed outline of a reach, clipped to the plan: lone objects may be beyond it."""
    low, high = np.transpose(bounds)
    return np.clip(sight.reach_line(reach, distance).points, low, high)


def _draw_key(plan: PlanDrawing, has_before: bool, color: str) -> None:
    lines: Mapping[str, dict[str, object]] = {
        "whole rig": {"stroke": RIG, "stroke_width": 2.2},
        **({"before": {"stroke": BEFORE, "stroke_dasharray": "5 4"}} if has_before else {}),
        "sensor alone": {"stroke": color, "stroke_width": 1.2},
    }
    at = plan.left
    down = plan.bottom + 38.0
    for text, style in lines.items():
        plan.canvas.add("path", d=f"M{at:.1f} {down:.1f}h20", fill="none", **style)
        plan.canvas.text(at + 26.0, down + 4.0, text)
        at += 50.0 + 7.0 * len(text)


def requirement_plan(verdict: requirements.Verdict, vehicle: pe.Vehicle | None, alt: str) -> Markup:
    """Return a plan of a requirement's zone with its verdict. Samples that pass are green, samples
    that fail are hatched in red. A dashed line is the zone grown, or shrunk, by the margin. A cross
    marks the worst sample."""
    zone = verdict.samples.zone
    # The ground of a plan: the zone, grown by its margin, and the vehicle.
    low, high = verdict.samples.zone.bounds
    grown = max(verdict.margin or 0.0, 0.0)
    low = low - grown
    high = high + grown
    if vehicle is not None:
        low = np.minimum(low, vehicle.bounds[0][:2])
        high = np.maximum(high, vehicle.bounds[1][:2])
    x0, y0 = (low - AROUND_M).tolist()
    x1, y1 = (high + AROUND_M).tolist()
    bounds = (x0, x1), (y0, y1)
    plan = PlanDrawing(bounds, alt, width=PLAN_WIDTH)
    plan.cells(_sample_png(verdict, bounds))
    color = MET if verdict.met else NOT_MET
    closed = zone.kind in ("area", "ring")
    if zone.kind != "spots":
        lines = [plan.points(line) for line in zone.outlines]
        plan.canvas.path(lines, closed, fill="none", stroke=color, stroke_width=1.4)
    _draw_margin(plan, verdict, bounds)
    plan.vehicle(vehicle)
    if verdict.worst is not None and not verdict.met:
        # Mark the worst sample by a cross in a ring.
        x, y = plan.point(*verdict.worst)
        plan.canvas.add("circle", cx=x, cy=y, r=6.0, fill="#fff", stroke=INK, stroke_width=1.4)
        cross = f"M{x - 3:.1f} {y - 3:.1f}l6 6m0 -6l-6 6"
        plan.canvas.add("path", d=cross, fill="none", stroke=INK, stroke_width=1.4)
    plan.frame()
    return plan.canvas.svg()


def _sample_png(verdict: requirements.Verdict, bounds: PlanBounds) -> bytes:
    """Return all samples as a picture of the plan: a block of pixels for each sample."""
    (x0, x1), (y0, y1) = bounds
    scale = PIXELS / max(x1 - x0, y1 - y0)
    shape = math.ceil((y1 - y0) * scale), math.ceil((x1 - x0) * scale)
    passed, failed, size = graphics.painted_samples(verdict)
    within = _within(verdict.samples.zone, (x0, y0), scale, shape)
    met, missed = (_blocks(p - [x0, y0], size, scale, shape) & within for p in (passed, failed))
    rows, columns = np.indices(shape)
    line = (rows + columns) % (2 * HATCH_PX) < HATCH_PX
    pixels = np.zeros((*shape, 4), np.uint8)
    pixels[met] = MET_RGBA
    pixels[missed & ~line] = BETWEEN_RGBA
    pixels[missed & line] = NOT_MET_RGBA
    return graphics.png_bytes(pixels[::-1])


def _within(
    zone: requirements.PlacedZone, low: tuple[float, float], scale: float, shape: tuple[int, int]
) -> Flags:
    """Return an image (H, W) of the zone: samples at its edge are not painted beyond it. A pixel is
    inside where a line to its right crosses the outlines an odd number of times. Paths and spots
    have no inside: all of the image is returned."""
    if zone.kind not in ("area", "ring"):
        return np.ones(shape, bool)
    image = np.zeros(shape, bool)
    columns, rows = (np.arange(n) + 0.5 for n in shape[::-1])
    for line in zone.outlines:
        corners = (line - low) * scale
        for (ax, ay), (bx, by) in pairwise(corners.tolist()):
            crossed = (ay <= rows) != (by <= rows)
            at = ax + (rows[crossed] - ay) * (bx - ax) / (by - ay) if ay != by else rows[:0]
            image[crossed] ^= columns[None] < at[:, None]
    return image


def _blocks(points: Floats, size: float, scale: float, shape: tuple[int, int]) -> Flags:
    """Return an image (H, W) in which a square of `size` [m] is set round each point (N, 2)."""
    image = np.zeros(shape, bool)
    first = np.floor((points - size / 2.0) * scale).astype(np.int64)
    side = max(1, math.ceil(size * scale))
    for down in range(side):
        for across in range(side):
            column = first[:, 0] + across
            row = first[:, 1] + down
            inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
            image[row[inside], column[inside]] = True
    return image


def _draw_margin(plan: PlanDrawing, verdict: requirements.Verdict, bounds: PlanBounds) -> None:
    """Draw the zone grown or shrunk by the margin, as a dashed line, with the margin's text."""
    if verdict.margin is None or abs(verdict.margin) < 0.01:
        return
    xs, ys = (np.linspace(low, high, CONTOUR_CELLS) for low, high in bounds)
    places = np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1)
    away = verdict.samples.zone.distance(places.reshape(-1, 2)).reshape(places.shape[:2])
    lines = [plan.points(line) for line in sight.outlines(-away, -verdict.margin, xs, ys)]
    if not lines:
        return
    plan.canvas.path(lines, fill="none", stroke=INK, stroke_width=1.0, stroke_dasharray="4 3")
    x, y = max(np.concatenate(lines).tolist(), key=lambda point: point[0] - point[1])
    sign = "\N{GREATER-THAN OR EQUAL TO} " if verdict.at_least else ""
    text = f"{sign}{number(verdict.margin)} m"
    right = max(x - 4.0, plan.left + LETTER * (len(text) + 1))
    plan.canvas.text(right, max(y - 5.0, 20.0), text, text_anchor="end", css="strong halo")
