"""Shapes of objects as meshes in a unit box, scaled to the size that was sampled.

Each is a few convex solids: enough that beams pass under a car, beside a pedestrian's head and
between a cyclist's shoulders and wheels. The unit box is centred over the origin, z from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

DISTRACTORS = {
    "post": (0.15, 0.15, 2.5),
    "bush": (1.2, 1.0, 1.1),
    "bin": (0.6, 0.6, 1.1),
    "wall": (3.0, 0.3, 1.0),
    "cabinet": (1.2, 0.5, 1.3),
    "bollard": (0.2, 0.2, 0.8),
    "tree": (2.4, 2.4, 4.5),
}
"""Length, width, height [m] of what is no object to be found."""
SQUARE = 4


def solid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float], top: float = 1.0, sides: int = 4
) -> Floats:
    """Return the triangles (F, 3, 3) of a prism that fills a box (low, high), or of a frustum.

    `top` is the size of the upper face relative to the lower one, `sides` are corners of the faces.
    """
    angles = 2.0 * np.pi * (np.arange(sides) + 0.5) / sides
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    circle /= np.abs(circle).max(axis=0)
    halves = np.array([x[1] - x[0], y[1] - y[0]]) / 2.0
    middle = np.array([x[1] + x[0], y[1] + y[0]]) / 2.0
    rings = [
        np.column_stack([circle * halves * scale + middle, np.full(sides, height)])
        for scale, height in ((1.0, z[0]), (top, z[1]))
    ]
    triangles = []
    for k in range(sides):
        (a, b), (c, d) = ((ring[k], ring[(k + 1) % sides]) for ring in rings)
        triangles += [(a, b, d), (a, d, c)]
        if k > 0:
            below, above = rings
            triangles += [(below[0], below[(k + 1) % sides], below[k])] * (k + 1 < sides)
            triangles += [(above[0], above[k], above[(k + 1) % sides])] * (k + 1 < sides)
    return np.array(triangles)


def _wheels(at: float, length: float, height: float) -> list[Floats]:
    return [
        solid((x - length, x + length), y, (0.0, height))
        for x in (-at, at)
        for y in ((-0.5, -0.38), (0.38, 0.5))
    ]


def _car() -> list[Floats]:
    body = solid((-0.5, 0.5), (-0.5, 0.5), (0.13, 0.56))
    return [body, solid((-0.42, 0.24), (-0.47, 0.47), (0.56, 1.0), 0.72), *_wheels(0.31, 0.07, 0.3)]


def _truck() -> list[Floats]:
    cab = solid((0.3, 0.5), (-0.48, 0.48), (0.14, 0.8))
    return [cab, solid((-0.5, 0.28), (-0.5, 0.5), (0.3, 1.0)), *_wheels(0.34, 0.06, 0.3)]


def _pedestrian() -> list[Floats]:
    legs = [solid((-0.25, 0.25), y, (0.0, 0.48)) for y in ((-0.38, -0.08), (0.08, 0.38))]
    return [
        *legs,
        solid((-0.3, 0.3), (-0.5, 0.5), (0.46, 0.84), 0.8, 6),
        solid((-0.5, 0.5), (-0.5, -0.34), (0.42, 0.8)),
        solid((-0.14, 0.18), (-0.14, 0.14), (0.86, 1.0), 0.9, 6),
    ]


def _cyclist() -> list[Floats]:
    wheels = [solid(x, (-0.05, 0.05), (0.0, 0.38), 0.6) for x in ((-0.5, -0.14), (0.14, 0.5))]
    return [
        *wheels,
        solid((-0.3, 0.3), (-0.04, 0.04), (0.2, 0.5)),
        solid((-0.12, 0.06), (-0.22, 0.22), (0.25, 0.6)),
        solid((-0.14, 0.2), (-0.4, 0.4), (0.56, 0.86), 0.85, 6),
        solid((0.24, 0.3), (-0.5, 0.5), (0.52, 0.6)),
        solid((0.0, 0.16), (-0.16, 0.16), (0.87, 1.0), 0.9, 6),
    ]


def _cone() -> list[Floats]:
    plate = solid((-0.5, 0.5), (-0.5, 0.5), (0.0, 0.05))
    return [plate, solid((-0.4, 0.4), (-0.4, 0.4), (0.05, 1.0), 0.15, 8)]


def _tree() -> list[Floats]:
    trunk = solid((-0.07, 0.07), (-0.07, 0.07), (0.0, 0.5), 1.0, 8)
    return [trunk, solid((-0.5, 0.5), (-0.5, 0.5), (0.42, 1.0), 0.4, 8)]


def _bush() -> list[Floats]:
    return [solid((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0), 0.6, 8)]


def _block(sides: int) -> list[Floats]:
    return [solid((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0), 1.0, sides)]


@cache
def unit_mesh(name: str) -> Floats:
    """Return the triangles (F, 3, 3) of a class or a distractor in the unit box."""
    shaped = {
        "car": _car,
        "truck": _truck,
        "pedestrian": _pedestrian,
        "cyclist": _cyclist,
        "cone": _cone,
        "tree": _tree,
        "bush": _bush,
    }
    if name in shaped:
        return np.concatenate(shaped[name]())
    return np.concatenate(_block(8 if name in ("post", "bollard") else SQUARE))


def placed_mesh(name: str, foot: Floats, size: Floats, yaw: float) -> Floats:
    """Return the mesh of an object that stands at `foot` (3,), with a size (3,) [m, rad]."""
    triangles = unit_mesh(name) * size
    cos, sin = np.cos(yaw), np.sin(yaw)
    x, y, z = triangles[..., 0], triangles[..., 1], triangles[..., 2]
    return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1) + foot
