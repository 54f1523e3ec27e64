"""Lines on a skin as functions of points (n, 3) that are zero there, and pieces between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from curves import Array, Field

Line = Field
Where = Field  # positive, or True, in a region
GAP = 0.0035  # half the width of a shut line


def band(low: float, high: float) -> Line:
    """Positive between two heights."""
    return lambda p: np.minimum(p[:, 2] - low, high - p[:, 2])


def within(line: Line, half: float) -> Line:
    """Positive nearer than `half` to another line."""
    return lambda p: half - np.abs(line(p))


def widened(line: Line, by: float) -> Line:
    """The same line moved outwards."""
    return lambda p: line(p) + by


def both(*lines: Line) -> Line:
    """True where all lines are positive."""
    return lambda p: np.all([line(p) > 0 for line in lines], axis=0)


def height(limit: float) -> Line:
    """Positive above a height."""
    return lambda p: p[:, 2] - limit


def negative(line: Line) -> Line:
    """The other side of a line."""
    return lambda p: -line(p)


def ahead(limit: float) -> Line:
    """Positive ahead of a length."""
    return lambda p: p[:, 0] - limit


def behind(limit: float) -> Line:
    """Positive behind a length."""
    return lambda p: limit - p[:, 0]


def inboard(limit: float) -> Line:
    """Positive nearer to the centre plane than a width."""
    return lambda p: limit - p[:, 1]


def rounded(axis: int, along: tuple[float, float], up: tuple[float, float], radius: float) -> Line:
    """Positive in a rectangle with round corners, seen along y (axis 0) or along x (axis 1)."""
    middle = np.array([sum(along) / 2, sum(up) / 2])
    half = np.array([along[1] - along[0], up[1] - up[0]]) / 2

    def inside(p: Array) -> Array:
        beyond = np.abs(p[:, [axis, 2]] - middle) - half + radius
        corner = np.hypot(*np.maximum(beyond, 0).T)
        return radius - corner - np.minimum(beyond.max(axis=1), 0)

    return inside


def in_gaps(shut_lines: list[tuple[Line, Where]]) -> Where:
    """True in the shut lines: pairs of a line and where it runs."""
    gaps = [both(within(line, GAP), where) for line, where in shut_lines]
    return lambda p: np.any([gap(p) for gap in gaps], axis=0)


class Panel(NamedTuple):
    """A piece of the skin: object, material and where it is."""

    name: str
    material: str
    inside: Line


def classify(panels: list[Panel], centres: Array) -> Array:
    """Index of the first panel that contains each point."""
    found = np.full(len(centres), -1)
    for i, panel in enumerate(panels):
        found[(found < 0) & (panel.inside(centres) > 0)] = i
    return found
