"""Rays that hit boxes, and other boxes of the same scene that hide them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.arrays import Flags, Floats, Ints
from ..geometry.indexing import count_up, stable_order
from .object_kernel import PlacedBoxes

APART_RAD = 1e-6
"""Margin between the directions of balls, seen from above, that do not hide each other [rad]."""


@dataclass(frozen=True, slots=True)
class BoxRays:
    """Rays from a sensor that hit boxes, (R,) each.

    `item` is the box; `directions` (R, 3) are unit vectors in the ground frame; `distance` is the
    distance to the box [m].
    """

    item: Ints
    directions: Floats
    distance: Floats


@dataclass(frozen=True, slots=True)
class Rivals:
    """Boxes that may hide boxes (P,): for box k, `count[k]` of `other` from `first[k]` on."""

    first: Ints
    count: Ints
    other: Ints

    @classmethod
    def of(cls, scenes: Ints, which: Ints) -> Rivals:
        """Return all other boxes of the same scenes."""
        order = stable_order(scenes)
        first = np.searchsorted(scenes[order], scenes[which], "left")
        count = np.searchsorted(scenes[order], scenes[which], "right") - first
        other = order[np.repeat(first, count) + count_up(count)]
        rivals = cls(np.cumsum(count) - count, count, other)
        return rivals.some(other != which[rivals.ranks()])

    def ranks(self) -> Ints:
        """(R,) the box that each entry may hide."""
        return np.repeat(np.arange(len(self.count)), self.count)

    def some(self, kept: Flags) -> Rivals:
        """Return the flagged entries (R,)."""
        count = np.bincount(self.ranks()[kept], minlength=len(self.count))
        return Rivals(np.cumsum(count) - count, count, self.other[kept])


def behind_others(boxes: PlacedBoxes, rivals: Rivals, rays: BoxRays) -> Flags:
    """Whether rays enter another box of `rivals` before their own; boxes have the same indices."""
    hidden = np.zeros(len(rays.item), bool)
    first, count = rivals.first[rays.item], rivals.count[rays.item]
    for rank in range(int(count.max(initial=0))):
        some = np.flatnonzero((count > rank) & ~hidden)
        box = rivals.other[first[some] + rank]
        enter, leave = boxes.crossing(box, rays.directions[some])
        hidden[some] = (enter < leave) & (enter < rays.distance[some])
    return hidden


def rivals_near(boxes: PlacedBoxes, scenes: Ints, balls: Floats, which: Ints) -> Rivals:
    """Return, for some boxes, the other boxes of their scenes that may hide them.

    `balls` (N,) are radii of balls round all boxes [m].
    """
    rivals = Rivals.of(scenes, which)
    rank, other = rivals.ranks(), rivals.other
    item = which[rank]
    x, y = boxes.ground_offsets()
    flat = np.hypot(x, y)
    near = flat - balls
    across = x[item] * y[other] - y[item] * x[other]
    along = x[item] * x[other] + y[item] * y[other]
    half = np.arcsin(balls / np.maximum(flat, balls))
    apart = np.abs(np.arctan2(across, along)) > half[item] + half[other] + APART_RAD
    before = near[other] < flat[item] + balls[item]
    around = np.minimum(near[item], near[other]) <= 0.0
    return rivals.some(before & (around | ~apart))
