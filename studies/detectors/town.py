"""What the world *town* has besides objects and distractors: hills, houses and parked cars."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .shapes import solid

Floats = NDArray[np.float64]

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
        a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
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
            box = (x - length / 2.0, x + length / 2.0), (y - width / 2.0, y + width / 2.0)
            houses.append(solid(*box, (-3.0, height)))
    return houses
