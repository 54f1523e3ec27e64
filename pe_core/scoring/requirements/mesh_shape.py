"""The shape of a test body from a mesh: boxes that lie wholly inside it.

The mesh is put on a grid of cells. A cell that no triangle touches and that cannot be reached from
outside is inside; so walls may be thin and pieces may overlap, but the body has to be closed. In
each band of height the largest rectangle of such cells makes a box, and the largest box over
several bands is one more.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from ...base.arrays import Flags, Floats, read_only
from ...base.errors import InputError
from ...geometry.poses import cross, dot

GridRectangle = tuple[int, int, int, int]

CELLS, SMALLEST_CELL_M = 64, 0.01
"""Cells along the longest side at most, and the smallest cell."""
MAX_BANDS = 8
"""Bands with a box of their own."""
SHORTEST_M, LONGEST_M = 0.02, 100.0
"""Sides of a mesh: below and above these its unit is another."""
MAX_PIECES = 4_000_000
ROUNDING = 1e-9


@dataclass(frozen=True)
class MeshShape:
    """What a mesh is as a test body.

    The middle of its extent stands over the foot, and its lowest point on it.

    Attributes
    ----------
    file : str
        The mesh file, as the study names it.
    size : (3,) float
        Length, width and height of its extent [m].
    centers, sizes : (K, 3) float
        Of the boxes inside it, from the foot [m].
    triangles : (F, 3, 3) float
        Its surface, from the foot [m].
    cell : float
        Side of the cells [m]: a box is at most so much smaller on each side than what fits.
    axes : tuple
        Keys of the file's axes and scale, as the study has them.
    key : int
        A checksum of the triangles, by which two shapes are compared.
    """

    file: str = field(compare=False)
    size: tuple[float, float, float]
    centers: Floats = field(compare=False, repr=False)
    sizes: Floats = field(compare=False, repr=False)
    triangles: Floats = field(compare=False, repr=False)
    cell: float
    axes: tuple[tuple[str, object], ...] = field(compare=False)
    key: int

    @classmethod
    def of(
        cls, file: str, triangles: Floats, axes: tuple[tuple[str, object], ...] = ()
    ) -> MeshShape:
        """Return the shape of a mesh (F, 3, 3), x forward, y left, z up [m].

        Raises
        ------
        InputError
            When it is too small or too large, has too much surface, or nothing is inside it.
        """
        low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
        size = high - low
        if not (size.min() >= SHORTEST_M and size.max() <= LONGEST_M):
            expected = f"a body with sides of {SHORTEST_M:g} to {LONGEST_M:g} m (scale?)"
            sides = " x ".join(f"{v:.4g}" for v in size.tolist())
            raise InputError(file, "body.mesh", expected, f"{sides} m")
        foot = np.array([*((low + high)[:2] / 2.0), low[2]])
        own = triangles - foot
        cell = max(SMALLEST_CELL_M, float(size.max()) / CELLS)
        corner = size * [-0.5, -0.5, 0.0]
        inside = _inside(own - corner, size, cell, file)
        found = _boxes(inside)
        if not found:
            expected = f"a closed body, at least {3.0 * cell:.2g} m thick somewhere"
            raise InputError(file, "body.mesh", expected, "no space inside it")
        corner -= cell  # of the grid, which has an edge
        first, last = (np.array([box[k] for box in found]) * cell + corner for k in (0, 1))
        middles, sizes, own = map(read_only, ((first + last) / 2.0, last - first, own))
        a, b, c = (round(v, 6) for v in size.tolist())
        key = zlib.crc32((np.round(own, 6) + 0.0).tobytes())  # no negative zeros
        return cls(file, (a, b, c), middles, sizes, own, round(cell, 6), axes, key)


@lru_cache(maxsize=64)
def surface_shares(shape: MeshShape, bands: int, along: int, across: int) -> Floats:
    """Return the share of a mesh's surface (bands, along, across) in each cell of its extent."""
    pieces = _pieces(shape.triangles, shape.cell, shape.file)
    middles, counts = pieces.mean(axis=1), np.array([along, across, bands])
    size = np.array(shape.size)
    fractions = (middles + size * [0.5, 0.5, 0.0]) / size
    i, j, k = np.clip((fractions * counts).astype(np.int64), 0, counts - 1).T
    normal = cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
    area = np.zeros((bands, along, across))
    np.add.at(area, (k, i, j), np.sqrt(dot(normal, normal)))
    return read_only(area / area.sum())


def _pieces(triangles: Floats, longest: float, file: str) -> Floats:
    """Return triangles (P, 3, 3) cut until no edge is longer; `InputError` for too many."""
    done, left, count = [], triangles, 0
    while len(left):
        edges = np.roll(left, -1, axis=1) - left
        length = np.sqrt((edges * edges).sum(axis=2))
        small = length.max(axis=1) <= longest
        done.append(left[small])
        left, at = left[~small], length[~small].argmax(axis=1)
        count += len(done[-1])
        if count + 2 * len(left) > MAX_PIECES:
            expected = f"a surface of at most {MAX_PIECES:,} pieces of {longest:.2g} m"
            raise InputError(file, "body.mesh", expected, "more")
        rows = np.arange(len(left))
        a, b, c = (left[rows, (at + k) % 3] for k in range(3))
        middle = (a + b) / 2.0
        left = np.concatenate([np.stack(t, axis=1) for t in ((a, middle, c), (middle, b, c))])
    return np.concatenate(done)


def _inside(triangles: Floats, size: Floats, cell: float, file: str) -> Flags:
    """Return the cells (NX, NY, NZ) wholly inside triangles whose lowest corner is the origin.

    The grid has one more cell on each side.
    """
    shape = np.ceil(size / cell - ROUNDING).astype(np.int64) + 2
    touched = np.zeros(shape, bool)
    pieces = _pieces(triangles, cell, file)
    first = np.floor(pieces.min(axis=1) / cell - ROUNDING).astype(np.int64) + 1
    last = np.floor(pieces.max(axis=1) / cell + ROUNDING).astype(np.int64) + 1
    for shift in np.ndindex(3, 3, 3):  # a piece is no longer than a cell: two cells and rounding
        x, y, z = np.clip(np.minimum(first + shift, last), 0, shape - 1).T
        touched[x, y, z] = True
    outside = np.zeros_like(touched)
    for axis in range(3):
        ends = np.moveaxis(outside, axis, 0)
        ends[0] = ends[-1] = True
    count = -1
    while np.count_nonzero(outside) != count:
        count = int(np.count_nonzero(outside))
        for axis in range(3):
            for way in (slice(None), slice(None, None, -1)):
                _sweep(np.moveaxis(outside, axis, 0)[way], np.moveaxis(touched, axis, 0)[way])
    return ~(outside | touched)


def _sweep(reached: Flags, walls: Flags) -> None:
    """Spread what is reached along the first axis, up to walls; in place."""
    number = np.arange(len(reached))[:, None, None]
    wall = np.maximum.accumulate(np.where(walls, number, -1), axis=0)
    seen = np.maximum.accumulate(np.where(reached, number, -1), axis=0)
    reached |= seen > wall


def _boxes(inside: Flags) -> list[tuple[list[int], list[int]]]:
    """Return boxes of cells as first and last corner: the largest, then one in each band."""
    layers = np.flatnonzero(inside.any(axis=(0, 1)))
    if not len(layers):
        return []
    low, high = int(layers[0]), int(layers[-1]) + 1
    bands = np.array_split(np.arange(low, high), max(1, min(MAX_BANDS, high - low)))
    whole = [inside[:, :, band].all(axis=2) for band in bands]
    best: list[tuple[float, GridRectangle, int, int]] = []
    for k in range(len(bands)):
        common = whole[k].copy()
        for n in range(k, len(bands)):
            common &= whole[n]
            rectangle = largest_rectangle(common)
            if rectangle is None:
                break
            x0, y0, x1, y1 = rectangle
            start, end = int(bands[k][0]), int(bands[n][-1]) + 1
            best.append(((x1 - x0) * (y1 - y0) * (end - start), rectangle, start, end))
    singles = [row for row in best if any(row[2] == b[0] and row[3] == b[-1] + 1 for b in bands)]
    chosen = [max(best, key=lambda row: row[0]), *singles] if best else []
    unique = dict.fromkeys((rectangle, start, end) for _, rectangle, start, end in chosen)
    return [([x0, y0, a], [x1, y1, b]) for (x0, y0, x1, y1), a, b in unique]


def largest_rectangle(flags: Flags) -> GridRectangle | None:
    """Return the corners (i0, j0, i1, j1) of the largest rectangle of flags (NX, NY), or None.

    Row after row, by the heights of the columns of flags that end there, with a stack.
    """
    heights = np.zeros(flags.shape[1] + 1, np.int64)
    best, found = 0, None
    for i, row in enumerate(flags):
        heights[:-1] = np.where(row, heights[:-1] + 1, 0)
        stack: list[tuple[int, int]] = []
        for j, height in enumerate(heights.tolist()):
            start = j
            while stack and stack[-1][1] >= height:
                start, tall = stack.pop()
                if tall * (j - start) > best:
                    best, found = tall * (j - start), (i + 1 - tall, start, i + 1, j)
            stack.append((start, height))
    return found
