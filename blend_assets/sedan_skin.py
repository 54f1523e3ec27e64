"""The left half of the sedan's skin as triangles: sample the solid, then cut panels out of it."""

from __future__ import annotations

import numpy as np
import sedan_profile as profile
from curves import Array, Curve
from skin import Skin, from_grids, spread
from surface import root

# quads from the sill to the roof rail, and on to the centre line
SIDE_CELLS = 17
TOP_CELLS = 9
STATIONS = np.concatenate(
    [
        np.linspace(-2.235, -1.80, 7)[:-1],
        np.linspace(-1.80, 1.90, 47),
        np.linspace(1.90, 2.26, 7)[1:],
    ]
)
# Plan curvature of the sampling sheets: straight amidships, bowed like the bumpers at the ends.
SHEET_BOW = Curve((-2.30, -0.29), (-1.70, -0.14), (-1.00, 0.00), (0.60, 0.02), (1.50, 0.12),
                  (2.30, 0.36))  # fmt: skip
# Angle above the horizon, in degrees, of the edge between the side and the top of a section.
EDGE_ANGLE = Curve((-2.30, 31.0), (-1.90, 34.0), (-1.40, 48.0), (-0.80, 53.5), (-0.10, 53.5),
                   (0.35, 49.0), (0.80, 33.0), (1.10, 25.0), (1.60, 20.5), (2.30, 9.0))  # fmt: skip


def onto_sheet(station: float, flat: Array) -> Array:
    """(y, z) pairs to points on the bowed sheet of one station."""
    x = station - SHEET_BOW(station) * flat[:, 0] ** 2
    return np.column_stack([x, flat])


def section(station: float, count: int = 400) -> tuple[Array, Array]:
    """Dense points of one cross section from below the sill to the centre, and their angles."""
    angle = np.radians(np.linspace(-60, 90, count))
    ray = np.column_stack([np.cos(angle), np.sin(angle)])
    low = np.full(count, 0.02)
    high = np.full(count, 1.5)
    for _ in range(30):
        middle = (low + high) / 2
        flat = ray * middle[:, None] + [0, profile.SPINE_Z]
        out = profile.solid(onto_sheet(station, flat)) > 0
        high = np.where(out, middle, high)
        low = np.where(out, low, middle)
    flat = ray * low[:, None] + [0, profile.SPINE_Z]
    return onto_sheet(station, flat), np.degrees(angle)


def ring(station: float) -> Array:
    """One cross section as SIDE_CELLS + TOP_CELLS + 1 points from the sill to the centre."""
    dense, angle = section(station)
    index = np.arange(len(dense))
    floor = np.interp(0, dense[:, 2] - profile.FLOOR(dense[:, 0]), index)
    edge = np.interp(EDGE_ANGLE(station), angle, index)
    side = spread(dense, floor, edge, SIDE_CELLS)
    top = spread(dense, edge, len(dense) - 1, TOP_CELLS)
    points = np.vstack([side, top[1:]])
    points[-1, 1] = 0
    return points


def end_cap(outline: Array, station: float, forward: float) -> Array:
    """Bumper face: fill the last ring with a grid (TOP_CELLS + 1, SIDE_CELLS + 1) of points."""
    side = outline[: SIDE_CELLS + 1]
    top = outline[SIDE_CELLS:][::-1]
    u = np.linspace(0, 1, TOP_CELLS + 1)[:, None, None]
    v = np.linspace(0, 1, SIDE_CELLS + 1)[None, :, None]
    flat = u * side[None, :, 1:] + (1 - u) * (v * top[0, 1:] + (1 - v) * side[0, 1:] * [0, 1])
    flat[:, -1] = top[:, 1:]
    flat[0, :, 0] = 0
    for _ in range(300):  # relax, so that no cell folds in the rounded corner
        ends = (flat[:-2, 1:-1], flat[2:, 1:-1], flat[1:-1, :-2], flat[1:-1, 2:])
        flat[1:-1, 1:-1] = sum(ends) / 4
    start = onto_sheet(station, flat.reshape(-1, 2))
    grid = root(profile.solid, start, start + np.array([forward, 0, 0])).reshape(
        TOP_CELLS + 1, SIDE_CELLS + 1, 3
    )
    grid[-1, :] = side
    grid[:, -1] = top
    return grid


def sample() -> Skin:
    """The uncut left half, open at the floor and at the centre plane."""
    rings = np.array([ring(station) for station in STATIONS])
    rear = end_cap(rings[0], STATIONS[0], -0.6)
    front = end_cap(rings[-1], STATIONS[-1], 0.6)
    return from_grids(profile.solid, (rings, True), (rear, True), (front, False))
