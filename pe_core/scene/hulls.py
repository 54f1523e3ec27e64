"""Convex hulls: the room a housing takes, and whether two of them meet."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .geometry import Pose, cross, dot, rotate
from .housing import Housing

Floats = NDArray[np.float64]

SIDES = 16
"""A cylinder counts as the prism of so many sides round it: at most 2 % of its radius more."""
TOUCH_M = 1e-5
"""What overlaps by less than placements are rounded to only touches [m]."""
PARALLEL = 1e-9
"""The cross product of directions that are nearly parallel separates nothing."""


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex hull in the ground frame.

    Attributes
    ----------
    corners : (N, 3) float
        [m]; of a sensor whose housing is not known, its origin alone.
    normals, edges : (K, 3), (E, 3) float
        Unit directions of its faces' normals and of its edges; opposite ones count as one.
    """

    corners: Floats
    normals: Floats
    edges: Floats


def hull_of(pose: Pose, housing: Housing | None) -> Hull:
    """Return the room that a sensor at a pose takes."""
    position = np.array(pose.position)
    if housing is None:
        return Hull(position[None], np.zeros((0, 3)), np.zeros((0, 3)))
    outline, normals, edges = _BOX if housing.shape == "box" else _CYLINDER
    rotation = pose.ground_from_sensor
    corners = housing.center + outline * (np.array(housing.size) / 2.0)
    return Hull(
        position + rotate(rotation, corners), rotate(rotation, normals), rotate(rotation, edges)
    )


def hull_box(low: Floats, high: Floats) -> Hull:
    """Return the box between two corners (3,) [m], along the axes."""
    outline, normals, edges = _BOX
    return Hull((low + high) / 2.0 + outline * ((high - low) / 2.0), normals, edges)


def meet(a: Hull, b: Hull) -> bool:
    """Whether two convex hulls share more than a touch, by separating axes."""
    if _apart(a, b, np.eye(3)):
        return False
    axes = np.concatenate([a.normals, b.normals, _crossed(a.edges, b.edges)])
    return not _apart(a, b, axes)


def _apart(a: Hull, b: Hull, axes: Floats) -> bool:
    """Whether one of axes (K, 3) separates two hulls."""
    one, other = (dot(axes[:, None], hull.corners) for hull in (a, b))
    gap = np.maximum(one.min(1) - other.max(1), other.min(1) - one.max(1))
    return bool((gap >= -TOUCH_M).any())


def _crossed(a: Floats, b: Floats) -> Floats:
    axes = cross(a[:, None], b[None]).reshape(-1, 3)
    size = np.sqrt(dot(axes, axes))
    some = size > PARALLEL
    return axes[some] / size[some, None]


def _prism(flat: Floats, sides: Floats, along: Floats) -> tuple[Floats, Floats, Floats]:
    """Corners in half sizes, normals and edges of an upright prism of an outline (N, 2)."""
    corners = np.array([(x, y, z) for z, (x, y) in product((-1.0, 1.0), flat.tolist())])
    level = np.zeros((len(sides), 1))
    up = np.array([[0.0, 0.0, 1.0]])
    normals = np.concatenate([np.concatenate([sides, level], axis=1), up])
    return corners, normals, np.concatenate([np.concatenate([along, level], axis=1), up])


def _round(first: float, count: int) -> Floats:
    turns = [2.0 * math.pi * (k + first) / SIDES for k in range(count)]
    return np.array([(math.cos(t), math.sin(t)) for t in turns])


_BOX = _prism(np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)]), np.eye(2), np.eye(2))
_CYLINDER = _prism(
    _round(0.5, SIDES) / math.cos(math.pi / SIDES),
    _round(0.0, SIDES // 2),
    _round(SIDES / 4, SIDES // 2),
)
