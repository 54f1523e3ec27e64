"""What there is to see of a scene's search: faces of mounts, boxes of bounds and no-go areas."""

from __future__ import annotations

from collections.abc import Hashable
from typing import NamedTuple

import bpy
import numpy as np

from ..choices import BY_GROUP, BY_MATERIAL, BY_PARTS, ON_SURFACE
from ..engine import pe, search
from .advanced import limits_of
from .areas import painted_area
from .holds import constrained, free_axes
from .mounting import no_go_of, part_names


class LimitBox(NamedTuple):
    """A box along the axes of the ground frame [m], and whether nobody may be in it."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    forbidden: bool


def mount_key(row: bpy.types.PropertyGroup) -> Hashable:
    """Return what the faces of a mount depend on, besides the vehicle; None for one without."""
    if row.kind != ON_SURFACE:
        return None
    said: dict[str, Hashable] = {
        BY_PARTS: tuple(part_names(row)),
        BY_MATERIAL: row.material.name_full if row.material else None,
        BY_GROUP: row.group,
    }
    return row.faces, said[row.faces]


def mount_faces(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    row: bpy.types.PropertyGroup,
    vehicle: pe.Vehicle,
) -> np.ndarray:
    """Return the faces (F, 3, 3) of a mount that is a surface [m]; none where it has none."""
    if row.faces == BY_PARTS:
        wanted = [n for n, name in enumerate(vehicle.part_names) if name in part_names(row)]
        return vehicle.triangles[np.isin(vehicle.parts, wanted)]
    return painted_area(scene.perception_entropy.vehicle, depsgraph, row)


def bounds_box(
    obj: bpy.types.Object,
    sensor: pe.Sensor,
    vehicle: pe.Vehicle | None,
    around: np.ndarray | None = None,
) -> LimitBox | None:
    """Return the box of a sensor's own bounds and constraints; None for one without any.

    What the search does not change is where it is. What has no bounds is as usual; of a sensor on
    a surface, as far as the faces (F, 3, 3) `around` it and itself go.
    """
    limits = constrained(obj, sensor, vehicle, limits_of(obj))
    if not set("xyz") & set(limits):
        return None
    usual, free = search.default_bounds(sensor, vehicle), free_axes(obj)
    ends = []
    for number, axis in enumerate("xyz"):
        place = sensor.pose.position[number]
        still = (place, place) if axis not in free else usual[axis]
        if around is not None:
            side = around[:, :, number]
            still = (min(float(side.min()), place), max(float(side.max()), place))
        ends.append(limits.get(axis, still) if around is not None or axis in free else still)
    return LimitBox(*zip(*ends, strict=True), False)


def no_go_boxes(scene: bpy.types.Scene) -> tuple[LimitBox, ...]:
    """Return the no-go areas of a scene."""
    sides = ((area.x, area.y, area.z) for area in no_go_of(scene))
    return tuple(LimitBox(*zip(*each, strict=True), True) for each in sides)
