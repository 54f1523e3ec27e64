"""Plans of the ground, ahead to the right and left up: the drawing itself, and maps in it."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.base.arrays import Floats
from pe_core.scoring import sight

from ... import graphics
from ...templating import Markup
from ..markup import number
from .svg import Canvas

PlanBounds = tuple[tuple[float, float], tuple[float, float]]

WIDTH = 440.0
MAX_HEIGHT = 330.0
OUTLINE_M = 0.04
MAX_SQUARES = 600
"""Cell size of the grid an outline is computed on, and the limit of cells along a side."""
TICKS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
MAX_NUMBERS = 9
NUMBER_HEIGHT = 16.0
"""Numbers along x at most, and distance of two numbers along y at least."""
RINGS = (10.0, 40.0)  # Radii between the zones near, middle and far [m]
KEY_HEIGHT = 34.0
KEY_WIDTH = 210.0
COUNT_NAMES = ("none", "1", "2", "3 or more")
MAX_CHANGE = 8.0  # Difference at the ends of the colour scale [nats]
LEFT = 36.0
RIGHT = 20.0
TOP = 8.0
BOTTOM = 24.0
"""Space around a plan for its numbers."""
ABOUT_ENTROPY = "in nats, averaged over height as in the score; lower is better"
SEEN = "share of the height that at least one sensor sees"
TWO_KINDS = "that see a location; two kinds fail in different ways"


class PlanDrawing:
    """A drawing of a part of a plane [m], with `below` units of space under it for a key."""

    def __init__(
        self, bounds: PlanBounds, alt: str, below: float = 0.0, width: float = WIDTH
    ) -> None:
        (self.x0, self.x1), (self.y0, self.y1) = bounds
        length = self.x1 - self.x0
        breadth = self.y1 - self.y0
        room = width - LEFT - RIGHT
        self.scale = min(room / length, MAX_HEIGHT / breadth)
        self.width = length * self.scale
        self.height = breadth * self.scale
        self.left = LEFT + (room - self.width) / 2.0
        self.top = TOP
        self.bottom = self.top + self.height
        self.canvas = Canvas(width, self.bottom + BOTTOM + below, alt)

    def points(self, points: Floats) -> Floats:
        """(N, 2) positions in the drawing of points (N, 2) in the plane [m]."""
        x = self.left + (points[:, 0] - self.x0) * self.scale
        return np.stack([x, self.top + (self.y1 - points[:, 1]) * self.scale], axis=1)

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Return the position of one point in the drawing."""
        right, down = self.points(np.array([[x, y]]))[0].tolist()
        return right, down

    def cells(self, png: bytes) -> None:
        """Draw a PNG over the whole plan, one pixel for each cell of the ground."""
        self.canvas.picture(png, (self.left, self.top, self.width, self.height), "cells")

    def frame(self) -> None:
        """Draw the border, with metres along it."""
        size = {"width": self.width, "height": self.height}
        self.canvas.add("rect", x=self.left, y=self.top, css="axis", **size)
        apart = max((self.x1 - self.x0) / MAX_NUMBERS, NUMBER_HEIGHT / self.scale)
        step = next((t for t in TICKS if t >= apart), TICKS[-1])
        for x in _ticks(self.x0, self.x1, step):
            right, down = self.point(x, self.y0)
            self.canvas.add("path", d=f"M{right:.1f} {down:.1f}v4", css="axis")
            text = number(x, 0) + (" m" if x + step > self.x1 else "")
            self.canvas.text(right, down + 16.0, text, text_anchor="middle")
        for y in _ticks(self.y0, self.y1, step):
            right, down = self.point(self.x0, y)
            self.canvas.add("path", d=f"M{right:.1f} {down:.1f}h-4", css="axis")
            self.canvas.text(right - 7.0, down + 4.0, number(y, 0), text_anchor="end")

    def ring(self, radius: float, label: str = "", color: str = "#fff") -> None:
        """Draw a circle around the origin, clipped to the plan."""
        turn = np.linspace(0.0, 2.0 * math.pi, 181)
        circle = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        inside = (circle >= [self.x0, self.y0]) & (circle <= [self.x1, self.y1])
        runs = np.split(np.arange(181), np.flatnonzero(np.diff(inside.all(axis=1))) + 1)
        lines = [self.points(circle[run]) for run in runs if inside[run[0]].all() and len(run) > 1]
        style = {"stroke": color, "stroke_opacity": "0.75", "stroke_dasharray": "3 3"}
        self.canvas.path(lines, closed=False, fill="none", stroke_width=1.0, **style)
        if label and radius * math.sqrt(0.5) < self.y1:
            right, down = self.point(radius * math.sqrt(0.5), radius * math.sqrt(0.5))
            self.canvas.text(right + 4.0, down - 2.0, label, css="dark")

    def vehicle(self, vehicle: pe.Vehicle | None) -> None:
        """Draw the vehicle's outline, and an arrow that points ahead."""
        for line in () if vehicle is None else outline_of(vehicle):
            self.canvas.path([self.points(line)], css="body")
        nose = 0.0 if vehicle is None else float(vehicle.bounds[1][0])
        right, down = self.point(nose, 0.0)
        self.canvas.add(
            "path",
            d=f"M{right + 3:.1f} {down - 4:.1f}l7 4l-7 4z",
            fill="#1b1f24",
            stroke="#fff",
            stroke_width=1.0,
            paint_order="stroke",
        )


def outline_of(vehicle: pe.Vehicle) -> tuple[Floats, ...]:
    """Return the vehicle's outline from above as closed lines (N, 2) [m]."""
    (x0, y0, _), (x1, y1, _) = (corner.tolist() for corner in vehicle.bounds)
    step = max(OUTLINE_M, (x1 - x0) / MAX_SQUARES, (y1 - y0) / MAX_SQUARES)
    x, y = (  # a whole number of steps around each side
        (low - step, low - step + (math.ceil((high - low) / step) + 2) * step)
        for low, high in ((x0, x1), (y0, y1))
    )
    space = pe.PerceptionSpace(x, y, z=(0.0, step), interval=step)
    covered = np.isfinite(vehicle.top(space)).astype(float)
    return sight.outlines(covered, 0.5, space.centers(0), space.centers(1))


def _ticks(low: float, high: float, step: float) -> list[float]:
    first = math.ceil(low / step)
    last = math.floor(high / step)
    return [k * step for k in range(first, last + 1)]


class MapLayer(NamedTuple):
    """One map of a `GroundSight`: title, what it shows, and the map of `graphics`."""

    title: str
    about: str
    quantity: str = graphics.SENSORS


ENTROPY = MapLayer("Entropy", ABOUT_ENTROPY, graphics.ENTROPY)
COVERAGE = MapLayer("Coverage", SEEN, graphics.COVERAGE)
SENSORS = MapLayer("Number of sensors", "that see a location at any height")
KINDS = MapLayer("Number of sensor kinds", TWO_KINDS)
LAYERS = (ENTROPY, COVERAGE, SENSORS, KINDS)


def ground_map(
    ground: sight.GroundSight, layer: MapLayer, vehicle: pe.Vehicle | None, alt: str
) -> Markup:
    """Return a map as SVG; the same colour means the same value on all maps of a layer."""
    seen = replace(ground, sensors=ground.kinds) if layer is KINDS else ground
    shape = graphics.ground_map(seen, layer.quantity, 1.0, faded=False)
    assert shape.sheet is not None and shape.legend is not None
    key = shape.legend
    if layer.quantity == graphics.SENSORS:
        classes = zip(key.classes, COUNT_NAMES, strict=True)
        key = replace(key, classes=tuple((color, name) for (color, _), name in classes))
    return _map(ground, shape.sheet.image, key, key.values, vehicle=vehicle, alt=alt)


def difference_map(
    first: sight.GroundSight,
    second: sight.GroundSight,
    vehicle: pe.Vehicle | None,
    alt: str,
    ends: tuple[str, str],
) -> Markup:
    """Return a map of where the second rig has less entropy (blue) or more (orange) than the first.
    `ends` are the texts at the ends of the key. Both arguments must have the same cells."""
    change = np.clip((second.entropy - first.entropy) / MAX_CHANGE, -1.0, 1.0).T
    known = np.isfinite(change)
    scale = graphics.DIFFERENCE[::-1]
    colors = graphics.on_scale(0.5 + 0.5 * np.where(known, change, 0.0), scale)
    key = graphics.ColorKey("", graphics.swatches_of(scale))
    return _map(second, np.dstack([colors, known]), key, ends, vehicle=vehicle, alt=alt)


def _map(
    ground: sight.GroundSight,
    image: NDArray[Any],
    key: graphics.ColorKey,
    ticks: tuple[str, ...],
    vehicle: pe.Vehicle | None,
    alt: str,
) -> Markup:
    """Return a map of colours (NY, NX, 4), from low y to high, with rings and a key."""
    half = ground.step / 2.0
    x, y = ((float(w[0]) - half, float(w[-1]) + half) for w in (ground.x, ground.y))
    plan = PlanDrawing((x, y), alt, KEY_HEIGHT)
    plan.cells(graphics.png_bytes(graphics.as_bytes(image[::-1])))
    for radius in RINGS:
        plan.ring(radius, f"{radius:g} m")
    plan.vehicle(vehicle)
    plan.frame()
    _draw_key(plan.canvas, replace(key, ticks=ticks), plan.left, plan.bottom + 30.0)
    return plan.canvas.svg()


def _draw_key(canvas: Canvas, key: graphics.ColorKey, left: float, top: float) -> None:
    """Draw classes as swatches with their names, or a scale with its ticks below."""
    at = left
    for color, name in key.classes:
        swatch = {"width": 11.0, "height": 11.0, "fill": graphics.color_text(color)}
        canvas.add("rect", x=at, y=top, **swatch)
        canvas.text(at + 16.0, top + 10.0, name)
        at += 34.0 + 7.5 * len(name)
    width = KEY_WIDTH / max(len(key.scale), 1)
    for k, color in enumerate(key.scale):
        size = {"width": width + 0.4, "height": 9.0}
        canvas.add("rect", x=left + k * width, y=top, fill=graphics.color_text(color), **size)
    anchors = ("start", "middle", "end") if len(key.ticks) == 3 else ("start", "end")
    for k, (tick, anchor) in enumerate(zip(key.ticks, anchors, strict=False)):
        position = left + KEY_WIDTH * k / (len(key.ticks) - 1)
        canvas.text(position, top + 23.0, tick, text_anchor=anchor)
