"""Orientation of a vehicle's mesh: up and forward axis, from its shape and its parts' names."""

from __future__ import annotations

import re

import numpy as np

from ..base.arrays import Floats
from .body_shape import BodyShape

LONGER = 1.15
"""Minimum ratio of two sides for one to count as longer."""
EVEN, UNEVEN = 0.01, 5.0
"""Limits for `BodyShape.lopsided`: across the vehicle it is below EVEN; along the other two axes it
is above 1.5 EVEN, and above UNEVEN times the value across."""
FRONT = ("hood", "bonnet", "headl", "windshield", "windscreen", "grill", "front")
REAR = ("tail", "trunk", "boot", "rear", "back")
WHEELS, NO_WHEELS = ("wheel", "tire", "tyre"), ("steering", "spare", "arch", "well")
"""Beginnings of words in the names of parts: parts at the front, parts at the rear, wheels, and
parts whose names contain a word for wheels but that are none."""
WORD = re.compile("[A-Z]*[a-z]+|[A-Z]+")
APART = 0.25
"""Minimum distance of front parts from rear parts, as a share of the body's side on that axis."""
LOW, LEVEL = -0.1, 0.1
"""Limits for the centre of the wheels relative to the body's centre, as a share of the side: below
LOW along the up axis, and within LEVEL across the vehicle."""
ON_GROUND = 0.05
"""Tolerance for a bottom, or a middle, at coordinate 0, as a share of the side."""


def front_by_names(shape: BodyShape) -> tuple[int, float] | None:
    """Return the forward axis (0, 1 or 2) and its sign, by the names of parts; None if unclear."""
    front, rear = named_parts(shape, FRONT, REAR), named_parts(shape, REAR, FRONT)
    if not front or not rear:
        return None
    offset = np.mean(front, axis=0) - np.mean(rear, axis=0)
    axis = int(np.argmax(np.abs(offset)))
    if abs(offset[axis]) < APART * shape.size[axis]:
        return None
    return axis, float(np.sign(offset[axis]))


def wheel_center(shape: BodyShape) -> Floats | None:
    """Return the mean centre (3,) [m] of the parts that are wheels by name; None without wheels."""
    wheels = named_parts(shape, WHEELS, NO_WHEELS)
    return np.mean(wheels, axis=0) if wheels else None


def named_parts(shape: BodyShape, begin: tuple[str, ...], skip: tuple[str, ...]) -> list[Floats]:
    """Return the centres (3,) [m] of the parts whose names `is_called` accepts."""
    centers = []
    for name, center in shape.part_centers().items():
        if is_called(name, begin, skip):
            centers.append(center)
    return centers


def is_called(name: str, begin: tuple[str, ...], skip: tuple[str, ...]) -> bool:
    """Whether a word of a name begins with one of `begin`, and no word with one of `skip`."""
    words = [word.lower() for word in WORD.findall(name)]
    return any(w.startswith(begin) for w in words) and not any(w.startswith(skip) for w in words)


def across(shape: BodyShape) -> int | None:
    """Return the only axis along which the body equals its mirror image; None if unclear."""
    axis = int(np.argmin(shape.lopsided))
    other_values = [v for k, v in enumerate(shape.lopsided) if k != axis]
    lowest = shape.lopsided[axis]
    clear = lowest < EVEN and min(other_values) > max(UNEVEN * lowest, 1.5 * EVEN)
    return axis if clear else None


def up_of(shape: BodyShape) -> tuple[int, str] | None:
    """Return the up axis, y (1) or z (2), and its evidence, "part names" or "shape"; or None."""
    if (axis := _up_by_wheels(shape)) is not None:
        return axis, "part names"
    if (axis := _up_by_mirror(shape)) is not None or (axis := _up_by_ground(shape)) is not None:
        return axis, "shape"
    return None


def along(shape: BodyShape, up: int) -> int | None:
    """Return the axis along which a body is long, for a known `up` axis; None if unclear."""
    one, other = (axis for axis in range(3) if axis != up)
    mirrored = across(shape)
    if mirrored in (one, other):
        return one + other - mirrored
    if shape.size[one] > LONGER * shape.size[other]:
        return one
    return other if shape.size[other] > LONGER * shape.size[one] else None


def _up_by_wheels(shape: BodyShape) -> int | None:
    wheels = wheel_center(shape)
    size, (low, high) = np.array(shape.size), shape.bounds
    if wheels is None or not size[1:].all():
        return None
    _, *shift = (wheels - (low + high) / 2.0) / np.where(size > 0.0, size, 1.0)
    for axis, along_axis, across_axis in ((1, *shift), (2, *shift[::-1])):
        if along_axis < LOW and abs(across_axis) < LEVEL:
            return axis
    return None


def _up_by_mirror(shape: BodyShape) -> int | None:
    """Return the up axis by symmetry: a body symmetric along y has z up, and vice versa."""
    mirrored = across(shape)
    if mirrored == 0:  # x is across: the shorter of y and z is up
        _, y, z = shape.size
        return 1 if z > LONGER * y else 2 if y > LONGER * z else None
    return {1: 2, 2: 1}.get(-1 if mirrored is None else mirrored)


def _up_by_ground(shape: BodyShape) -> int | None:
    """Return the up axis as that where the bottom is at 0, if the middle is at 0 on the other."""
    low, high = shape.bounds
    size = high - low
    stands = np.abs(low) <= ON_GROUND * size
    middle = np.abs(low + high) <= ON_GROUND * size
    if stands[1] and middle[2] and not stands[2]:
        return 1
    return 2 if stands[2] and middle[1] and not stands[1] else None


BINS, QUARTER = 40, 10
"""Number of slices along a body, and how many of them are one end."""
LOWER = 0.15
"""Minimum height difference of the two ends, as a share of the body's height."""
TRIANGLES, POINTS = 20_000, 1_000_000
"""Maximum number of sampled triangles, and approximate number of sample points in total."""
MIN_STEPS, MAX_STEPS = 8, 128
"""Range of the number of steps along an edge."""


def hood_end(shape: BodyShape, axis: int, up: int) -> float | None:
    """Return the end of a car, along an axis, that has the hood: 1.0 or -1.0; None if unclear.

    Seen from the side, a car is lower at its hood than at its rear. A body that is taller than wide
    is not evaluated: the load of a lorry may be lower than its cab.
    """
    other = 3 - axis - up
    size = shape.size
    if not size[up] < size[other] <= size[axis] or not size[up] > 0.0:
        return None
    outline = _outline(shape, axis, up)
    ends = [end[end > 0.0] for end in (outline[:QUARTER], outline[-QUARTER:])]
    if not all(len(end) for end in ends):
        return None
    difference = float(ends[0].mean() - ends[1].mean())
    if abs(difference) <= LOWER:
        return None
    return 1.0 if difference > 0.0 else -1.0


def _outline(shape: BodyShape, axis: int, up: int) -> Floats:
    """Return the top of a body in slices along an axis (BINS,), as a share of its height.

    Empty slices are 0.
    """
    sample = shape.triangles if shape.is_ours is None else shape.triangles[shape.is_ours]
    sample = sample[:: -(-len(sample) // TRIANGLES)]
    low, high = shape.bounds
    weights = _weights(min(max(int((2.0 * POINTS / len(sample)) ** 0.5), MIN_STEPS), MAX_STEPS))
    x, height = (((sample[..., k] - low[k]) / (high[k] - low[k])) @ weights.T for k in (axis, up))
    slices = np.clip((x * BINS).astype(np.int64), 0, BINS - 1)
    outline = np.zeros(BINS)
    np.maximum.at(outline, slices.reshape(-1), height.reshape(-1))
    return outline


def _weights(edge: int) -> Floats:
    """Barycentric weights (N, 3) of points spread over a triangle, `edge` steps along an edge."""
    steps = [(i, j, edge - i - j) for i in range(edge + 1) for j in range(edge + 1 - i)]
    return np.array(steps, dtype=float) / edge
