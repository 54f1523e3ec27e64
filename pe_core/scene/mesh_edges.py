"""Which triangles of a mesh share an edge, corner for corner."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MIXERS = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9)
"""Odd numbers that scatter a coordinate's bits (the golden ratio's, and two primes of xxHash)."""


class MeshEdges:
    """Edges of triangles (F, 3, 3): edge k goes from corner k to the next.

    Corners are one when their coordinates are equal to the bit. They and the edges are told apart
    by hashes of 64 bits: of 4 million triangles two are mistaken once in a million meshes.

    Attributes
    ----------
    edge : (F, 3) int
        Number of each edge, from 0; the same where two triangles share it.
    turn : (F, 3) int
        1 or -1: which way the triangle runs along it; 0 where both ends are one corner.
    count : int
        How many edges there are.
    first : (N, 2) int
        A triangle and a corner for each of the mesh's points.
    """

    def __init__(self, triangles: Floats) -> None:
        corners = _hashed(triangles)
        _, first = np.unique(corners.reshape(-1), return_index=True)
        self.first = np.stack(np.divmod(first, 3), axis=1)
        ahead = corners[:, [1, 2, 0]]
        self.turn = (corners < ahead).astype(np.int8) - (corners > ahead).astype(np.int8)
        edges, number = np.unique(_mixed(corners) + _mixed(ahead), return_inverse=True)
        self.edge = number.reshape(-1, 3)
        self.count = len(edges)


def _hashed(points: Floats) -> NDArray[np.uint64]:
    """One number for each of (..., 3) points."""
    bits = np.ascontiguousarray(points + 0.0).view(np.uint64)  # -0.0 is 0.0
    total = np.zeros(points.shape[:-1], np.uint64)
    for axis, mixer in enumerate(MIXERS):
        total = _mixed(total + bits[..., axis] * np.uint64(mixer))
    return total


def _mixed(numbers: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Scatter the bits of numbers, one to one (the finalizer of MurmurHash3)."""
    for mixer in (0xFF51AFD7ED558CCD, 0xC4CEB9FE1A85EC53):
        numbers = (numbers ^ (numbers >> np.uint64(33))) * np.uint64(mixer)
    return numbers ^ (numbers >> np.uint64(33))
