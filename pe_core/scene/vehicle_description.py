"""A vehicle described: axles, up and forward axis by shape and parts' names, a line of text."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.errors import plural
from ..base.setting import Panel, check_settings, required_setting, setting
from ..base.values import Number
from ..geometry.poses import METRES
from .mesh import BodyShape, size_words
from .vehicle import Vehicle

LONGER = 1.15  # Minimum ratio of two sides for one to count as longer
EVEN = 0.01
UNEVEN = 5.0
"""Limits for `BodyShape.lopsided`: across the vehicle it is below EVEN; along the other two axes it
is above 1.5 EVEN, and above UNEVEN times the value across."""
FRONT = ("hood", "bonnet", "headl", "windshield", "windscreen", "grill", "front")
REAR = ("tail", "trunk", "boot", "rear", "back")
WHEELS = ("wheel", "tire", "tyre")
NO_WHEELS = ("steering", "spare", "arch", "well")
"""Beginnings of words in the names of parts: parts at the front, parts at the rear, wheels, and
parts whose names contain a word for wheels but that are none."""
WORD = re.compile("[A-Z]*[a-z]+|[A-Z]+")
APART = 0.25
"""Minimum distance of front parts from rear parts, as a share of the body's side on that axis."""
LOW = -0.1
LEVEL = 0.1
"""Limits for the centre of the wheels relative to the body's centre, as a share of the side: below
LOW along the up axis, and within LEVEL across the vehicle."""
ON_GROUND = 0.05
"""Tolerance for a bottom, or a middle, at coordinate 0, as a share of the side."""
BINS = 40
QUARTER = 10
"""Number of slices along a body, and how many of them are one end."""
LOWER = 0.15
"""Minimum height difference of the two ends, as a share of the body's height."""
LOW_END = 0.85
"""Maximum height of a hood, a bed or a boot, as a share of the body's height."""
UPRIGHT = 1
SLOPED = 3
"""Maximum number of slices in which a bed's end rises to the cabin, behind its upright rear window;
minimum number of slices of a windshield."""
TRIANGLES = 20_000
POINTS = 1_000_000
"""Maximum number of sampled triangles, and approximate number of sample points in total."""
MIN_STEPS = 8
MAX_STEPS = 128
"""Range of the number of steps along an edge."""
LENGTH = Number(0.0, above=True, cap=100.0, unit="m", noun="length")
UNKNOWN = "not known"
FIELD_M = 100.0
"""Text for 0 in Blender's panel, and maximum of its fields."""
AXLE_APART_M = 0.3
"""Minimum distance of two axles along the vehicle; nearer wheels are on one or on twin axles."""
ROUNDED = 4  # Decimals of a guessed length [m]: a tenth of a millimetre
UP = 2


def front_by_names(shape: BodyShape) -> tuple[int, float] | None:
    """Return the forward axis (0, 1 or 2) and its sign, by the names of parts; None if unclear."""
    front = named_parts(shape, FRONT, REAR)
    rear = named_parts(shape, REAR, FRONT)
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
    size = np.array(shape.size)
    low, high = shape.bounds
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


def hood_end(shape: BodyShape, axis: int, up: int) -> float | None:
    """Return the end of a car, along an axis, that has the hood: 1.0 or -1.0; None if unclear. Seen
    from the side, a car is lower at its hood than at its rear; a pickup may be lower at its bed,
    which ends at an upright window. A body that is taller than wide is not evaluated: the load of a
    lorry may be lower than its cab."""
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
    lower, higher = (outline[::-1], outline) if difference > 0.0 else (outline, outline[::-1])
    is_hood = not _is_bed(lower, higher)
    return 1.0 if (difference > 0.0) == is_hood else -1.0


def _is_bed(lower: Floats, higher: Floats) -> bool:
    """Whether the lower end of a body is a pickup's bed. `lower` and `higher` are its outline
    (BINS,), each from one end."""
    is_low = float(np.median(higher[1 : QUARTER // 2])) < LOW_END
    return is_low and _slope(lower) <= UPRIGHT and _slope(higher) >= SLOPED


def _slope(outline: Floats) -> int:
    """Return in how many slices the outline rises from its end to the cabin: by the middle half of
    the difference."""
    level = float(np.median(outline[1 : QUARTER // 2]))
    top = float(outline.max())
    start, stop = (
        int(np.argmax(outline > level + share * (top - level))) for share in (0.25, 0.75)
    )
    return stop - start


def _outline(shape: BodyShape, axis: int, up: int) -> Floats:
    """Return the top of a body in slices along an axis (BINS,), as a share of its height. Empty
    slices are 0."""
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


def _field(name: str, label: str, **options: Any) -> Panel:
    return Panel(name, label, max=FIELD_M, soft_max=10.0, precision=3, **options)


@dataclass(frozen=True, slots=True)
class Reference:
    """Axles of a vehicle, in the ground frame, and its overhangs, as its fields say [m].

    `InputError` when a value is not a number, or out of its range.
    """

    rear_axle_x: float = required_setting(
        METRES,
        "Middle of the rear axle: forward of the origin",
        _field("rear_axle_x", "Rear Axle X", default=-1.3, min=-FIELD_M),
    )
    rear_axle_z: float = required_setting(
        LENGTH,
        "Middle of the rear axle: above the ground",
        _field("rear_axle_z", "Rear Axle Z", default=0.3, min=0.001),
    )
    wheelbase: float | None = setting(
        None,
        LENGTH,
        "From the rear axle to the front one",
        _field("wheelbase", "Wheelbase", zero=UNKNOWN),
    )
    front_overhang: float | None = setting(
        None,
        METRES,
        "From the front axle to the foremost point",
        _field("front_overhang", "Front Overhang", min=0.0, zero=UNKNOWN),
    )
    rear_overhang: float | None = setting(
        None,
        METRES,
        "From the rear axle to the rearmost point",
        _field("rear_overhang", "Rear Overhang", min=0.0, zero=UNKNOWN),
    )

    def __post_init__(self) -> None:
        check_settings(self, "reference")


def guessed_reference(vehicle: Vehicle | None) -> Reference | None:
    """Guess the axles from the parts that are wheels by name; None if there is no guess.

    The rearmost wheel gives the rear axle, the foremost wheel the front axle. There is no guess for
    fewer than two wheels, or wheels nearer than `AXLE_APART_M` along the vehicle.
    """
    wheels = [] if vehicle is None else _wheels(vehicle)
    if vehicle is None or len(wheels) < 2:
        return None
    by_x = sorted(wheels, key=lambda center: center[0])
    rear = by_x[0]
    front = by_x[-1]
    if front[0] - rear[0] < AXLE_APART_M:
        return None
    low, high = vehicle.bounds
    numbers = (rear[0], rear[2], front[0] - rear[0], high[0] - front[0], rear[0] - low[0])
    return Reference(*(round(float(number), ROUNDED) for number in numbers))


def _wheels(vehicle: Vehicle) -> list[Floats]:
    """Return the centres of the parts that are wheels, (3,) each [m]."""
    centers = []
    for number, name in enumerate(vehicle.part_names):
        points = vehicle.triangles[vehicle.parts == number].reshape(-1, 3)
        if len(points) and is_called(name, WHEELS, NO_WHEELS):
            centers.append((points.min(axis=0) + points.max(axis=0)) / 2.0)
    return centers


def vehicle_line(vehicle: Vehicle, faces: str = "", notes: Sequence[str] = ()) -> str:
    """Return "4.70 x 1.85 x 1.45 m, faces +x, 15,498 triangles, 22 parts".

    `faces`: Text on how the axes of its file were interpreted. Without it, the line has the
        direction that follows from the names of the parts, or the axis along which the vehicle is
        long.
    `notes`: What of its file is left out; it ends the line.
    """
    low, high = vehicle.bounds
    size = size_words(tuple((high - low).tolist()))
    triangles = plural(len(vehicle.triangles), "triangle")
    parts = plural(len(vehicle.part_names), "part")
    shape = BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))
    if not faces and (forward := front_by_names(shape)) is not None and forward[0] != UP:
        faces = f"faces {'+' if forward[1] > 0 else '-'}{'xyz'[forward[0]]}"
    if not faces and (axis := along(shape, UP)) is not None:
        faces = f"lies along {'xyz'[axis]}"
    texts = (size, faces, triangles, parts)
    return "; ".join([", ".join(text for text in texts if text), *notes])
