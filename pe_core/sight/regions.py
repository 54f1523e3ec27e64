"""Regions and values on the cells of a grid: opened, closed, without specks, smoothed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..scene.numbering import count_up

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


def opened(flags: Flags, radius: float) -> Flags:
    """Union of the discs of that radius, in cells, that fit into a region (NX, NY).

    Beyond the edge the region goes on as at the edge.
    """
    disc = _disc(radius)
    reach = int(np.abs(disc).max())
    padded = np.pad(flags, 2 * reach, mode="edge")
    kept = _moved(~_moved(~padded, disc), disc)
    inner = tuple(slice(2 * reach, n - 2 * reach) for n in kept.shape)
    return kept[inner]


def closed(flags: Flags, radius: float) -> Flags:
    """Fill what no disc of that radius, in cells, fits into: the opening of what is not set."""
    return ~opened(~flags, radius)


def dilated(flags: Flags, widths: list[int]) -> Flags:
    """Set what is near anything set in a region (NX, NY).

    `widths` is a symmetric shape by its rows: k rows away (either way) reach is `widths[k]` cells
    to either side. What is beyond the edge is not set.
    """
    found = np.zeros_like(flags)
    by_width = {width: _along(flags, width) for width in set(widths)}
    for k, width in enumerate(widths[: len(flags)]):
        wide = by_width[width]
        found[k:] |= wide[: len(wide) - k]
        found[: len(wide) - k] |= wide[k:]
    return found


def _along(flags: Flags, reach: int) -> Flags:
    """Set what is at most `reach` cells away in the same row; twice as far with each step."""
    found, have = flags, 0
    reach = min(reach, flags.shape[1] - 1)
    while have < reach:
        k = min(max(have, 1), reach - have)
        wider = found.copy()
        wider[:, k:] |= found[:, :-k]
        wider[:, :-k] |= found[:, k:]
        found, have = wider, have + k
    return found


def squares_within(radius: float) -> list[int]:
    """Squares all of whose points are within a radius of all points of one square.

    In squares, as `dilated` takes them: empty where the radius is less than a square's diagonal.
    """
    rows = int(math.sqrt(max(radius**2 - 1.0, 0.0)))
    return [int(math.sqrt(radius**2 - (k + 1) ** 2)) - 1 for k in range(rows)]


def squares_touching(radius: float) -> list[int]:
    """Squares any of whose points are within a radius of any point of one square, as `dilated`."""
    away = [max(k - 1, 0) for k in range(int(radius) + 2)]
    return [int(math.sqrt(radius**2 - k**2)) + 1 for k in away]


def without_specks(flags: Flags, least: float) -> Flags:
    """Drop connected pieces (by sides) of fewer cells than `least`."""
    width = flags.shape[1] + 1  # a cell more, so that no run goes on in the next row
    edges = np.diff(np.pad(flags, ((0, 0), (1, 1))).astype(np.int8), axis=1).reshape(-1)
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    piece = _connected(len(starts), *_touching(starts, ends, width))
    small = np.bincount(piece, ends - starts, len(starts))[piece] < least
    edges[starts[small]] = edges[ends[small]] = 0
    return np.cumsum(edges.reshape(-1, width), axis=1, dtype=np.int8)[:, :-1] > 0


def gauss(values: Floats, sigma: float) -> Floats:
    """Sum of values (NX, NY) under a Gauss curve of that width, in cells, cut off at twice it."""
    steps = np.arange(-int(2.0 * sigma), int(2.0 * sigma) + 1)
    curve = [math.exp(-((k / sigma) ** 2) / 2.0) for k in steps.tolist()]
    for _ in range(2):
        padded = np.pad(values, ((len(steps) // 2,) * 2, (0, 0)))
        total = np.zeros_like(values)
        for k, w in enumerate(curve):
            total += w * padded[k : k + len(values)]
        values = np.ascontiguousarray(total.T)
    return values


def _disc(radius: float) -> Ints:
    """(N, 2) steps from a cell to those whose middle is not farther away."""
    reach = int(radius)
    steps = np.indices((2 * reach + 1, 2 * reach + 1)).reshape(2, -1).T - reach
    return steps[(steps**2).sum(axis=1) <= radius**2]


def _moved(flags: Flags, steps: Ints) -> Flags:
    """Set what is a step away from anything set."""
    found = np.zeros_like(flags)
    nx, ny = flags.shape
    for i, j in steps.tolist():
        to = slice(max(i, 0), nx + min(i, 0)), slice(max(j, 0), ny + min(j, 0))
        of = slice(max(-i, 0), nx + min(-i, 0)), slice(max(-j, 0), ny + min(-j, 0))
        found[to] |= flags[of]
    return found


def _touching(starts: Ints, ends: Ints, width: int) -> tuple[Ints, Ints]:
    """Pairs of runs of cells, one in the row after the other, that share a side."""
    first = np.searchsorted(ends, starts + width, side="right")
    n = np.maximum(np.searchsorted(starts, ends + width, side="left") - first, 0)
    run = np.repeat(np.arange(len(starts)), n)
    return run, first[run] + count_up(n)


def _connected(count: int, a: Ints, b: Ints) -> Ints:
    """(count,) the least number of what each is connected to, by pairs (a, b)."""
    least = np.arange(count)
    while (differ := least[a] != least[b]).any():
        one, other = least[a[differ]], least[b[differ]]
        np.minimum.at(least, np.maximum(one, other), np.minimum(one, other))
        while ((further := least[least]) != least).any():
            least = further
    return least
