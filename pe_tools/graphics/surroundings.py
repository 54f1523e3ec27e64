"""What a camera's picture shows around the vehicle: ground, sky, a road's lanes. It gives a picture
of a vehicle alone its scale. It is drawn only: no part of a study or a scene."""

import math
from itertools import pairwise

import numpy as np

from pe_core.base.arrays import Floats

from .colors import Rgba
from .primitives import LayerShape, Primitives

BELOW_M = -0.02  # Height of the ground: a floor that the scene has at 0 hides it
FAR_M = 400.0
SKY_M = 130.0
SEGMENTS = 72
"""Radius of the ground, height of the sky at its edge, and sides of both."""
GROUND: tuple[tuple[float, Rgba], ...] = (
    (0.0, (0.150, 0.160, 0.170, 1.0)),
    (12.0, (0.165, 0.175, 0.185, 1.0)),
    (60.0, (0.225, 0.240, 0.255, 1.0)),
    (FAR_M, (0.330, 0.355, 0.380, 1.0)),
)  # Colours of the ground by the distance from the eye [m]: hazy far away
HORIZON: Rgba = (0.560, 0.620, 0.680, 1.0)
ZENITH: Rgba = (0.330, 0.380, 0.440, 0.0)

GRID_M = 1.0
GRID_FAR_M = 30.0
GRID_STEP_M = 2.0
"""Distance of the lines of the grid, how far they reach, and length of the pieces that fade."""
STRONG_EVERY = 5
GRID: Rgba = (0.72, 0.78, 0.84, 0.34)
STRONG: Rgba = (0.80, 0.86, 0.92, 0.75)

LANE_M = 3.5
LINE_M = 0.12
ROAD_M = 150.0
"""Width of a lane and of its lines, and half the length of the road that is drawn."""
DASH_M = 3.0
GAP_M = 6.0
PAINT: Rgba = (0.92, 0.92, 0.90, 0.95)


def surroundings(x: float, y: float) -> LayerShape:
    """Return what a camera above a place on the ground has around it."""
    circles = [(_circle(x, y, radius, BELOW_M), color) for radius, color in GROUND]
    bands = [_band(a[0], b[0], (a[1], b[1])) for a, b in pairwise(circles)]
    sky = _band(circles[-1][0], _circle(x, y, FAR_M, SKY_M), (HORIZON, ZENITH))
    return LayerShape(faces=Primitives.joined([*bands, sky, _lanes()]), thin=_grid(x, y))


def _circle(x: float, y: float, radius: float, z: float) -> Floats:
    angle = np.linspace(0.0, 2.0 * math.pi, SEGMENTS + 1)
    around = [x + radius * np.cos(angle), y + radius * np.sin(angle), np.full(len(angle), z)]
    return np.column_stack(around)


def _band(inner: Floats, outer: Floats, colors: tuple[Rgba, Rgba]) -> Primitives:
    """Return triangles between two circles (N, 3), with the colours of both."""
    quads = [inner[:-1], outer[:-1], outer[1:], inner[:-1], outer[1:], inner[1:]]
    shades = np.array([colors[k] for k in (0, 1, 1, 0, 1, 0)])
    points = np.stack(quads, axis=1)
    return Primitives.of(points, np.broadcast_to(shades, (len(points), 6, 4)))


def _lanes() -> Primitives:
    """Return the lines of three lanes, the vehicle in the middle one: whole at the edges."""
    starts = np.arange(-ROAD_M, ROAD_M, DASH_M + GAP_M)
    dashed = [(at, at + DASH_M) for at in starts]
    quads = []
    for side in (-1.5, -0.5, 0.5, 1.5):
        y = side * LANE_M
        for low, high in [(-ROAD_M, ROAD_M)] if abs(side) > 1.0 else dashed:
            near = y - LINE_M / 2.0
            far = y + LINE_M / 2.0
            quads.append(
                [(low, near), (high, near), (high, far), (low, near), (high, far), (low, far)]
            )
    flat = np.array(quads, float).reshape(-1, 2)
    return Primitives.of(np.column_stack([flat, np.full(len(flat), BELOW_M)]), PAINT)


def _grid(x: float, y: float) -> Primitives:
    """Return the lines of a metre grid that fade with the distance from the eye."""
    count = math.ceil(GRID_FAR_M / GRID_M)
    parts = []
    for axis, middle in enumerate((x, y)):
        other = (y, x)[axis]
        across = (round(middle / GRID_M) + np.arange(-count, count + 1)) * GRID_M
        along = other + np.arange(-GRID_FAR_M, GRID_FAR_M + GRID_STEP_M / 2.0, GRID_STEP_M)
        points = np.empty((len(across), len(along), 3))
        points[..., axis] = across[:, None]
        points[..., 1 - axis] = along
        points[..., 2] = BELOW_M
        strong = np.rint(across / GRID_M) % STRONG_EVERY == 0
        colors = np.where(strong[:, None, None], STRONG, GRID) * np.ones((1, len(along), 1))
        away = np.hypot(points[..., 0] - x, points[..., 1] - y)
        colors[..., 3] *= np.clip(1.0 - away / GRID_FAR_M, 0.0, 1.0)
        ends = np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 3)
        shades = np.stack([colors[:, :-1], colors[:, 1:]], axis=2).reshape(-1, 4)
        shown = (shades[0::2, 3] > 0.0) | (shades[1::2, 3] > 0.0)
        kept = np.repeat(shown, 2)
        parts.append(Primitives.of(ends[kept], shades[kept]))
    return Primitives.joined(parts)
