"""Which beams a vehicle stops, read from a map of its top surface: for drafts only.

From a point above the vehicle its outline against the ground is a horizon: in each direction round
the point, the steepest look down (or up) that still clears all of the surface passed so far. A
beam is taken to end where it first falls below that. What hangs over is taken for solid down to the
ground, and nothing finer than the map's cells is seen; `Vehicle.first_hit` is the exact answer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.heights import top_heights
from ...scene.space import PerceptionSpace

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Indices = NDArray[np.intp]

CELL_M = 0.025
"""Side of a cell of the map, and the step in which the surface is walked over."""
SECTORS = 900
"""Directions round the sensor in which the horizon is looked for: 0.4 degrees apart."""
SECTOR_TURNS = [
    np.array([turn(n * 2.0 * math.pi / SECTORS) for n in range(SECTORS)], np.float32)
    for turn in (math.cos, math.sin)
]
"""Cosine and sine of each."""


@dataclass(frozen=True, slots=True)
class Slants:
    """Beams as (B,) `sector` round the sensor and `slope` above the horizon."""

    sector: Indices
    slope: Singles

    @classmethod
    def of(cls, directions: Floats) -> Slants:
        """Take them from (B, 3) ground-frame directions."""
        x, y, z = (directions[:, axis].astype(np.float32) for axis in range(3))
        flat = np.sqrt(x * x + y * y)
        around = np.arctan2(y, x) * np.float32(SECTORS / (2.0 * math.pi))
        sector = np.rint(around).astype(np.intp) % SECTORS
        return cls(sector, z / np.maximum(flat, np.float32(1e-6)))


class TopMap:
    """A vehicle's top surface in cells of CELL_M, -inf beside it.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Ground frame [m].
    """

    def __init__(self, triangles: Floats) -> None:
        corners = triangles.reshape(-1, 3)
        low = np.floor(corners.min(axis=0)[:2] / CELL_M).astype(int) - 1
        high = np.ceil(corners.max(axis=0)[:2] / CELL_M).astype(int) + 1
        (x0, y0), (x1, y1) = (low * CELL_M).tolist(), (high * CELL_M).tolist()
        cells = PerceptionSpace((x0, x1), (y0, y1), (0.0, CELL_M), CELL_M)
        self._low = low
        self._heights = top_heights(triangles, cells).astype(np.float32)

    def is_above(self, position: Floats, room: float) -> bool:
        """Whether a position is higher than the cells round it by `room` [m]."""
        i, j = np.floor(position[:2] / CELL_M).astype(int) - self._low
        here = self._heights[max(i - 1, 0) : max(i + 2, 0), max(j - 1, 0) : max(j + 2, 0)]
        return not here.size or float(here.max()) + room <= position[2]

    def ends(self, position: Floats, slants: Slants, max_range: float) -> Floats:
        """Where beams from a position above the surface end (B,) [m]."""
        walked = self._farthest(position)
        steps = (np.arange(math.ceil(walked / CELL_M)) + 0.5) * CELL_M
        horizon = self._horizon(position, steps.astype(np.float32))
        ends = np.full(len(slants.slope), max_range)
        low = np.flatnonzero(horizon[slants.sector, -1] >= slants.slope)
        slope = slants.slope[low]
        first = _first_at_least(horizon, slants.sector[low], slope)
        slope = slope.astype(np.float64)
        ends[low] = np.minimum(steps[first] * np.sqrt(1.0 + slope * slope), max_range)
        return ends

    def _farthest(self, position: Floats) -> float:
        """Distance over the ground to the map's farthest corner [m]."""
        low = self._low * CELL_M
        high = low + np.array(self._heights.shape) * CELL_M
        gap = np.maximum(np.abs(low - position[:2]), np.abs(high - position[:2]))
        return math.hypot(*gap.tolist())

    def _horizon(self, position: Floats, steps: Singles) -> Singles:
        """Greatest slope (SECTORS, S) of the surface up to each step in each sector."""
        per_cell = np.float32(1.0 / CELL_M)
        heights = np.pad(self._heights, 1, constant_values=-np.inf)
        at = np.zeros((SECTORS, len(steps)), np.intp)
        for axis, turn in enumerate(SECTOR_TURNS):
            start = position[axis] / CELL_M - self._low[axis] + 1.0
            along = turn[:, None] * (steps * per_cell)
            along += np.float32(start)
            cell = np.clip(along, 0, heights.shape[axis] - 1).astype(np.intp)
            at = at * heights.shape[axis] + cell
        slopes = np.take(heights, at) - np.float32(position[2])
        # A surface below hides down to the far end of the step, one above from its near end.
        half = np.float32(CELL_M / 2.0)
        slopes /= np.where(slopes < 0, steps + half, steps - half * np.float32(0.999))
        horizon: Singles = np.maximum.accumulate(slopes, axis=1, out=slopes)
        return horizon


def _first_at_least(horizon: Singles, sector: Indices, slope: Singles) -> Indices:
    """First step of each beam's sector whose horizon is not below its slope, by bisection."""
    last = horizon.shape[1] - 1
    low, high = np.zeros(len(slope), np.intp), np.full(len(slope), last, np.intp)
    row = sector * horizon.shape[1]
    for _ in range(last.bit_length()):
        middle = (low + high) >> 1
        reached = np.take(horizon, row + middle) >= slope
        high = np.where(reached, middle, high)
        low = np.where(reached, low, middle + 1)
    return high
