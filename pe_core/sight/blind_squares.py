"""Which squares of the ground are blind: an unseen test body can stand on them.

The body is an upright cylinder of the diameter `BODY_M` that stands on the ground and is as tall as
is asked for; 0 is a disc that lies flat. It is unseen where no beam of a LiDAR passes through it,
before the vehicle stops the beam, and no line of sight of a camera ends on it. So a gap between
beams that is narrower than the body is none. Nothing of this is cut into voxels, so what is blind
shrinks evenly with the body's height.

Kinds mark squares in which something is seen for sure (`kinds.ground_kernel`). From these all
unseen bodies are found, and some that are seen by a hair's breadth: no blind square is missing but
for pieces of less than 0.25 m2 and strips along the vehicle narrower than a square's diagonal. A
blind place is at most `TOO_FAR_M` from a hole as wide as that in which no square is marked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import GroundView, VisibleGroundCache
from ..scene.ground_grid import GroundGrid
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from .cells import ROUNDING, STEP, GroundCells
from .regions import dilated, squares_touching, squares_within, without_specks

Flags = NDArray[np.bool_]

BODY_M = 0.3
"""Diameter of the test body: that of the cylinders of FMVSS 111 and UN regulation 158, less than a
small child is wide."""
STEP_M, MOST_STEP_M = 0.05, 0.1
"""Side of the squares, and the largest: with larger ones no body would be known to be seen."""
TOO_FAR_M = 3 * STEP_M
"""Edges of blind ground are at most so far out, with squares of `STEP_M`."""
LEAST_M2 = 0.18
"""Pieces of unmarked squares smaller than this are none: every blind piece of 0.25 m2 has more."""
PARTLY_SEEN = math.sqrt(2.0)
"""A blind place in a marked square is no farther than this from an unmarked one, in squares: a body
on that place has such a square under it."""
SQUARES_A_VOXEL = 16
"""Of what is kept of voxels and squares: some bytes to some 100."""


@dataclass(frozen=True, eq=False)
class BlindLook:
    """Ground that is looked at for blind places: squares with a margin, and the sensors on them.

    Attributes
    ----------
    cells : GroundCells
        What is told of.
    squares : VisibleGroundCache
        The same squares, and `margin` more on each side.
    own : (NX, NY) bool
        Squares with the vehicle over their middles.
    """

    cells: GroundCells
    squares: VisibleGroundCache
    margin: int
    own: Flags

    @classmethod
    def of(
        cls, cells: GroundCells, height: float, vehicle: Vehicle | None, known: dict[str, Any]
    ) -> BlindLook:
        """Look at cells, at bodies of a height [m]; `known` as `VisibleGroundCache` has it."""
        margin = math.ceil(BODY_M / cells.step) + 2
        inner = GroundGrid((float(cells.x0[0]), float(cells.y0[0])), cells.shape, cells.step)
        view = GroundView(inner.widened(margin), height, vehicle)
        own = _under(vehicle, view.grid)
        return cls(cells, VisibleGroundCache(view, known), margin, own)

    @property
    def size(self) -> int:
        """How much is kept, in voxels' room."""
        return self.own.size // SQUARES_A_VOXEL

    def blind(self, rig: Rig, draft: bool) -> tuple[Flags, bool]:
        """Blind cells (NX, NY) of a rig, and whether that is a draft."""
        marked, drafted = self.squares.marked(rig, draft)
        blind = blind_squares(marked & ~self.own, self.own, self.cells.step)
        inner = tuple(slice(self.margin, n - self.margin) for n in blind.shape)
        return np.ascontiguousarray(blind[inner]), drafted


def fine_enough(step: float) -> float:
    """Cut a square's side [m] in equal parts that bodies can be told by."""
    step = STEP.checked("sight", "step", step)
    return step / math.ceil(step / MOST_STEP_M - ROUNDING)


def blind_squares(marked: Flags, own: Flags, step: float) -> Flags:
    """Squares (NX, NY) that unseen bodies can stand on, none too few.

    Where a body surely is over a marked place, wherever in its squares both are, it is seen. All
    squares that other bodies touch may be blind. Of these the unmarked ones are, in pieces that
    are large enough, and those beside them: a marked square need not be seen in all of it.

    Parameters
    ----------
    marked : (NX, NY) bool
        Squares with a place at which something is seen.
    own : (NX, NY) bool
        The vehicle's: never blind, but a body may be partly under it.
    step : float
        Side of a square [m].
    """
    radius = BODY_M / 2.0 / step
    unseen = ~dilated(marked, squares_within(radius))
    maybe = dilated(unseen, squares_touching(radius)) & ~own
    blind = without_specks(maybe & ~marked, LEAST_M2 / step**2)
    return dilated(blind, squares_touching(PARTLY_SEEN)) & maybe


def _under(vehicle: Vehicle | None, grid: GroundGrid) -> Flags:
    """Squares (NX, NY) with the vehicle over their middles."""
    own = np.zeros(grid.shape, bool)
    if vehicle is None:
        return own
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
    own[i:i1, j:j1] = np.isfinite(vehicle.top(space))
    return own
