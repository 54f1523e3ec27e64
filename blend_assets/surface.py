"""The skin of an implicit solid: a function of points (n, 3) that is negative inside."""

from __future__ import annotations

import numpy as np
from curves import Array, Field

Solid = Field


def gradient(points: Array, function: Solid) -> Array:
    """Direction (n, 3) in which a function grows; that of a solid points outwards."""
    columns = []
    for axis in range(3):
        offset = np.eye(3)[axis] * 1e-5
        columns.append((function(points + offset) - function(points - offset)) / 2e-5)
    return np.stack(columns, axis=1)


def onto_skin(points: Array, solid: Solid, line: Solid) -> Array:
    """Move points to where a line lies on the skin; points of the centre plane stay in it."""
    centre = np.abs(points[:, 1]) < 1e-6
    for function in (solid, line) * 4 + (solid,):
        slope = gradient(points, function)
        if function is line:  # along the skin only
            normal = gradient(points, solid)
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            slope -= normal * np.sum(slope * normal, axis=1)[:, None]
        slope[centre, 1] = 0
        square = np.maximum(np.sum(slope**2, axis=1), 1e-6)
        points = points - slope * np.clip(function(points) / square, -0.02, 0.02)[:, None]
    return points


def onto_solid(points: Array, solid: Solid) -> Array:
    """Move points to the skin nearby; points of the centre plane stay in it."""
    centre = np.abs(points[:, 1]) < 1e-6
    for _ in range(4):
        slope = gradient(points, solid)
        slope[centre, 1] = 0
        points = points - slope * (solid(points) / np.sum(slope**2, axis=1))[:, None]
    return points


def root(solid: Solid, inside: Array, outside: Array) -> Array:
    """The point on the skin between pairs of points inside and outside of a solid."""
    low = np.zeros(len(inside))
    high = np.ones(len(inside))
    for _ in range(30):
        middle = (low + high) / 2
        out = solid(inside + (outside - inside) * middle[:, None]) > 0
        high = np.where(out, middle, high)
        low = np.where(out, low, middle)
    return inside + (outside - inside) * low[:, None]


def surface_x(solid: Solid, point: Array, forward: float) -> float:
    """Where the line along x through this point meets the skin."""
    low = point[0]
    high = point[0] + forward
    for _ in range(30):
        middle = (low + high) / 2
        out = solid(np.array([[middle, point[1], point[2]]]))[0] > 0
        low, high = (low, middle) if out else (middle, high)
    return low
