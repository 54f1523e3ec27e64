"""The layout of scenes: boxes of objects, placed so that none overlaps another or the vehicle.

Sources of boxes propose a position at each attempt, by a low-discrepancy sequence. A box is placed
at the first attempt at which its rectangle on the ground is free.
"""

import math
from collections.abc import Sequence
from functools import cache
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, join_columns, mapped
from ...base.errors import InputError
from ...geometry.grids import PerceptionSpace
from ...prior.boxes import Boxes
from ...prior.classes import ObjectClass, sampled_positions
from ...scene.vehicle import Vehicle
from ..sampling import DIMENSIONS, scrambled_sobol

X, Y, HEIGHT, LENGTH, WIDTH, HEADING, ANY = range(DIMENSIONS)
"""What the dimensions of the Sobol' sequence sample: the first ones, which fill best, positions."""
GOLDEN = 0.6180339887498949
"""The sequence is scrambled by multiples of this, modulo 1: no two are alike."""
DECIMALS = 4
"""Positions and sizes are rounded to 0.1 mm, so that they have the same bits everywhere."""
SPREADS = 2.0
"""Sizes are normally distributed, cut off at so many standard deviations or half of the mean."""
NORMAL = NormalDist()
MAX_ATTEMPTS = 200
"""How many positions are proposed for an object before placing it fails."""
CAR_SIZE_M = (4.6, 1.9)
"""Length and width of the rectangle that is kept free without a mesh of the vehicle."""


class LaidOutBoxes(NamedTuple):
    """Boxes with a position: `centers` (N, 3) and `sizes` (N, 3) [m], `yaws` (N,) [rad]."""

    centers: Floats
    sizes: Floats
    yaws: Floats

    def subset(self, which: NDArray) -> "LaidOutBoxes":
        """Return the boxes with the given indices, or where a mask is set."""
        return LaidOutBoxes(*(values[which] for values in self))


class ModelBoxes:
    """Boxes of a class of a prior's model; sizes and headings are the same in all attempts."""

    def __init__(self, cls: ObjectClass, space: PerceptionSpace, count: int, shift: float) -> None:
        self._class = cls
        self._space = space
        self._count = count
        self._shift = shift
        u = scrambled_sobol(count, scrambles(shift, 0))
        spreads = (cls.length_spread, cls.width_spread, cls.height_spread)
        by_axis = zip((LENGTH, WIDTH, HEIGHT), cls.size, spreads, strict=True)
        sizes = [_scattered(u[:, axis], mean, spread) for axis, mean, spread in by_axis]
        self._sizes = np.asarray(np.round(np.stack(sizes, axis=1), DECIMALS), dtype=np.float64)
        turned = u[:, ANY] < cls.any_heading
        facing = np.round(np.pi * (u[:, HEADING] - 0.5), DECIMALS)
        self._yaws: Floats = np.where(turned, facing, 0.0).astype(np.float64)

    def proposed(self, attempt: int) -> LaidOutBoxes:
        """Sample positions from the class's density, by inverse transform."""
        u = scrambled_sobol(self._count, scrambles(self._shift, attempt)[: Y + 1])
        x, y = sampled_positions(self._class, self._space, u[:, X], u[:, Y])
        centers = np.stack([x, y, self._sizes[:, 2] / 2.0], axis=1)
        return LaidOutBoxes(np.round(centers, DECIMALS + 1), self._sizes, self._yaws)


class LabelledBoxes:
    """Labelled boxes at their positions; only which of them are in a scene is sampled."""

    def __init__(self, boxes: LaidOutBoxes, count: int, shift: float) -> None:
        x = boxes.centers[:, 0]
        y = boxes.centers[:, 1]
        self._boxes = boxes.subset(np.argsort(x * x + y * y, kind="stable"))
        self._count = count
        self._shift = shift

    def proposed(self, attempt: int) -> LaidOutBoxes:
        """Sample from the boxes, sorted by distance; others at each attempt."""
        u = scrambled_sobol(self._count, scrambles(self._shift, attempt)[:1])[:, 0]
        return self._boxes.subset((u * len(self._boxes.yaws)).astype(np.int64))


BoxSource = ModelBoxes | LabelledBoxes
"""A source of boxes of one class, which are to be placed in scenes."""


def labelled_boxes(boxes: Boxes, name: str, space: PerceptionSpace) -> LaidOutBoxes:
    """Return the labelled boxes of a class whose centres are in a space, seen from above."""
    inside = (boxes.names == name) & (boxes.x >= space.x[0]) & (boxes.x <= space.x[1])
    indices = np.flatnonzero(inside & (boxes.y >= space.y[0]) & (boxes.y <= space.y[1]))
    centers = np.stack([boxes.x[indices], boxes.y[indices], boxes.z[indices]], axis=1)
    sizes = np.stack([boxes.length[indices], boxes.width[indices], boxes.height[indices]], axis=1)
    return LaidOutBoxes(centers, sizes, boxes.yaw[indices])


def scrambles(shift: float, attempt: int) -> Sequence[float]:
    """Return the numbers in [0, 1) that scramble the sequence at an attempt."""
    return [(shift + GOLDEN * (attempt * DIMENSIONS + d)) % 1.0 for d in range(DIMENSIONS)]


def _scattered(u: Floats, mean: float, spread: float) -> Floats:
    """Map numbers in [0, 1) to normally distributed sizes, cut off far from the mean."""
    if spread == 0.0:
        return np.full(len(u), mean)
    max_spreads = min(SPREADS, mean / 2.0 / spread)
    low = NORMAL.cdf(-max_spreads)
    high = NORMAL.cdf(max_spreads)
    return mean + spread * mapped(NORMAL.inv_cdf, low + u * (high - low))


class GroundRectangles(NamedTuple):
    """Rectangles in arrays of any shape: centres, cos and sin of headings, half lengths, widths."""

    x: Floats
    y: Floats
    cos: Floats
    sin: Floats
    along: Floats
    across: Floats

    def at(self, which: Any) -> "GroundRectangles":
        """Return the rectangles at indices."""
        return GroundRectangles(*(values[which] for values in self))

    def put(self, which: Any, rectangles: "GroundRectangles") -> None:
        """Replace the rectangles at indices."""
        for values, new in zip(self, rectangles, strict=True):
            values[which] = new

    def among(self) -> "GroundRectangles":
        """Return them with one more axis, to compare each with several others."""
        return GroundRectangles(*(values[..., None] for values in self))


def ground_rectangles(centers: Floats, sizes: Floats, yaws: Floats) -> GroundRectangles:
    """Return the footprints of boxes at (N, 2), with sizes (N, 3) and headings (N,)."""
    return GroundRectangles(
        centers[:, 0],
        centers[:, 1],
        mapped(math.cos, yaws),
        mapped(math.sin, yaws),
        along=sizes[:, 0] / 2.0,
        across=sizes[:, 1] / 2.0,
    )


def overlap(a: GroundRectangles, b: GroundRectangles) -> NDArray[np.bool_]:
    """Whether rectangles, broadcast together, overlap: no axis separates them. Separating axes are
    parallel to a side of either one. Rectangles that only touch do not overlap."""
    dx = b.x - a.x
    dy = b.y - a.y
    turn = np.abs(a.cos * b.cos + a.sin * b.sin)
    slant = np.abs(a.cos * b.sin - a.sin * b.cos)
    overlaps = np.ones(np.broadcast(a.x, b.x).shape, bool)
    with np.errstate(invalid="ignore"):  # infinitely far away
        for one, other in ((a, b), (b, a)):
            along = np.abs(dx * one.cos + dy * one.sin)
            across = np.abs(dy * one.cos - dx * one.sin)
            overlaps &= along < one.along + other.along * turn + other.across * slant
            overlaps &= across < one.across + other.along * slant + other.across * turn
    return overlaps


def vehicle_rectangle(vehicle: Vehicle | None) -> GroundRectangles:
    """Return the rectangle (1,) round the vehicle, seen from above."""
    if vehicle is None:
        length, width = CAR_SIZE_M
        x = 0.0
        y = 0.0
    else:
        low, high = vehicle.bounds
        length, width = (high - low)[:2].tolist()
        x, y = ((high + low) / 2.0)[:2].tolist()
    return ground_rectangles(np.array([[x, y]]), np.array([[length, width, 0.0]]), np.zeros(1))


def place_boxes(
    sources: Sequence[BoxSource],
    labels: Ints,
    scenes: Ints,
    free: GroundRectangles,
    ground_m2: float,
    names: Sequence[str],
) -> LaidOutBoxes:
    """Place objects in scenes, one after the other, at the first proposed position that is free.

    The boxes of the sources, one for each class in `names`, one class after the other, are the N
    objects; `labels` and `scenes` (N,) are the class and scene of each. In a scene they are placed
    in the order of the arrays, beside the rectangles in `free`. `InputError` when there is no free
    position for an object, or all boxes of a scene are larger than the ground.
    """

    @cache
    def proposed(attempt: int) -> tuple[LaidOutBoxes, GroundRectangles]:
        by_class = [source.proposed(attempt) for source in sources]
        boxes = LaidOutBoxes(*join_columns(by_class))
        return boxes, ground_rectangles(boxes.centers[:, :2], boxes.sizes, boxes.yaws)

    result = LaidOutBoxes(*(values.copy() for values in proposed(0)[0]))
    areas = result.sizes[:, 0] * result.sizes[:, 1]
    fullest = int(np.bincount(scenes, areas).argmax())
    if np.bincount(scenes, areas)[fullest] > ground_m2:
        _no_room(f"{np.bincount(scenes)[fullest]:,} in a scene, larger than the space together")
    turns = _turns(scenes)
    shape = int(scenes.max()) + 1, int(turns.max()) + 1
    zeros = [np.zeros(shape) for _ in range(5)]
    taken = GroundRectangles(np.full(shape, np.inf), *zeros)  # infinitely far away at first
    for turn in range(int(turns.max()) + 1):
        waiting = np.flatnonzero(turns == turn)
        for attempt in range(MAX_ATTEMPTS):
            boxes, ground = proposed(attempt)
            candidates = ground.at(waiting)
            placed = taken.at((scenes[waiting], slice(0, turn)))
            is_free = ~overlap(candidates, free) & ~overlap(candidates.among(), placed).any(axis=1)
            settled = waiting[is_free]
            taken.put((scenes[settled], turn), ground.at(settled))
            for values, new in zip(result, boxes, strict=True):
                values[settled] = new[settled]
            waiting = waiting[~is_free]
            if not len(waiting):
                break
        else:
            count = np.bincount(scenes).max()
            name = names[labels[waiting[0]]]
            _no_room(f"{count:,} in a scene, and no room for a {name} in {MAX_ATTEMPTS} places")
    return result


def _turns(scenes: Ints) -> Ints:
    """Return how many objects of its scene are before each object, (N,)."""
    order = np.argsort(scenes, kind="stable")
    first = np.searchsorted(scenes[order], scenes[order], side="left")
    turns = np.empty(len(scenes), np.int64)
    turns[order] = np.arange(len(scenes)) - first
    return turns


def _no_room(found: str) -> None:
    expected = "objects that find room in the space without overlap"
    raise InputError("prior", "density", expected, found)
