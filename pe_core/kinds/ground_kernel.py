"""What a sensor sees of things that stand on the ground: asked of a kind, square by square.

A thing is thin and upright, from the ground to a height: a post. A square is marked where a post
somewhere in it is seen for sure: a beam meets it, or a line of sight reaches a point of it. What
is not marked may be seen or not, so kernels may mark too little, and never too much.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..scene.ground_grid import GroundGrid
from ..scene.sensors import Sensor
from ..scene.vehicle import Vehicle

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Definition = Callable[[Sensor, Floats, float, Vehicle | None], Floats]

HEIGHT_STEP_M = 0.1
"""A post is looked at every so many metres of its height, at its foot and at its top."""
FLAT_M = 1e-3
"""Side of the cubes that stand for what lies flat, where a kind has a definition alone [m]."""


@dataclass(frozen=True, slots=True)
class GroundView:
    """What is looked at: squares of the ground, and posts on them that are `height` tall [m].

    The vehicle hides what lies behind it.
    """

    grid: GroundGrid
    height: float
    vehicle: Vehicle | None = None


@dataclass(frozen=True, slots=True)
class VisibleGround:
    """What a sensor sees of posts: `marked` (NX, NY), the squares with one that is seen.

    `draft`: the vehicle's part in it is one.
    """

    sensor: Sensor
    marked: Flags
    draft: bool = False


class GroundKernel(ABC):
    """Marks squares of one grid for sensors of one kind.

    `known` is what it has worked out of sensors and of the vehicle besides; other kernels of its
    kind may `share` it.
    """

    known: Any = None

    @abstractmethod
    def see(self, sensor: Sensor, draft: bool) -> VisibleGround:
        """Mark squares; as a draft where that is asked for and there is a quicker way."""

    def share(self, known: Any) -> None:
        """Use what another kernel of this kind knows, from now on together."""
        return

    def forget_all_but(self, sensors: Collection[Sensor]) -> None:
        """Keep nothing of other sensors than these."""
        return


class DefinedGround(GroundKernel):
    """Marks squares by a kind's definition of m: of small cubes that lie inside posts' squares."""

    def __init__(self, measure: Definition, view: GroundView) -> None:
        self._measure, self._view = measure, view

    def see(self, sensor: Sensor, draft: bool) -> VisibleGround:
        """Measure small cubes, every `HEIGHT_STEP_M` of a post's height."""
        grid, height = self._view.grid, self._view.height
        side = min(grid.step, height) or FLAT_M
        marked = np.zeros(grid.shape[0] * grid.shape[1], bool)
        middles = grid.middles(np.arange(len(marked)))
        for z in heights_of_post(max(height - side, 0.0)):
            left = np.flatnonzero(~marked)
            centers = np.column_stack([middles[left], np.full(len(left), z + side / 2.0)])
            marked[left] = self._measure(sensor, centers, side, self._view.vehicle) > 0
        return VisibleGround(sensor, marked.reshape(grid.shape))


def heights_of_post(height: float) -> Floats:
    """(Z,) heights at which a post is looked at: its top, its foot, and those between [m]."""
    steps = int(np.ceil(height / HEIGHT_STEP_M - 1e-9))
    between = [height * k / steps for k in range(1, steps)]
    return np.array([height, *([0.0] if height else []), *between])
