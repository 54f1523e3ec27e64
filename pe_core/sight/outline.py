"""Outlines of a region given on a grid: marching squares, in NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BOTTOM, RIGHT, TOP, LEFT = range(4)
SEGMENTS = {
    1: ((BOTTOM, LEFT),),
    2: ((RIGHT, BOTTOM),),
    3: ((RIGHT, LEFT),),
    4: ((TOP, RIGHT),),
    6: ((TOP, BOTTOM),),
    7: ((TOP, LEFT),),
    8: ((LEFT, TOP),),
    9: ((BOTTOM, TOP),),
    11: ((RIGHT, TOP),),
    12: ((LEFT, RIGHT),),
    13: ((BOTTOM, RIGHT),),
    14: ((LEFT, BOTTOM),),
}
"""Sides that the outline enters and leaves a square by, inside on its left, by which of the corners
are inside: 1 lower left, 2 lower right, 4 upper right, 8 upper left. Two opposite ones are apart
(`APART`), or joined where the middle of the square is inside (`JOINED`)."""
APART = {5: ((BOTTOM, LEFT), (TOP, RIGHT)), 10: ((RIGHT, BOTTOM), (LEFT, TOP))}
JOINED = {5: ((BOTTOM, RIGHT), (TOP, LEFT)), 10: ((LEFT, BOTTOM), (RIGHT, TOP))}
"""As seen with x to the right and y up."""
EDGE = 1e-9
"""What a field is below its level where it ends: an outline that leaves it runs along the end."""


def outlines(values: Floats, level: float, x: Floats, y: Floats) -> tuple[Floats, ...]:
    """Closed outlines of where a field is above a level.

    Parameters
    ----------
    values : (NX, NY) float
        The field at the middles of cells (x, y); it ends with them.
    level : float
    x : (NX,) float
    y : (NY,) float
        Evenly spaced.

    Returns
    -------
    tuple of (N, 2) float
        The region lies on the left of each; the last point is the first again. Longest first.
    """
    field = np.pad(values - level, 1, constant_values=-EDGE)
    xs, ys = _widened(x), _widened(y)
    starts, ends = _segments(field)
    points = _EdgePoints(field, xs, ys)
    rings = [points.at(ring) for ring in chained(starts, ends)]
    return tuple(sorted(rings, key=len, reverse=True))


def _widened(w: Floats) -> Floats:
    """Middles of cells, and the ends of the first and the last."""
    edge = (w[1] - w[0]) / 2.0 if len(w) > 1 else 0.5
    return np.concatenate([[w[0] - edge], w, [w[-1] + edge]])


def _segments(field: Floats) -> tuple[Ints, Ints]:
    """Numbers of the edges that pieces of outline begin and end at."""
    inside = field > 0.0
    case = inside[:-1, :-1] + 2 * inside[1:, :-1] + 4 * inside[1:, 1:] + 8 * inside[:-1, 1:]
    middle = field[:-1, :-1] + field[1:, :-1] + field[1:, 1:] + field[:-1, 1:] > 0.0
    starts, ends = [], []
    for number, sides, where in (
        *((n, s, None) for n, s in SEGMENTS.items()),
        *((n, s, ~middle) for n, s in APART.items()),
        *((n, s, middle) for n, s in JOINED.items()),
    ):
        i, j = np.nonzero((case == number) if where is None else (case == number) & where)
        for enter, leave in sides:
            starts.append(_edge(i, j, enter, field.shape))
            ends.append(_edge(i, j, leave, field.shape))
    return np.concatenate(starts), np.concatenate(ends)


def _edge(i: Ints, j: Ints, side: int, shape: tuple[int, ...]) -> Ints:
    """Number of a side of squares (i, j): even along x, odd along y, by its lower end."""
    i, j = i + (side == RIGHT), j + (side == TOP)
    return 2 * (i * shape[1] + j) + (side in (LEFT, RIGHT))


def chained(starts: Ints, ends: Ints) -> list[list[int]]:
    """Put pieces together to rings of edges; every edge is entered once and left once."""
    following = dict(zip(starts.tolist(), ends.tolist(), strict=True))
    rings = []
    while following:
        first = at = next(iter(following))
        ring = [first]
        while (at := following.pop(at)) != first:
            ring.append(at)
        rings.append([*ring, first])
    return rings


class _EdgePoints:
    """Where the level is crossed along edges of the grid."""

    def __init__(self, field: Floats, x: Floats, y: Floats) -> None:
        self._field, self._x, self._y = field, x, y

    def at(self, edges: list[int]) -> Floats:
        """Points (N, 2) on numbered edges."""
        number, along_y = np.divmod(np.asarray(edges), 2)
        i, j = np.divmod(number, self._field.shape[1])
        i1, j1 = i + (1 - along_y), j + along_y
        a, b = self._field[i, j], self._field[i1, j1]
        t = a / (a - b)
        x = self._x[i] + t * (self._x[i1] - self._x[i])
        y = self._y[j] + t * (self._y[j1] - self._y[j])
        return np.stack([x, y], axis=1)
