"""Overlap tests: convex hulls by separating axes, and triangles with boxes or cylinders."""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats
from .poses import Pose, cross, dot, rotate

SIDES = 16
"""Number of sides of the prism that encloses a cylinder: at most 2 % of the radius larger."""
TOUCH_M = 1e-5  # Overlaps up to this depth do not count: positions are rounded [m]
PARALLEL = 1e-9
"""Shorter cross products are not used as axes: the two directions are parallel."""


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex hull in the ground frame: `corners` (N, 3) [m]. `normals` (K, 3) and `edges` (E, 3)
    are unit directions of the faces' normals and of the edges, one for each opposite pair."""

    corners: Floats
    normals: Floats
    edges: Floats


def upright_hull(shape: str, pose: Pose, center: Floats, size: Floats) -> Hull:
    """Return the convex hull of a box or a cylinder that is upright in a frame. `center` (3,) is
    its middle in the frame, `size` (3,) that along the frame's x, y and z [m]."""
    outline, normals, edges = _BOX if shape == "box" else _CYLINDER
    rotation = pose.ground_from_sensor
    corners = center + outline * (size / 2.0)
    return Hull(
        np.array(pose.position) + rotate(rotation, corners),
        rotate(rotation, normals),
        rotate(rotation, edges),
    )


def hull_box(low: Floats, high: Floats) -> Hull:
    """Return the hull of the axis-aligned box between two corners (3,) [m]."""
    outline, normals, edges = _BOX
    return Hull((low + high) / 2.0 + outline * ((high - low) / 2.0), normals, edges)


def overlaps(a: Hull, b: Hull) -> bool:
    """Whether two convex hulls overlap by more than `TOUCH_M`, by the separating axis theorem."""
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
    valid = size > PARALLEL
    return axes[valid] / size[valid, None]


def _prism(flat: Floats, sides: Floats, along: Floats) -> tuple[Floats, Floats, Floats]:
    """Corners (in half sizes), normals and edges of an upright prism over an outline (N, 2)."""
    corners = np.array([(x, y, z) for z, (x, y) in product((-1.0, 1.0), flat.tolist())])
    level = np.zeros((len(sides), 1))
    up = np.array([[0.0, 0.0, 1.0]])
    normals = np.concatenate([np.concatenate([sides, level], axis=1), up])
    return corners, normals, np.concatenate([np.concatenate([along, level], axis=1), up])


def _round(first: float, count: int) -> Floats:
    angles = [2.0 * math.pi * (k + first) / SIDES for k in range(count)]
    return np.array([(math.cos(t), math.sin(t)) for t in angles])


_BOX = _prism(np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)]), np.eye(2), np.eye(2))
_CYLINDER = _prism(
    _round(0.5, SIDES) / math.cos(math.pi / SIDES),
    _round(0.0, SIDES // 2),
    _round(SIDES / 4, SIDES // 2),
)


def meets_box(triangles: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether triangles (N, 3, 3) overlap the box of half sizes (3,) round the origin. Axes: those
    of the box, the triangle's normal, and cross products of edges and axes (Akenine-Moller, Fast 3D
    Triangle-Box Overlap Testing, 2001)."""
    edges = np.roll(triangles, -1, axis=1) - triangles
    axes = [np.broadcast_to(axis, (len(triangles), 3)) for axis in np.eye(3)]
    axes += [cross(edges[:, 0], edges[:, 1])]
    axes += [cross(edges[:, k], axis) for k in range(3) for axis in axes[:3]]
    meets = np.ones(len(triangles), bool)
    for axis in axes:
        along = dot(triangles, axis[:, None])
        reach = dot(np.abs(axis), half)
        meets &= (along.min(axis=1) <= reach) & (along.max(axis=1) >= -reach)
    return meets


def meets_cylinder(triangles: Floats, half: Floats) -> NDArray[np.bool_]:
    """Whether triangles (N, 3, 3) overlap the upright cylinder round the origin. Between the two
    end planes a triangle is a polygon of parts of its edges and sections with the planes. It
    overlaps if such a segment is within the radius of the axis, or the axis crosses it."""
    radius = half[0]
    top = half[2]
    meets = _axis_crosses(triangles, top)
    for start in range(3):
        meets |= _nearest_on_edge(triangles[:, start], triangles[:, (start + 1) % 3], top) <= radius
    for height in (-top, top):
        meets |= _nearest_on_section(triangles, height) <= radius
    return meets


def _axis_crosses(triangles: Floats, top: float) -> NDArray[np.bool_]:
    """Whether the z axis between -top and top crosses triangles."""
    flat = triangles[..., :2]
    a, b, c = (flat[:, k] for k in range(3))
    weights = np.stack([_turn(b, c), _turn(c, a), _turn(a, b)], axis=1)
    area = weights.sum(axis=1)
    around = ((weights >= 0.0).all(axis=1) | (weights <= 0.0).all(axis=1)) & (area != 0.0)
    height = dot(weights, triangles[..., 2]) / np.where(area == 0.0, 1.0, area)
    return around & (np.abs(height) <= top)


def _nearest_on_edge(start: Floats, end: Floats, top: float) -> Floats:
    """Distance (N,) from the axis to edges, cut at heights -top and top; inf for no part."""
    rise = end[:, 2] - start[:, 2]
    level = rise == 0.0
    to_bottom, to_top = (
        (height - start[:, 2]) / np.where(level, 1.0, rise) for height in (-top, top)
    )
    first = np.where(level, 0.0, np.maximum(np.minimum(to_bottom, to_top), 0.0))
    last = np.where(level, 1.0, np.minimum(np.maximum(to_bottom, to_top), 1.0))
    outside = (first > last) | (level & (np.abs(start[:, 2]) > top))
    along = end - start
    ends = (start + t[:, None] * along for t in (first, last))
    return np.where(outside, np.inf, _nearest(*(points[:, :2] for points in ends)))


def _nearest_on_section(triangles: Floats, height: float) -> Floats:
    """Distance (N,) from the axis to triangles' sections with a horizontal plane; inf for none."""
    over = triangles[..., 2] > height
    single = np.argmax(over == (over.sum(axis=1) == 1)[:, None], axis=1)
    row = np.arange(len(triangles))
    one = triangles[row, single]
    ends = []
    for step in (1, 2):
        other = triangles[row, (single + step) % 3]
        rise = other[:, 2] - one[:, 2]
        t = (height - one[:, 2]) / np.where(rise == 0.0, 1.0, rise)
        ends.append((one + t[:, None] * (other - one))[:, :2])
    cut = over.any(axis=1) & ~over.all(axis=1)
    return np.where(cut, _nearest(ends[0], ends[1]), np.inf)


def _nearest(start: Floats, end: Floats) -> Floats:
    """Distance (N,) from the origin to segments in the plane with end points (N, 2)."""
    along = end - start
    size = (along**2).sum(axis=1)
    t = np.clip(-(start * along).sum(axis=1) / np.where(size == 0.0, 1.0, size), 0.0, 1.0)
    point = start + t[:, None] * along
    return np.sqrt((point**2).sum(axis=1))


def _turn(a: Floats, b: Floats) -> Floats:
    """Twice the signed area of the triangle that the origin forms with points (N, 2)."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
