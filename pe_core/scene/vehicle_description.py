"""Description of a vehicle: its axles, and a line with its size, direction and parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..base.arrays import Floats
from ..base.errors import plural
from ..base.setting import Panel, check_settings, required_setting, setting
from ..base.values import Number
from ..geometry.poses import METRES
from .body_shape import BodyShape, size_words
from .orientation import NO_WHEELS, WHEELS, along, front_by_names, is_called
from .vehicle import Vehicle

LENGTH = Number(0.0, above=True, cap=100.0, unit="m", noun="length")
UNKNOWN, FIELD_M = "not known", 100.0
"""Text for 0 in Blender's panel, and maximum of its fields."""
AXLE_APART_M = 0.3
"""Minimum distance of two axles along the vehicle; nearer wheels are on one or on twin axles."""
ROUNDED = 4
"""Decimals of a guessed length [m]: a tenth of a millimetre."""


def _field(name: str, label: str, **options: Any) -> Panel:
    return Panel(name, label, max=FIELD_M, soft_max=10.0, precision=3, **options)


@dataclass(frozen=True, slots=True)
class Reference:
    """Axles of a vehicle, in the ground frame.

    Parameters
    ----------
    rear_axle_x, rear_axle_z : float
        Middle of the rear axle [m]: x forward of the origin, z above the ground.
    wheelbase : float, optional
        Distance from the rear axle to the front axle [m].
    front_overhang, rear_overhang : float, optional
        From the front axle to the foremost point; from the rear axle to the rearmost point [m].

    Raises
    ------
    InputError
        When a value is not a number, or out of its range.
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
    rear, front = by_x[0], by_x[-1]
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


UP = 2


def vehicle_line(vehicle: Vehicle, faces: str = "") -> str:
    """Return "4.70 x 1.85 x 1.45 m, faces +x, 15,498 triangles, 22 parts".

    Parameters
    ----------
    vehicle : Vehicle
    faces : str
        Text on how the axes of its file were interpreted. Without it, the line has the direction
        that follows from the names of the parts, or the axis along which the vehicle is long.
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
    return ", ".join(text for text in texts if text)
