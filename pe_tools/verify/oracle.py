"""Measurements by brute force, written on its own: shares no code with the engine.

Every beam is clipped against every cube (Liang and Barsky), every ray tested against every triangle
(Moller and Trumbore), every cube's image is a convex hull (Andrew's monotone chain) clipped to the
image (Sutherland and Hodgman). Slow, and meant to be.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Pixel = tuple[float, float]
IN_FRONT = 1e-6
"""In sides; a corner nearer to a camera's plane is behind it."""


def rotation(rpy: Sequence[float]) -> Floats:
    """Return the rotation (3, 3), ground from sensor, of roll, pitch and yaw [rad]."""
    cr, sr, cp, sp, cy, sy = (f(a) for a in rpy for f in (math.cos, math.sin))
    rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return rz @ ry @ rx


def beam_directions(elevations: ArrayLike, azimuths: Floats, rpy: Sequence[float]) -> Floats:
    """Return directions (C * A, 3), ground frame, of elevations (C,) and azimuths (C, A) [rad]."""
    e = np.asarray(elevations)[:, None]
    local = np.stack(
        [np.cos(e) * np.cos(azimuths), np.cos(e) * np.sin(azimuths), np.sin(e) + 0 * azimuths], -1
    )
    return local.reshape(-1, 3) @ rotation(rpy).T


def first_hits(
    origin: Floats, directions: Floats, triangles: Floats
) -> tuple[Floats, NDArray[np.int_]]:
    """Return distances (B,) to the nearest triangle, inf for a miss, and its index (B,), -1."""
    best = np.full(len(directions), np.inf)
    which = np.full(len(directions), -1)
    for index, (a, b, c) in enumerate(triangles):
        e1 = b - a
        e2 = c - a
        h = np.cross(directions, e2)
        det = h @ e1
        with np.errstate(divide="ignore", invalid="ignore"):
            s = origin - a
            u = (h @ s) / det
            q = np.cross(s, e1)
            v = (directions @ q) / det
            t = (e2 @ q) / det
            hit = (det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        hit &= t < best
        best[hit] = t[hit]
        which[hit] = index
    return best, which


def count_beams(
    origin: Floats, directions: Floats, ends: Floats, center: Floats, side: float
) -> int:
    """Return how many beams meet the cube before their ends [m]."""
    low = center - side / 2 - origin
    high = center + side / 2 - origin
    t0 = np.zeros(len(directions))
    t1 = np.full(len(directions), np.inf)
    alive = np.ones(len(directions), bool)
    for k in range(3):
        d = directions[:, k]
        parallel = np.abs(d) < 1e-300
        alive &= ~parallel | ((low[k] <= 0) & (high[k] >= 0))
        d = np.where(parallel, 1.0, d)
        near = np.minimum(low[k] / d, high[k] / d)
        far = np.maximum(low[k] / d, high[k] / d)
        t0 = np.where(parallel, t0, np.maximum(t0, near))
        t1 = np.where(parallel, t1, np.minimum(t1, far))
    return int((alive & (t0 <= t1) & (t0 <= ends)).sum())


def pixel_area(
    camera_size: tuple[int, int],
    hfov: float,
    origin: ArrayLike,
    rpy: Sequence[float],
    center: Floats,
    side: float,
) -> float:
    """Return the area of the clipped convex hull of the cube's eight projected corners [px]."""
    width, height = camera_size
    focal = width / (2 * math.tan(hfov / 2))
    points = []
    for signs in np.ndindex(2, 2, 2):
        corner = center + side * (np.array(signs) - 0.5) - origin
        x, y, z = rotation(rpy).T @ corner
        if x <= IN_FRONT * side:
            return 0.0
        points.append((width / 2 - focal * y / x, height / 2 - focal * z / x))
    return outline_area(points, width, height)


def outline_area(points: Sequence[Pixel], width: float, height: float) -> float:
    """Return the area of the convex hull of points, clipped to the picture [px]."""
    return _area(_clip(_hull(points), width, height))


def hidden(origin: Floats, center: Floats, side: float, triangles: Floats) -> bool:
    """Whether a triangle is before a voxel: its centre, a little nearer along each axis."""
    nudge = [1e-8 * side * math.sqrt(n) for n in (5, 11, 26)]
    ray = center - origin
    ray = np.array([w + n if w < -1e-9 else w - n for w, n in zip(ray, nudge, strict=True)])
    distance = math.sqrt(sum(w * w for w in ray))
    return bool(first_hits(origin, ray[None] / distance, triangles)[0][0] < distance)


def _hull(points: Sequence[Pixel]) -> list[Pixel]:
    points = sorted(set(points))
    chains = []
    for ordered in (points, points[::-1]):
        chain: list[Pixel] = []
        for p in ordered:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], p) <= 0:
                chain.pop()
            chain.append(p)
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def _turn(a: Pixel, b: Pixel, c: Pixel) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _clip(polygon: list[Pixel], width: float, height: float) -> list[Pixel]:
    sides: list[tuple[Callable[[Pixel], float], float, int]] = [
        (lambda p: p[0], 0.0, 1),
        (lambda p: p[0], width, -1),
        (lambda p: p[1], 0.0, 1),
        (lambda p: p[1], height, -1),
    ]
    for coordinate, limit, sign in sides:
        clipped = []
        for i, p in enumerate(polygon):
            q = polygon[(i + 1) % len(polygon)]
            dp = sign * (coordinate(p) - limit)
            dq = sign * (coordinate(q) - limit)
            if dp >= 0:
                clipped.append(p)
            if dp * dq < 0:
                t = dp / (dp - dq)
                clipped.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
        polygon = clipped
    return polygon


def _area(polygon: list[Pixel]) -> float:
    total = sum(
        p[0] * q[1] - q[0] * p[1] for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    )
    return abs(total) / 2
