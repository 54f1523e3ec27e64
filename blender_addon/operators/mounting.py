"""Where a new sensor is put and what it looks like in the scene, by kind."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Vector

from .. import bridge
from ..engine import pe
from ..properties import DEFAULT_MODEL
from .surface import nearest_spot, parts_of

ROOF_DEPTH_M = 0.1
"""What lies this near to the vehicle's highest point is its roof."""
FRONT_INSET_M = 0.05
"""How far behind the roof's front edge a camera stands."""
DOWN = (0.0, 0.0, -1.0)
GAP_DEG = 30.0
"""A LiDAR whose horizontal field of view leaves out no more than this measures all around."""


@dataclass(frozen=True, slots=True)
class Mount:
    """How sensors of one kind are added.

    `usual` is the model of the kind's button, None for the first of the catalogue. Its origin is
    `stand_off_m` from the surface that it stands on: clear of the body. On a roof it stands at the
    front edge or over the middle; without a vehicle at `height_m`. `outward` says whether it looks
    away from the vehicle's centre. `display` and `size_m` are its empty's.
    """

    usual: str | None
    stand_off_m: float
    at_front: bool
    height_m: float
    outward: bool
    display: str
    size_m: float


MOUNTS = {
    "lidar": Mount(DEFAULT_MODEL, 0.15, False, 1.8, False, "SPHERE", 0.12),
    "camera": Mount("Camera 90 deg", 0.05, True, 1.5, True, "ARROWS", 0.25),
}
OTHER = Mount(None, 0.05, True, 1.5, True, "ARROWS", 0.25)
"""Of a kind that has no row."""


def mount_of(kind: str) -> Mount:
    """Return how sensors of a kind are added."""
    return MOUNTS.get(kind, OTHER)


def mount_for(model: object) -> Mount:
    """Return how sensors of a model are added.

    A LiDAR that does not measure all around looks away from the vehicle, as a camera does.
    """
    mount = mount_of(model.kind)
    narrow = isinstance(model, pe.Lidar) and not sees_all_around(model)
    return replace(mount, outward=True) if narrow else mount


def sees_all_around(lidar: pe.Lidar) -> bool:
    """Whether a LiDAR's field of view has no horizontal gap wider than GAP_DEG."""
    low, high = lidar.horizontal_fov
    return bool(high - low >= math.radians(360.0 - GAP_DEG))


def sensible_place(context: bpy.types.Context, mount: Mount) -> Vector:
    """Return the 3D cursor, or while that is at the origin a place on the vehicle's roof.

    A cursor in the vehicle's surface, or nearly, is where the sensor is to stand: its origin is
    put clear of it.
    """
    cursor = context.scene.cursor.location
    collection = context.scene.perception_entropy.vehicle
    if collection is None:
        return cursor.copy() if cursor.length > 0.0 else Vector((0.0, 0.0, mount.height_m))
    depsgraph = context.evaluated_depsgraph_get()
    if cursor.length > 0.0:
        return clear_of(cursor, mount.stand_off_m, parts_of(collection, depsgraph), depsgraph)
    return Vector(on_roof(bridge.vehicle_from_collection(collection, depsgraph), mount))


def clear_of(
    point: Vector, stand_off_m: float, parts: set[str], depsgraph: bpy.types.Depsgraph
) -> Vector:
    """Return a point, moved out of a surface that is nearer than a sensor's stand-off."""
    spot = nearest_spot(depsgraph, parts, point, stand_off_m)
    return point.copy() if spot is None else spot.point + spot.normal * stand_off_m


def on_roof(vehicle: pe.Vehicle, mount: Mount) -> tuple[float, float, float]:
    """Return a place on the middle of the roof, or behind its front edge."""
    corners = vehicle.triangles.reshape(-1, 3)
    top = corners[:, 2].max()
    roof = corners[corners[:, 2] > top - ROOF_DEPTH_M]
    low, high = roof.min(axis=0), roof.max(axis=0)
    x, y = (low[:2] + high[:2]) / 2.0
    if mount.at_front:
        x = max(x, high[0] - FRONT_INSET_M)
    depth = float(vehicle.first_hit((x, y, top + 1.0), [DOWN]).distance[0])
    surface = top + 1.0 - depth if np.isfinite(depth) else top  # there may be a hole
    x, y, z = np.round((x, y, surface + mount.stand_off_m), 2).tolist()
    return x, y, z
