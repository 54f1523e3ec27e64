"""Objects' boxes as seen from a sensor, and the rays that meet them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.objects import Objects

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NUDGE_M = np.array([1.97, 3.02, 4.98]) * 1e-8
"""A sensor is moved by this, ground frame [m]: a beam that would run exactly along a face of a box
(the horizontal one, at the height of its roof) then runs beside it or through it, whatever the
rounding. The ratios are those of `lidar.ties`: of no beam at round angles, so that a beam through
an edge of a box is decided as well."""
NO_SPEED = 1e-30
"""Stands for a direction component of exactly 0, so that dividing by it gives +-huge."""


@dataclass(frozen=True, slots=True)
class PlacedBoxes:
    """Boxes seen from a sensor, along their own axes: length, width, up.

    `offsets` (N, 3) of their centres and `halves` (N, 3) of their sizes [m]; `headings` (N, 2)
    cosine and sine of their yaws.
    """

    offsets: Floats
    halves: Floats
    headings: Floats

    @classmethod
    def of(cls, objects: Objects, position: Sequence[float]) -> PlacedBoxes:
        """Place objects round a sensor, nudged as the rule of ties has it."""
        x, y, z = (objects.centers - (np.asarray(position) + NUDGE_M)).T
        c, s = objects.headings.T
        offsets = np.stack([c * x + s * y, c * y - s * x, z], axis=1)
        return cls(offsets, objects.sizes / 2.0, objects.headings)

    def some(self, which: Ints) -> PlacedBoxes:
        """Return some of them."""
        return PlacedBoxes(self.offsets[which], self.halves[which], self.headings[which])

    def from_above(self) -> tuple[Floats, Floats]:
        """Where the centres are along the ground's x and y (N,), from the sensor [m]."""
        (x, y, _), (c, s) = self.offsets.T, self.headings.T
        return c * x - s * y, s * x + c * y

    def along(self, which: Ints, directions: Floats) -> tuple[Floats, Floats, Floats]:
        """Ground-frame directions (P, 3) along the axes of box `which` (P,) each."""
        c, s = self.headings[which].T
        x, y, z = directions.T
        return c * x + s * y, c * y - s * x, z

    def crossing(self, which: Ints, directions: Floats) -> tuple[Floats, Floats]:
        """Distances (P,) at which rays from the sensor enter and leave a box each.

        Enter is at least 0; enter >= leave where the ray misses.
        """
        enter, leave = np.zeros(len(which)), np.full(len(which), np.inf)
        for k, speed in enumerate(self.along(which, directions)):
            speed = np.where(speed == 0.0, NO_SPEED, speed)
            offset, half = self.offsets[which, k], self.halves[which, k]
            t0, t1 = (offset - half) / speed, (offset + half) / speed
            np.maximum(enter, np.minimum(t0, t1), out=enter)
            np.minimum(leave, np.maximum(t0, t1), out=leave)
        return enter, leave
