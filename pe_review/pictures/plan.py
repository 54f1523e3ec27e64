"""A plan of the ground: ahead is to the right, left is up; metres and the vehicle's outline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..engine import pe, sight
from ..figures import number
from .svg import Canvas

Floats = NDArray[np.float64]
PlanEdges = tuple[tuple[float, float], tuple[float, float]]

WIDE, MOST_HIGH = 440.0, 330.0
LEFT, RIGHT, TOP, BOTTOM = 32.0, 20.0, 8.0, 24.0
"""Room round the plan, for its figures."""
OUTLINE_M, MOST_SQUARES = 0.04, 600
"""Side of the squares that an outline is drawn from, and how many along a side."""
TICKS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
FIGURES_ACROSS = 9


class PlanDrawing:
    """A drawing of a part of the ground [m], `below` units of room under it for a key."""

    def __init__(self, bounds: PlanEdges, alt: str, below: float = 0.0, wide: float = WIDE) -> None:
        (self.x0, self.x1), (self.y0, self.y1) = bounds
        long, high = self.x1 - self.x0, self.y1 - self.y0
        self.scale = min((wide - LEFT - RIGHT) / long, MOST_HIGH / high)
        self.wide, self.high = long * self.scale, high * self.scale
        self.left = LEFT + (wide - LEFT - RIGHT - self.wide) / 2.0
        self.bottom = TOP + self.high
        self.canvas = Canvas(wide, self.bottom + BOTTOM + below, alt)

    def at(self, points: Floats) -> Floats:
        """(N, 2) places in the drawing of points (N, 2) on the ground [m]."""
        x = self.left + (points[:, 0] - self.x0) * self.scale
        y = TOP + (self.y1 - points[:, 1]) * self.scale
        return np.stack([x, y], axis=1)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return the place of one point."""
        right, down = self.at(np.array([[x, y]]))[0].tolist()
        return right, down

    def cells(self, png: bytes) -> None:
        """Lay a picture of all of the ground, a pixel a cell."""
        self.canvas.picture(png, (self.left, TOP, self.wide, self.high), "cells")

    def frame(self) -> None:
        """Draw the border and metres along it."""
        size = {"width": self.wide, "height": self.high}
        self.canvas.add("rect", x=self.left, y=TOP, css="axis", **size)
        step = next((t for t in TICKS if (self.x1 - self.x0) / t <= FIGURES_ACROSS), TICKS[-1])
        for x in _ticks(self.x0, self.x1, step):
            right, down = self.place(x, self.y0)
            self.canvas.add("path", d=f"M{right:.1f} {down:.1f}v4", css="axis")
            words = number(x, 0) + (" m" if x + step > self.x1 else "")
            self.canvas.text(right, down + 16.0, words, text_anchor="middle")
        for y in _ticks(self.y0, self.y1, step):
            right, down = self.place(self.x0, y)
            self.canvas.add("path", d=f"M{right:.1f} {down:.1f}h-4", css="axis")
            self.canvas.text(right - 7.0, down + 4.0, number(y, 0), text_anchor="end")

    def ring(self, radius: float, words: str = "", color: str = "#fff") -> None:
        """Draw a circle round the origin, as much of it as is on the plan."""
        turn = np.linspace(0.0, 2.0 * math.pi, 181)
        circle = radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        inside = (circle >= [self.x0, self.y0]) & (circle <= [self.x1, self.y1])
        runs = np.split(np.arange(181), np.flatnonzero(np.diff(inside.all(axis=1))) + 1)
        lines = [self.at(circle[run]) for run in runs if inside[run[0]].all() and len(run) > 1]
        style: dict[str, Any] = {
            "fill": "none",
            "stroke": color,
            "stroke_opacity": "0.75",
            "stroke_width": 1.0,
        }
        self.canvas.path(lines, closed=False, stroke_dasharray="3 3", **style)
        if words and radius * math.sqrt(0.5) < self.y1:
            right, down = self.place(radius * math.sqrt(0.5), radius * math.sqrt(0.5))
            self.canvas.text(right + 4.0, down - 2.0, words, css="dark")

    def vehicle(self, vehicle: pe.Vehicle | None) -> None:
        """Draw the vehicle's outline, and an arrow ahead."""
        for line in () if vehicle is None else outline_of(vehicle):
            self.canvas.path([self.at(line)], css="body")
        nose = 0.0 if vehicle is None else float(vehicle.bounds[1][0])
        right, down = self.place(nose, 0.0)
        self.canvas.add(
            "path",
            d=f"M{right + 3:.1f} {down - 4:.1f}l7 4l-7 4z",
            fill="#1b1f24",
            stroke="#fff",
            stroke_width=1.0,
            paint_order="stroke",
        )


def outline_of(vehicle: pe.Vehicle) -> tuple[Floats, ...]:
    """Return the vehicle's outline from above, closed lines (N, 2) [m]."""
    (x0, y0, _), (x1, y1, _) = (corner.tolist() for corner in vehicle.bounds)
    step = max(OUTLINE_M, (x1 - x0) / MOST_SQUARES, (y1 - y0) / MOST_SQUARES)
    across = [_whole(low, high, step) for low, high in ((x0, x1), (y0, y1))]
    space = pe.PerceptionSpace(x=across[0], y=across[1], z=(0.0, step), interval=step)
    there = np.isfinite(vehicle.top(space)).astype(float)
    return sight.outlines(there, 0.5, space.centers(0), space.centers(1))


def _whole(low: float, high: float, step: float) -> tuple[float, float]:
    """PlanEdges a whole number of steps apart."""
    count = math.ceil((high - low) / step) + 2
    return low - step, low - step + count * step


def _ticks(low: float, high: float, step: float) -> list[float]:
    first, last = math.ceil(low / step), math.floor(high / step)
    return [k * step for k in range(first, last + 1)]
