"""What a camera's picture shows around the vehicle: ground, sky, a road's lanes, test bodies. It
gives a picture of a vehicle alone its scale. It is drawn only: no part of a study or a scene."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.geometry.poses import Pose
from pe_core.scoring.requirements import BODIES, Body

from .colors import Rgba, with_alpha
from .primitives import LayerShape, Primitives, Tag

CornerPair = tuple[Floats, Floats]

BELOW_M = -0.02  # Height of the ground: a floor that the scene has at 0 hides it
FAR_M, SKY_M, SEGMENTS = 400.0, 130.0, 72
"""Radius of the ground, height of the sky at its edge, and sides of both."""
GROUND: tuple[tuple[float, Rgba], ...] = (
    (0.0, (0.150, 0.160, 0.170, 1.0)),
    (12.0, (0.165, 0.175, 0.185, 1.0)),
    (60.0, (0.225, 0.240, 0.255, 1.0)),
    (FAR_M, (0.330, 0.355, 0.380, 1.0)),
)  # Colours of the ground by the distance from the eye [m]: hazy far away
HORIZON: Rgba = (0.560, 0.620, 0.680, 1.0)
ZENITH: Rgba = (0.330, 0.380, 0.440, 0.0)

GRID_M, GRID_FAR_M, GRID_STEP_M = 1.0, 30.0, 2.0
"""Distance of the lines of the grid, how far they reach, and length of the pieces that fade."""
STRONG_EVERY = 5
GRID: Rgba = (0.72, 0.78, 0.84, 0.34)
STRONG: Rgba = (0.80, 0.86, 0.92, 0.75)

LANE_M, LINE_M, ROAD_M = 3.5, 0.12, 150.0
"""Width of a lane and of its lines, and half the length of the road that is drawn."""
DASH_M, GAP_M = 3.0, 6.0
PAINT: Rgba = (0.92, 0.92, 0.90, 0.95)

STANDING: tuple[tuple[str, float, float, Rgba], ...] = (
    ("car", 20.0, 0.0, (0.45, 0.66, 0.86, 1.0)),
    ("cyclist", 10.0, -14.0, (0.52, 0.78, 0.55, 1.0)),
    ("adult", 5.0, 16.0, (0.94, 0.68, 0.36, 1.0)),
)  # Test bodies: name, distance from the sensor [m], bearing to the left [deg], colour
SHADES = (0.78, 0.62, 1.0)  # Brightness of sides along x, of those along y, and of the top


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """The surroundings of a sensor: `ground`, which is behind all else, and `bodies` on it."""

    ground: LayerShape
    bodies: LayerShape


def surroundings(eye: Pose, vehicle: CornerPair | None = None) -> Surroundings:
    """Return what a camera at a pose has around it; no test body stands in the vehicle's bounds.
    Test bodies stand where the camera looks; if it looks straight down, where its top is."""
    x, y = eye.position[:2]
    circles = [(_circle(x, y, radius, BELOW_M), color) for radius, color in GROUND]
    bands = [_band(a[0], b[0], (a[1], b[1])) for a, b in pairwise(circles)]
    sky = _band(circles[-1][0], _circle(x, y, FAR_M, SKY_M), (HORIZON, ZENITH))
    ground = LayerShape(faces=Primitives.joined([*bands, sky, _lanes()]), thin=_grid(x, y))
    ahead, up = eye.ground_from_sensor[:, 0], eye.ground_from_sensor[:, 2]
    along = ahead if math.hypot(ahead[0], ahead[1]) > 1e-3 else -ahead[2] * up
    heading = math.atan2(along[1], along[0])
    faces, lines, labels = [], [], []
    for name, distance, bearing_deg, color in STANDING:
        bearing = heading + math.radians(bearing_deg)
        foot = np.array([x + distance * math.cos(bearing), y + distance * math.sin(bearing)])
        body = BODIES[name]
        if vehicle is not None:
            (low, high), half = (corner[:2] for corner in vehicle), body.largest / 2.0
            if (foot + half > low).all() and (foot - half < high).all():
                continue
        corners = _corners(body, foot, heading)
        faces.append(_sides(corners, color))
        edges = [(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4)]
        dark = with_alpha(tuple(0.35 * value for value in color[:3]), 0.9)
        lines.append(Primitives.of(corners[np.array(edges)], dark))
        top = (float(foot[0]), float(foot[1]), body.low + body.size[2])
        labels.append(Tag(f"{name}, {distance:g} m", top, color))
    bodies = LayerShape(
        faces=Primitives.joined(faces), thin=Primitives.joined(lines), labels=tuple(labels)
    )
    return Surroundings(ground, bodies)


def _corners(body: Body, foot: Floats, heading: float) -> Floats:
    """Return the corners (8, 3) of a body's box; bits of their numbers are x, y and z."""
    length, width, height = body.size
    corners = np.array([*np.ndindex(2, 2, 2)], float) * [length, width, height]
    corners -= [length / 2.0, width / 2.0, -body.low]
    cosine, sine = math.cos(heading), math.sin(heading)
    turned = corners.copy()
    turned[:, 0] = foot[0] + cosine * corners[:, 0] - sine * corners[:, 1]
    turned[:, 1] = foot[1] + sine * corners[:, 0] + cosine * corners[:, 1]
    return turned


def _sides(corners: Floats, color: Rgba) -> Primitives:
    """Return the sides of a box as shaded triangles."""
    quads = {0: ((0, 1, 3, 2), (4, 6, 7, 5)), 1: ((0, 4, 5, 1), (2, 3, 7, 6)), 2: ((1, 5, 7, 3),)}
    parts = []
    for axis, sides in quads.items():
        shade = with_alpha(tuple(SHADES[axis] * value for value in color[:3]), color[3])
        for a, b, c, d in sides:
            parts.append(Primitives.of(corners[[a, b, c, a, c, d]], shade))
    return Primitives.joined(parts)


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
            near, far = y - LINE_M / 2.0, y + LINE_M / 2.0
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
        points[..., axis], points[..., 1 - axis] = across[:, None], along
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
