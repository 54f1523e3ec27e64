"""Which way a body faces and stands, told from its shape and the names of its parts."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from .body_shape import BodyShape

Floats = NDArray[np.float64]

LONGER = 1.15
"""One side is longer than another from this ratio on."""
EVEN, UNEVEN = 0.01, 5.0
"""`BodyShape.lopsided`: from side to side less than the first, along the other two axes more than
one and a half times that, and so many times as much as from side to side."""
FRONT = ("hood", "bonnet", "headl", "windshield", "windscreen", "grill", "front")
REAR = ("tail", "trunk", "boot", "rear", "back")
WHEELS, NO_WHEELS = ("wheel", "tire", "tyre"), ("steering", "spare", "arch", "well")
"""What a word in a part's name begins with when it is at the front, at the rear; when it is a
wheel, and when it only sounds like one."""
WORD = re.compile("[A-Z]*[a-z]+|[A-Z]+")
APART = 0.25
"""Front and rear are apart by this share of the body's side along which they are."""
LOW, LEVEL = -0.1, 0.1
"""Wheels are lower than the body's middle by more than this share of its height, and elsewhere
are nearer to it."""
ON_GROUND = 0.05
"""What is within this share of a side from 0 stands there, or has its middle there."""


def front_by_names(shape: BodyShape) -> tuple[int, float] | None:
    """Tell the axis (0, 1 or 2) and the sign of where the parts of the front are."""
    front, rear = named_parts(shape, FRONT, REAR), named_parts(shape, REAR, FRONT)
    if not front or not rear:
        return None
    way = np.mean(front, axis=0) - np.mean(rear, axis=0)
    axis = int(np.argmax(np.abs(way)))
    if abs(way[axis]) < APART * shape.size[axis]:
        return None
    return axis, float(np.sign(way[axis]))


def wheel_center(shape: BodyShape) -> Floats | None:
    """Return the middle of the parts that are wheels by their names (3,) [m]."""
    wheels = named_parts(shape, WHEELS, NO_WHEELS)
    return np.mean(wheels, axis=0) if wheels else None


def named_parts(shape: BodyShape, begin: tuple[str, ...], but: tuple[str, ...]) -> list[Floats]:
    """Return the middles of parts whose names have a word that begins so, and none as in `but`."""
    found = []
    for name, center in shape.part_centers().items():
        if is_called(name, begin, but):
            found.append(center)
    return found


def is_called(name: str, begin: tuple[str, ...], but: tuple[str, ...]) -> bool:
    """Whether a name has a word that begins so, and none as in `but`."""
    words = [word.lower() for word in WORD.findall(name)]
    return any(w.startswith(begin) for w in words) and not any(w.startswith(but) for w in words)


def across(shape: BodyShape) -> int | None:
    """Axis along which the body is its own mirror image, where it is so along one alone."""
    axis = int(np.argmin(shape.lopsided))
    others = [v for k, v in enumerate(shape.lopsided) if k != axis]
    least = shape.lopsided[axis]
    clear = least < EVEN and min(others) > max(UNEVEN * least, 1.5 * EVEN)
    return axis if clear else None


def up_of(shape: BodyShape) -> tuple[int, str] | None:
    """Tell whether y (1) or z (2) is up, and by what: "part names" or "shape"; None: unclear."""
    if (axis := _up_by_wheels(shape)) is not None:
        return axis, "part names"
    if (axis := _up_by_mirror(shape)) is not None or (axis := _up_by_ground(shape)) is not None:
        return axis, "shape"
    return None


def along(shape: BodyShape, up: int) -> int | None:
    """Axis along which a body is long, whose axis `up` is known; None where that is not clear."""
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
    for axis, own, other in ((1, *shift), (2, *shift[::-1])):
        if own < LOW and abs(other) < LEVEL:
            return axis
    return None


def _up_by_mirror(shape: BodyShape) -> int | None:
    """A body that is its own mirror image along z or y has the other one up."""
    mirrored = across(shape)
    if mirrored == 0:  # as long along the one of y and z as it is high along the other
        _, y, z = shape.size
        return 1 if z > LONGER * y else 2 if y > LONGER * z else None
    return {1: 2, 2: 1}.get(-1 if mirrored is None else mirrored)


def _up_by_ground(shape: BodyShape) -> int | None:
    """A body stands on 0 along one axis, and has its middle there along the other."""
    low, high = shape.bounds
    size = high - low
    stands = np.abs(low) <= ON_GROUND * size
    middle = np.abs(low + high) <= ON_GROUND * size
    if stands[1] and middle[2] and not stands[2]:
        return 1
    return 2 if stands[2] and middle[1] and not stands[1] else None
