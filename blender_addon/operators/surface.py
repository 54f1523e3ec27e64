"""The vehicle's surface in the scene: what a ray meets, and what a point is near to."""

from __future__ import annotations

from typing import NamedTuple

import bpy
from mathutils import Vector

from .. import bridge

STEP_M = 1e-3
"""How far behind a surface that is not the vehicle's a ray goes on."""
MOST_STEPS = 64


class Spot(NamedTuple):
    """A point of the surface [m], its unit normal on the side that was looked at, whose it is."""

    point: Vector
    normal: Vector
    part: str


def parts_of(
    collection: bpy.types.Collection | None, depsgraph: bpy.types.Depsgraph
) -> set[str] | None:
    """Names of the objects that a sensor may stand on; None, without a vehicle: all of them."""
    if collection is None:
        return None
    members = bridge.visible_members(collection, depsgraph.view_layer)
    return {each.name_full for each in members if not bridge.mounted_on_sensor(each)}


def spot_on_ray(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    parts: set[str] | None,
    origin: Vector,
    direction: Vector,
) -> Spot | None:
    """Return where a ray first meets one of the parts; what else is in its way does not count."""
    start = origin.copy()
    for _ in range(MOST_STEPS):
        hit, point, normal, _, obj, _ = scene.ray_cast(depsgraph, start, direction)
        if not hit:
            return None
        if parts is None or obj.original.name_full in parts:
            facing = normal.normalized()
            return Spot(point, facing if facing.dot(direction) <= 0.0 else -facing, obj.name)
        start = point + direction * STEP_M
    return None


def nearest_spot(
    depsgraph: bpy.types.Depsgraph, parts: set[str], point: Vector, within_m: float
) -> Spot | None:
    """Return the nearest place of the parts' surface, if there is one within a distance."""
    best, least = None, within_m
    for name in sorted(parts):
        obj = bpy.data.objects[name].evaluated_get(depsgraph)
        if obj.type != "MESH" or not len(obj.data.polygons):
            continue
        ground_from_local = obj.matrix_world
        local = ground_from_local.inverted_safe() @ point
        found, at, normal, _ = obj.closest_point_on_mesh(local)
        distance = (ground_from_local @ at - point).length if found else least
        if distance < least:
            turned = ground_from_local.to_3x3().inverted_safe().transposed() @ normal
            best, least = Spot(ground_from_local @ at, turned.normalized(), name), distance
    return best
