"""Sensors that are upright and look away from the vehicle: by a button, or dropped as assets.

Blender turns an asset that is dropped onto a surface so that its z axis is the surface's normal: a
camera on a tailgate would look along the tailgate. A dropped sensor is turned as *Place* does it,
by the next timer; undo of the drop takes both back.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from bpy.props import StringProperty
from mathutils import Matrix, Vector

from .. import bridge, sensor_cache
from ..engine import catalog, pe
from ..sensor_kinds import mount_for
from .declared import operator
from .surface_pose import Stance, SurfaceSpot, outward_yaw, vehicle_center

NO_HEADING = 0.05
"""A direction with less than this along the ground, of 1, looks straight up or down."""


@operator(
    "Stand Upright, Look Outward",
    mode="Sensors are turned in Object Mode",
    name=StringProperty(name="Name", description="Name of the sensor; the selected ones if empty"),
)
def stand_upright(context: bpy.types.Context, name: str) -> str:
    """Turn the selected sensors upright; cameras look away from the vehicle.

    So do LiDARs with a limited horizontal field of view; others keep their yaw"""
    scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
    middle = vehicle_center(scene.perception_entropy.vehicle)
    named = [*context.selected_objects, context.active_object]
    objects = dict.fromkeys([scene.objects.get(name)] if name else named)
    sensors = [obj for obj in objects if obj is not None and obj.perception_entropy.is_sensor]
    if not sensors:
        raise pe.InputError("scene", "selection", "at least one sensor", name or "none")
    poses = {obj.name: upright_pose(obj, depsgraph, middle) for obj in sensors}
    bridge.place_poses(scene, poses)
    return f"Upright: {', '.join(poses)}"


def upright_pose(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, middle: Vector) -> pe.Pose:
    """Return a sensor's pose with its z axis up, on a vehicle with that middle.

    `InputError` when it is no valid sensor.
    """
    sensor = bridge.sensor_from_object(obj, depsgraph)
    position, ahead = sensor.pose.position, sensor.pose.ground_from_sensor[:, 0]
    if mount_for(sensor.model).outward:
        yaw = outward_yaw(Vector(position), middle)
    elif math.hypot(ahead[0], ahead[1]) > NO_HEADING:
        yaw = math.atan2(ahead[1], ahead[0])
    else:
        yaw = 0.0  # it looks straight up or down: it has no yaw to keep
    return pe.Pose(position, (0.0, 0.0, yaw))


def on_moving() -> None:
    """Place dropped sensors, where there is a window: a script places what it appends itself."""
    if not bpy.app.background:
        place_dropped()


def place_dropped() -> None:
    """Turn sensors that were just dropped from the asset browser as *Place* does."""
    scene = bpy.context.scene
    dropped = [obj for obj in sensor_cache.sensors(scene) if is_dropped(obj)]
    if dropped:
        bpy.context.view_layer.update()  # Blender has noted where they are, not worked it out
        middle = vehicle_center(scene.perception_entropy.vehicle)
    for obj in dropped:
        obj.perception_entropy.stands_when_dropped = False
        place_on_surface(obj, middle)


def is_dropped(obj: bpy.types.Object) -> bool:
    """Whether a sensor was dropped from the asset browser and is not turned yet.

    Blender removes the mark of an asset from what is dropped, not from what is appended otherwise.
    """
    is_local = obj.library is None and obj.asset_data is None
    return is_local and obj.perception_entropy.stands_when_dropped


def place_on_surface(obj: bpy.types.Object, middle: Vector) -> None:
    """Put a sensor upright on the surface that the base of its body was dropped on.

    Blender puts the base of its bounding box there. Its body just touches the surface; a sensor
    without a body has the stand-off of its kind.
    """
    try:
        mount = mount_for(catalog.load(obj.perception_entropy.model))
    except pe.InputError:  # the model is not in this catalogue: its view is unknown
        return
    low, high = np.min(obj.bound_box, axis=0), np.max(obj.bound_box, axis=0)
    base = Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]))
    local = obj.matrix_world
    spot = SurfaceSpot(local @ base, local.col[2].to_3d().normalized(), "")
    stand_off = mount.stand_off_m
    if obj.data is not None:
        turned = Stance(0.0).placed(spot, mount, middle).to_3x3()
        corners = map(Vector, obj.bound_box)
        stand_off = max(0.0, *(-spot.normal.dot(turned @ corner) for corner in corners))
    placed = Stance(stand_off).placed(spot, mount, middle)
    obj.matrix_world = placed @ Matrix.Diagonal((*obj.scale, 1.0))
