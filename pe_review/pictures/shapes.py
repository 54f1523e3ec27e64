"""Triangles of simple shapes: turned on a lathe, and boxes with their edges taken off."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

AROUND = 28
"""Points of a circle."""


def lathe(profile: Sequence[tuple[float, float]], around: int = AROUND) -> Floats:
    """(F, 3, 3) triangles of an outline (radius, height) turned round the z axis."""
    turn = np.arange(around) * 2.0 * np.pi / around
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    rings = [np.column_stack([radius * circle, np.full(around, z)]) for radius, z in profile]
    return loft(rings)


def loft(rings: Sequence[Floats]) -> Floats:
    """(F, 3, 3) triangles between rings (N, 3) of as many points; those without area left out."""
    found = []
    for low, high in pairwise(rings):
        low_next, high_next = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        found += [np.stack([low, low_next, high_next], 1), np.stack([low, high_next, high], 1)]
    triangles = np.concatenate(found)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[(normal * normal).sum(axis=1) > 1e-18]


def rounded_box(half: Floats, off: float = 0.12) -> Floats:
    """(F, 3, 3) triangles of a box of half sizes (3,), its upper and lower edges taken off."""
    x, y, z = half.tolist()
    cut = off * min(x, y, z)
    return capped([_outline(x - c, y - c, cut, h) for c, h in _levels(z, cut)])


def capped(rings: Sequence[Floats]) -> Floats:
    """(F, 3, 3) triangles of a loft closed at both its ends."""
    ends = [np.tile(ring.mean(axis=0), (len(ring), 1)) for ring in (rings[0], rings[-1])]
    return loft([ends[0], *rings, ends[1]])


def _levels(z: float, cut: float) -> tuple[tuple[float, float], ...]:
    return (cut, -z), (0.0, cut - z), (0.0, z - cut), (cut, z)


def _outline(x: float, y: float, cut: float, height: float) -> Floats:
    """(8, 3) a rectangle with its corners taken off, counter-clockwise."""
    a, b = x - cut, y - cut
    flat = [(x, -b), (x, b), (a, y), (-a, y), (-x, b), (-x, -b), (-a, -y), (a, -y)]
    return np.array([(*point, height) for point in flat])
