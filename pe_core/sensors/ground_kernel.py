"""Ground kernels: squares of the ground in which a sensor surely sees an upright post.

A post stands for any thin object; it reaches from the ground to a given height. A square is marked
if a post somewhere in it is surely visible: a beam hits it, or a line of sight reaches a point of
it. In a square that is not marked a post may be visible or not: kernels may mark too few squares,
never too many.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Flags, Floats
from ..geometry.grids import GroundGrid
from ..scene.rig import Sensor
from ..scene.vehicle import Vehicle
from .kernels import CachingKernel

Definition = Callable[[Sensor, Floats, float, Vehicle | None], Floats]

HEIGHT_STEP_M = 0.1
"""Distance of the points of a post that are tested; its foot and its top are among them [m]."""
FLAT_M = 1e-3
"""Side of the cubes that stand for posts of height 0, for kinds with a definition only [m]."""


@dataclass(frozen=True, slots=True)
class GroundView:
    """Squares of the ground, the height of posts on them [m], and the vehicle."""

    grid: GroundGrid
    height: float
    vehicle: Vehicle | None = None


@dataclass(frozen=True, slots=True)
class VisibleGround:
    """Squares `marked` (NX, NY) for a sensor; `approximate` if the occlusion by the vehicle is."""

    sensor: Sensor
    marked: Flags
    approximate: bool = False


class GroundKernel(CachingKernel, ABC):
    """Marks squares of one grid for sensors of one kind."""

    @abstractmethod
    def mark(self, sensor: Sensor, approximate: bool) -> VisibleGround:
        """Mark squares; with `approximate` occlusion may be approximate, if that is faster."""


class DefinedGround(GroundKernel):
    """Marks squares by the definition of m, of small cubes in the middle of the squares."""

    def __init__(self, measure: Definition, view: GroundView) -> None:
        self._measure, self._view = measure, view

    def mark(self, sensor: Sensor, approximate: bool) -> VisibleGround:
        """Measure small cubes, at steps of `HEIGHT_STEP_M` over the height of the posts."""
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
    """Return heights (Z,) at which a post is tested: its top, its foot, and between them [m]."""
    steps = int(np.ceil(height / HEIGHT_STEP_M - 1e-9))
    between = [height * k / steps for k in range(1, steps)]
    return np.array([height, *([0.0] if height else []), *between])
