"""A vehicle in one line: its size, which way it faces, its triangles and parts."""

from __future__ import annotations

from ..scene.body_shape import BodyShape
from ..scene.facing import along, front_by_names
from ..scene.vehicle import Vehicle
from ..scene.vehicle_size import size_words
from .figures import plural

UP = 2


def vehicle_line(vehicle: Vehicle, faces: str = "") -> str:
    """Return "4.70 x 1.85 x 1.45 m, faces +x, 15,498 triangles, 22 parts".

    Parameters
    ----------
    vehicle : Vehicle
    faces : str
        How its file's axes were taken, in words. Without them it is told which way the vehicle
        faces by the names of its parts, or along which axis it lies.
    """
    low, high = vehicle.bounds
    size = size_words(tuple((high - low).tolist()))
    triangles = plural(len(vehicle.triangles), "triangle")
    parts = plural(len(vehicle.part_names), "part")
    told = (size, faces or _facing(vehicle), triangles, parts)
    return ", ".join(text for text in told if text)


def _facing(vehicle: Vehicle) -> str:
    shape = BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))
    ahead = front_by_names(shape)
    if ahead is not None and ahead[0] != UP:
        return f"faces {'+' if ahead[1] > 0 else '-'}{'xyz'[ahead[0]]}"
    axis = along(shape, UP)
    return "" if axis is None else f"lies along {'xyz'[axis]}"
