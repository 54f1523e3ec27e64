"""GroundRectangles on the ground, and whether two of them overlap."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class GroundRectangles(NamedTuple):
    """Rectangles of any shape (...): middles, heading's cosine and sine, half length and width."""

    x: Floats
    y: Floats
    cos: Floats
    sin: Floats
    along: Floats
    across: Floats

    def at(self, which: Any) -> GroundRectangles:
        """Return some of them."""
        return GroundRectangles(*(values[which] for values in self))

    def put(self, which: Any, others: GroundRectangles) -> None:
        """Replace some of them."""
        for values, new in zip(self, others, strict=True):
            values[which] = new

    def among(self) -> GroundRectangles:
        """Return them with one more axis, to be held against several each."""
        return GroundRectangles(*(values[..., None] for values in self))


def rectangles(places: Floats, sizes: Floats, yaws: Floats) -> GroundRectangles:
    """Return what boxes at (N, 2), with sizes (N, 3) and headings (N,), cover of the ground."""
    turns = yaws.tolist()
    cos, sin = (np.array([f(a) for a in turns]) for f in (math.cos, math.sin))
    return GroundRectangles(
        places[:, 0], places[:, 1], cos, sin, sizes[:, 0] / 2.0, sizes[:, 1] / 2.0
    )


def nowhere(shape: tuple[int, ...]) -> GroundRectangles:
    """Return rectangles that overlap with none: infinitely far away."""
    zeros = [np.zeros(shape) for _ in range(4)]
    return GroundRectangles(np.full(shape, np.inf), np.zeros(shape), *zeros)


def overlap(a: GroundRectangles, b: GroundRectangles) -> NDArray[np.bool_]:
    """Whether rectangles, broadcast together, have ground in common: no axis separates them.

    The axes that may are the sides' of either; rectangles that touch do not overlap.
    """
    dx, dy = b.x - a.x, b.y - a.y
    turn, slant = np.abs(a.cos * b.cos + a.sin * b.sin), np.abs(a.cos * b.sin - a.sin * b.cos)
    found = np.ones(np.broadcast(a.x, b.x).shape, bool)
    with np.errstate(invalid="ignore"):  # infinitely far away
        for one, other in ((a, b), (b, a)):
            along, across = np.abs(dx * one.cos + dy * one.sin), np.abs(dy * one.cos - dx * one.sin)
            found &= along < one.along + other.along * turn + other.across * slant
            found &= across < one.across + other.along * slant + other.across * turn
    return found
