"""Shapes of objects as meshes in a unit box, scaled to the size that was sampled.

Each is a few convex solids: enough that beams pass under a car, beside a pedestrian's head and
between a cyclist's shoulders and wheels. The unit box is centred over the origin, z from 0 to 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from pe_core.base import Floats

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
Solid = tuple[Any, ...]
"""Arguments of `solid`."""
WHOLE = (-0.5, 0.5)
WAVES = 3
WAVE_M = (40.0, 120.0)
WAVE_SLOPE = 0.025
"""Greatest slope of a wave; three of them rarely add up to more than 5 %."""
GROUND_M = (64.0, 44.0)
"""Half length and half width of the ground."""
CELL_M = 4.0
HOUSES = 10
HOUSE_ATTEMPTS = 40
HOUSE_M = ((8.0, 16.0), (6.0, 10.0), (4.0, 9.0))
STREET_M = 10.0
"""Half the width that is free of houses."""
ROW_M = 5.5
"""Distance of a row of parked cars from the middle of the street."""
ROW_LENGTH_M = 25.0
SPACING_M = (5.6, 7.0)
PARKED_SHARE = 0.7
CAR_M = (4.6, 1.9, 1.7)


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


def _wheels(at: float, length: float, height: float) -> list[Solid]:
    sides = ((-0.5, -0.38), (0.38, 0.5))
    return [((x - length, x + length), y, (0.0, height)) for x in (-at, at) for y in sides]


SHAPES: dict[str, list[Solid]] = {
    "car": [
        (WHOLE, WHOLE, (0.13, 0.56)),
        ((-0.42, 0.24), (-0.47, 0.47), (0.56, 1.0), 0.72),
        *_wheels(0.31, 0.07, 0.3),
    ],
    "truck": [
        ((0.3, 0.5), (-0.48, 0.48), (0.14, 0.8)),
        ((-0.5, 0.28), WHOLE, (0.3, 1.0)),
        *_wheels(0.34, 0.06, 0.3),
    ],
    "pedestrian": [
        ((-0.25, 0.25), (-0.38, -0.08), (0.0, 0.48)),
        ((-0.25, 0.25), (0.08, 0.38), (0.0, 0.48)),
        ((-0.3, 0.3), WHOLE, (0.46, 0.84), 0.8, 6),
        (WHOLE, (-0.5, -0.34), (0.42, 0.8)),
        ((-0.14, 0.18), (-0.14, 0.14), (0.86, 1.0), 0.9, 6),
    ],
    "cyclist": [
        ((-0.5, -0.14), (-0.05, 0.05), (0.0, 0.38), 0.6),
        ((0.14, 0.5), (-0.05, 0.05), (0.0, 0.38), 0.6),
        ((-0.3, 0.3), (-0.04, 0.04), (0.2, 0.5)),
        ((-0.12, 0.06), (-0.22, 0.22), (0.25, 0.6)),
        ((-0.14, 0.2), (-0.4, 0.4), (0.56, 0.86), 0.85, 6),
        ((0.24, 0.3), WHOLE, (0.52, 0.6)),
        ((0.0, 0.16), (-0.16, 0.16), (0.87, 1.0), 0.9, 6),
    ],
    "cone": [(WHOLE, WHOLE, (0.0, 0.05)), ((-0.4, 0.4), (-0.4, 0.4), (0.05, 1.0), 0.15, 8)],
    "tree": [
        ((-0.07, 0.07), (-0.07, 0.07), (0.0, 0.5), 1.0, 8),
        (WHOLE, WHOLE, (0.42, 1.0), 0.4, 8),
    ],
    "bush": [(WHOLE, WHOLE, (0.0, 1.0), 0.6, 8)],
    "post": [(WHOLE, WHOLE, (0.0, 1.0), 1.0, 8)],
    "bollard": [(WHOLE, WHOLE, (0.0, 1.0), 1.0, 8)],
}
"""The solids of each class and distractor, as `solid` takes them; others are a block."""


@cache
def unit_mesh(name: str) -> Floats:
    """Return the triangles (F, 3, 3) of a class or a distractor in the unit box."""
    return np.concatenate([solid(*each) for each in SHAPES.get(name, [(WHOLE, WHOLE, (0.0, 1.0))])])


def placed_mesh(name: str, foot: Floats, size: Floats, yaw: float) -> Floats:
    """Return the mesh of an object that stands at `foot` (3,), with a size (3,) [m, rad]."""
    triangles = unit_mesh(name) * size
    cos = np.cos(yaw)
    sin = np.sin(yaw)
    x = triangles[..., 0]
    y = triangles[..., 1]
    z = triangles[..., 2]
    return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1) + foot


class Ground:
    """Rolling ground: the sum of a few waves, 0 m under the origin."""

    def __init__(self, rng: np.random.Generator) -> None:
        lengths = rng.uniform(*WAVE_M, WAVES)
        turns = rng.uniform(0.0, np.pi, WAVES)
        self._along = np.stack([np.cos(turns), np.sin(turns)]) * 2.0 * np.pi / lengths
        self._phases = rng.uniform(0.0, 2.0 * np.pi, WAVES)
        self._amplitudes = WAVE_SLOPE * lengths / (2.0 * np.pi)

    def height(self, x: Floats, y: Floats) -> Floats:
        """Return the height at points (...,) [m]."""
        phases = x[..., None] * self._along[0] + y[..., None] * self._along[1] + self._phases
        heights = self._amplitudes * (np.sin(phases) - np.sin(self._phases))
        return np.asarray(heights.sum(axis=-1))

    @property
    def triangles(self) -> Floats:
        """Triangles (F, 3, 3) of the ground [m]."""
        xs, ys = (np.arange(-half, half + CELL_M / 2.0, CELL_M) for half in GROUND_M)
        x, y = np.meshgrid(xs, ys, indexing="ij")
        points = np.stack([x, y, self.height(x, y)], axis=-1)
        a = points[:-1, :-1]
        b = points[1:, :-1]
        c = points[1:, 1:]
        d = points[:-1, 1:]
        halves = [np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in ((a, b, c), (a, c, d))]
        return np.concatenate(halves)


def parked_cars(rng: np.random.Generator) -> tuple[list[str], Floats, Floats, Floats]:
    """Return names, feet, sizes and yaws of cars parked in two rows, with gaps."""
    feet = []
    for side in (-ROW_M, ROW_M):
        x = -ROW_LENGTH_M
        while x < ROW_LENGTH_M:
            x += rng.uniform(*SPACING_M)
            if rng.uniform() < PARKED_SHARE:
                feet.append((x, side + rng.normal(0.0, 0.15), 0.0))
    sizes = np.array(CAR_M) * rng.uniform(0.92, 1.08, (len(feet), 3))
    return ["car"] * len(feet), np.array(feet).reshape(-1, 3), sizes, np.zeros(len(feet))


def house_triangles(rng: np.random.Generator, occupied: Floats) -> list[Floats]:
    """Return the meshes of houses beside the street that stand on no object (N, 2)."""
    houses: list[Floats] = []
    for _ in range(HOUSE_ATTEMPTS):
        length, width, height = (rng.uniform(*bounds) for bounds in HOUSE_M)
        x = rng.uniform(-GROUND_M[0], GROUND_M[0])
        y = rng.choice([-1.0, 1.0]) * rng.uniform(STREET_M + width / 2.0, GROUND_M[1])
        offsets = np.abs(occupied - (x, y))
        inside = (offsets[:, 0] < length / 2.0 + 3.0) & (offsets[:, 1] < width / 2.0 + 3.0)
        if not inside.any() and len(houses) < HOUSES:
            houses.append(
                solid(
                    (x - length / 2.0, x + length / 2.0),
                    (y - width / 2.0, y + width / 2.0),
                    (-3.0, height),
                )
            )
    return houses
