"""Sensors that exist, turned upright; those that look outward look away from the vehicle."""

from __future__ import annotations

import math

import bpy
from bpy.props import StringProperty
from mathutils import Vector

from .. import bridge
from ..engine import pe
from ..sensor_kinds import mount_for
from .declared import operator
from .surface_pose import NO_HEADING_M, outward_yaw, vehicle_center


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
    elif math.hypot(ahead[0], ahead[1]) > NO_HEADING_M:
        yaw = math.atan2(ahead[1], ahead[0])
    else:
        yaw = 0.0  # it looks straight up or down: it has no yaw to keep
    return pe.Pose(position, (0.0, 0.0, yaw))
