"""Closed surfaces of triangles: whether they are, and what they hold."""

import numpy as np


def is_watertight(corners):
    """Whether every edge of triangles (F, 3, 3) has two, that run along it in opposite directions.

    Points are told apart by where they are alone, as whoever reads an STL has to.
    """
    points = np.ascontiguousarray(corners.reshape(-1, 3), np.float32) + np.float32(0.0)  # no -0
    _, index = np.unique(points.view("V12").ravel(), return_inverse=True)
    a = index.reshape(-1, 3)
    b = np.roll(index.reshape(-1, 3), -1, axis=1)
    there = np.sort((a * len(index) + b).ravel())
    back = np.sort((b * len(index) + a).ravel())
    return bool((np.diff(there) > 0).all() and (there == back).all())


def volume(corners):
    """Volume inside triangles (F, 3, 3); negative where they are inside out."""
    a, b, c = np.asarray(corners, float).transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6.0)
