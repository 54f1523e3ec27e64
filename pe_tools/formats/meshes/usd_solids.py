"""Solids that USD describes by their measures, as triangles."""

from collections.abc import Callable
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats

Attributes = Callable[[str], Any]
"""The value of an attribute of a prim, by its name."""
SECTIONS = 32  # Of a whole turn; the area of a ring is 0.6 % short of a circle's
CAP_STEPS = 8  # Of a quarter turn
TO_AXIS = {"X": (2, 0, 1), "Y": (1, 2, 0), "Z": (0, 1, 2)}
"""Which coordinates of a solid along z are its x, y, z when it stands along an axis."""
CUBE = np.array(
    [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
)


def _cube(of: Attributes) -> Floats:
    signs = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    corners = signs * (float(of("size")) / 2.0)
    return np.concatenate([corners[CUBE[:, [0, 1, 2]]], corners[CUBE[:, [0, 2, 3]]]])


def _sphere(of: Attributes) -> Floats:
    return _turned(_arc(float(of("radius")), 0.0, -90.0, 90.0))


def _cylinder(of: Attributes) -> Floats:
    radius = float(of("radius"))
    half = float(of("height")) / 2.0
    profile = np.array([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])
    return _along(_turned(profile), of("axis"))


def _cone(of: Attributes) -> Floats:
    radius = float(of("radius"))
    half = float(of("height")) / 2.0
    return _along(_turned(np.array([(0.0, -half), (radius, -half), (0.0, half)])), of("axis"))


def _capsule(of: Attributes) -> Floats:
    radius = float(of("radius"))
    half = float(of("height")) / 2.0
    ends = _arc(radius, -half, -90.0, 0.0), _arc(radius, half, 0.0, 90.0)
    return _along(_turned(np.concatenate(ends)), of("axis"))


def _plane(of: Attributes) -> Floats:
    x = float(of("width")) / 2.0
    y = float(of("length")) / 2.0
    corners = np.array([(-x, -y, 0.0), (x, -y, 0.0), (x, y, 0.0), (-x, y, 0.0)])
    return _along(corners[[(0, 1, 2), (0, 2, 3)]], of("axis"))


SOLIDS: dict[str, Callable[[Attributes], Floats]] = {
    "Cube": _cube,
    "Sphere": _sphere,
    "Cylinder": _cylinder,
    "Cone": _cone,
    "Capsule": _capsule,
    "Plane": _plane,
}
"""Triangles (F, 3, 3) of a solid in its own frame, by the type of its prim."""


def _arc(radius: float, height: float, first_deg: float, last_deg: float) -> Floats:
    """Points (K, 2) of an arc round a point of the axis: distance from the axis, height."""
    steps = round(abs(last_deg - first_deg) / 90.0 * CAP_STEPS)
    angles = np.radians(np.linspace(first_deg, last_deg, steps + 1))
    return np.stack([radius * np.cos(angles), height + radius * np.sin(angles)], axis=1)


def _turned(profile: Floats) -> Floats:
    """The triangles of a profile (K, 2), from below upwards, turned round the z axis."""
    turns = np.linspace(0.0, 2.0 * np.pi, SECTIONS + 1)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    points = np.empty((len(profile), len(ring), 3))
    points[..., :2] = profile[:, None, :1] * ring
    points[..., 2] = profile[:, None, 1]
    low = points[:-1]
    high = points[1:]
    first = np.stack([low[:, :-1], low[:, 1:], high[:, 1:]], axis=2).reshape(-1, 3, 3)
    second = np.stack([low[:, :-1], high[:, 1:], high[:, :-1]], axis=2).reshape(-1, 3, 3)
    return np.concatenate([first, second])


def _along(triangles: Floats, axis: object) -> Floats:
    """Triangles of a solid along z, along another axis."""
    turned: Floats = triangles[..., TO_AXIS[str(axis)]]
    return turned
