"""Blind squares of the ground: those on which a test body can stand and be visible to no sensor.

The body is an upright cylinder of diameter `BODY_M` and a given height; at height 0 it is a disc
that lies flat. It is invisible if no beam of a LiDAR passes through it before the vehicle occludes
the beam, and no line of sight of a camera ends on it. So a gap between beams that is narrower than
the body is not blind. No voxels are involved, so blind ground varies evenly with its height.

Kinds of sensors mark squares in which something is certainly visible (`sensors.GroundKernel`).
From these, all invisible bodies are found, and some that are just visible: no blind square is
missing except pieces of less than 0.25 m2 and strips along the vehicle narrower than a square's
diagonal. A blind square is at most `TOO_FAR_M` from a hole, as wide as the body, without marks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.arrays import Flags
from ...geometry.grids import GroundGrid, PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import GroundView, VisibleGroundCache
from .grid_regions import dilated, squares_touching, squares_within, without_specks
from .ground_cells import ROUNDING, STEP, GroundCells

BODY_M = 0.3
"""Diameter of the test body: that of the cylinders of FMVSS 111 and UN regulation 158, less than a
small child is wide."""
STEP_M, MAX_STEP_M = 0.05, 0.1
"""Side of the squares, and the largest: with larger ones no body would be certainly visible."""
TOO_FAR_M = 3 * STEP_M
"""Edges of blind ground are at most so far outside of it, with squares of `STEP_M`."""
MIN_AREA_M2 = 0.18
"""Smaller pieces of unmarked squares are dropped: every blind piece of 0.25 m2 has more of them."""
PARTLY_VISIBLE = math.sqrt(2.0)
"""A blind point in a marked square is no farther than this from an unmarked square, in squares: a
body at that point has an unmarked square under it."""
SQUARES_PER_VOXEL = 16
"""Memory in the cache: a voxel takes some 100 bytes, a square a few."""


@dataclass(frozen=True, eq=False)
class BlindSearch:
    """Ground that is searched for blind squares: squares with a margin, and the sensors on them.

    `cells` are those of the result, `squares` the same and `margin` more on each side, `own`
    (NX, NY) those of the squares with the vehicle over their centres.
    """

    cells: GroundCells
    squares: VisibleGroundCache
    margin: int
    own: Flags

    @classmethod
    def of(
        cls,
        cells: GroundCells,
        height: float,
        vehicle: Vehicle | None,
        kernel_cache: dict[str, Any],
    ) -> BlindSearch:
        """Prepare the search of cells for bodies of a height [m]."""
        margin = math.ceil(BODY_M / cells.step) + 2
        inner = GroundGrid((float(cells.x0[0]), float(cells.y0[0])), cells.shape, cells.step)
        view = GroundView(inner.widened(margin), height, vehicle)
        own = _under(vehicle, view.grid)
        return cls(cells, VisibleGroundCache(view, kernel_cache), margin, own)

    @property
    def size(self) -> int:
        """Its size in the cache, in voxels."""
        return self.own.size // SQUARES_PER_VOXEL

    def blind(self, rig: Rig, preview: bool) -> tuple[Flags, bool]:
        """Return the blind cells (NX, NY) of a rig, and whether they are approximate."""
        marked, approximate = self.squares.marked(rig, preview)
        blind = blind_squares(marked & ~self.own, self.own, self.cells.step)
        inner = tuple(slice(self.margin, n - self.margin) for n in blind.shape)
        return np.ascontiguousarray(blind[inner]), approximate


def fine_enough(step: float) -> float:
    """Return a square's side [m], divided into equal parts of at most `MAX_STEP_M`."""
    step = STEP.checked("sight", "step", step)
    return step / math.ceil(step / MAX_STEP_M - ROUNDING)


def blind_squares(marked: Flags, covered: Flags, step: float) -> Flags:
    """Return the squares (NX, NY) on which invisible bodies can stand, conservatively.

    A body that is certainly over a marked point, wherever in their squares both are, is visible.
    All squares that other bodies touch may be blind. Of these, the unmarked squares in large enough
    pieces are blind, and the squares beside them: a marked square may be visible only in part.

    `marked` (NX, NY) squares have a point at which something is visible. Those `covered` by the
    vehicle are never blind, but a body may be partly under the vehicle.
    """
    radius = BODY_M / 2.0 / step
    invisible = ~dilated(marked, squares_within(radius))
    may_be_blind = dilated(invisible, squares_touching(radius)) & ~covered
    blind = without_specks(may_be_blind & ~marked, MIN_AREA_M2 / step**2)
    return dilated(blind, squares_touching(PARTLY_VISIBLE)) & may_be_blind


def _under(vehicle: Vehicle | None, grid: GroundGrid) -> Flags:
    """Return the squares (NX, NY) with the vehicle over their centres."""
    covered = np.zeros(grid.shape, bool)
    if vehicle is None:
        return covered
    first, last = [], []
    for w, low, high, n in zip(grid.origin, *vehicle.bounds, grid.shape, strict=False):
        first.append(int(np.clip(np.floor((low - w) / grid.step), 0, n - 1)))
        last.append(int(np.clip(np.ceil((high - w) / grid.step), 1, n)))
    (i, j), (i1, j1) = first, last
    ends = [
        (w + a * grid.step, w + b * grid.step)
        for w, a, b in zip(grid.origin, first, last, strict=True)
    ]
    space = PerceptionSpace(ends[0], ends[1], (0.0, grid.step), grid.step)
    covered[i:i1, j:j1] = np.isfinite(vehicle.top(space))
    return covered
