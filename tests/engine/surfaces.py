"""Closed surfaces of triangles: whether they are, and what they hold."""

from collections import Counter

import numpy as np

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def edge_counts(faces):
    """How often each directed edge is run along."""
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    return Counter(map(tuple, pairs.tolist()))


def is_watertight(corners):
    """Whether every edge of triangles (F, 3, 3) has two, that run along it in opposite directions.

    Points are told apart by where they are alone, as whoever reads an STL has to.
    """
    _, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    counts = edge_counts(index.reshape(-1, 3))
    once = all(n == 1 for n in counts.values())
    return once and all((b, a) in counts for a, b in counts)


def volume(corners):
    """Volume inside triangles (F, 3, 3); negative where they are inside out."""
    a, b, c = np.asarray(corners, float).transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6.0)


def read_stl(data):
    """Normals and corners (F, 3, 3) of a binary STL file."""
    count = int.from_bytes(data[80:84], "little")
    rows = np.frombuffer(data[84:], FACET)
    assert len(rows) == count
    return rows["normal"], rows["corners"]
