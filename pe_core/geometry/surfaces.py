"""Surfaces of triangles: divided finely, and cut along a level of a value at their corners."""

import numpy as np

from ..base.arrays import Floats
from .poses import cross, dot

HALF = 0.5


def area_of(triangles: Floats) -> float:
    """Return the area of triangles (F, 3, 3) [m2]."""
    across = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return HALF * float(np.sqrt(dot(across, across)).sum())


def divided(triangles: Floats, longest: float) -> Floats:
    """Return triangles (F, 3, 3) with edges above `longest` halved until none is (F2, 3, 3) [m]."""
    done: list[Floats] = []
    while len(triangles):
        along = np.roll(triangles, -1, axis=1) - triangles
        sides = np.sqrt(dot(along, along))
        first = sides.argmax(axis=1)
        short = sides.max(axis=1) <= longest
        done.append(triangles[short])
        long = triangles[~short]
        first = first[~short]
        row = np.arange(len(long))
        a, b, c = (long[row, (first + k) % 3] for k in range(3))  # a to b is the longest side
        middle = HALF * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
    return np.concatenate(done) if done else triangles


def cut_below(triangles: Floats, values: Floats, level: float) -> Floats:
    """Return the parts (F2, 3, 3) of triangles (F, 3, 3) where a value is at most a level. The
    value is linear on each triangle; `values` (F, 3) has it at the corners. A triangle with a
    corner of inf is cut at half of its edges: nothing is known of its inside."""
    low = values <= level
    count = low.sum(axis=1)
    parts = [triangles[count == 3]]
    for corners, is_alone in ((1, True), (2, False)):
        some = count == corners
        # The corner that is alone on its side of the level comes first.
        first = np.where(low[some] == is_alone, 1, 0).argmax(axis=1)
        row = np.arange(int(some.sum()))
        order = [(first + k) % 3 for k in range(3)]
        a, b, c = (triangles[some][row, each] for each in order)
        at = [values[some][row, each] for each in order]
        ab, ac = (a + _share(at[0], end, level) * (to - a) for end, to in ((at[1], b), (at[2], c)))
        if is_alone:
            parts.append(np.stack([a, ab, ac], 1))
        else:
            parts += [np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)]
    return np.concatenate(parts)


def _share(start: Floats, end: Floats, level: float) -> Floats:
    """Return (N, 1) which share of an edge lies before the level; half where an end is inf."""
    known = np.isfinite(start) & np.isfinite(end)
    span = np.where(known, end, 1.0) - np.where(known, start, 0.0)
    share = np.where(known, (level - np.where(known, start, 0.0)) / np.where(span, span, 1.0), HALF)
    return np.clip(share, 0.0, 1.0)[:, None]


def section(triangles: Floats, axis: int, at: float) -> Floats:
    """Return the points (N, 3) where edges of triangles (F, 3, 3) cross a plane across an axis, at
    the coordinate `at`; where no triangle is, at the nearest coordinate that one has."""
    values = triangles[..., axis]
    low = values.min(axis=1)
    high = values.max(axis=1)
    nearest = int(np.argmin(np.maximum(low - at, at - high)))
    level = min(max(at, float(low[nearest])), float(high[nearest]))
    ahead = triangles[:, [1, 2, 0]]
    rise = ahead[..., axis] - values
    is_cut = (values <= level) != (ahead[..., axis] <= level)
    share = (level - values[is_cut]) / rise[is_cut]
    cuts = triangles[is_cut] + share[:, None] * (ahead[is_cut] - triangles[is_cut])
    return np.concatenate([triangles[values == level], cuts])
