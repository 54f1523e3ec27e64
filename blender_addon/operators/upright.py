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
from ..language import shown
from ..sensor_kinds import Mount, mount_for
from .placement import vehicle_center
from .reports import USER_ERRORS, OperatorResult, report, report_error
from .surface_pose import NO_HEADING_M, Stance, SurfaceSpot, outward_yaw


class PE_OT_stand_upright(bpy.types.Operator):
    """Turn the selected sensors upright; cameras look away from the vehicle.

    So do LiDARs with a limited horizontal field of view; others keep their yaw"""

    bl_idname = "pe.stand_upright"
    bl_label = "Stand Upright, Look Outward"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the selected ones if empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Sensors are turned in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        middle = vehicle_center(scene.perception_entropy.vehicle)
        try:
            sensors = self._chosen(context)
            poses = {obj.name: upright_pose(obj, depsgraph, middle) for obj in sensors}
            bridge.place_poses(scene, poses)
        except USER_ERRORS as error:
            return report_error(self, error)
        report(self, "INFO", f"Upright: {', '.join(poses)}")
        return {"FINISHED"}

    def _chosen(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        named = context.scene.objects.get(self.name)
        objects = [named] if self.name else [*context.selected_objects, context.active_object]
        sensors = [obj for obj in objects if obj is not None and obj.perception_entropy.is_sensor]
        if not sensors:
            raise pe.InputError("scene", "selection", "at least one sensor", self.name or "none")
        return list(dict.fromkeys(sensors))


def upright_pose(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, middle: Vector) -> pe.Pose:
    """Return a sensor's pose with its z axis up, on a vehicle with that middle.

    Raises
    ------
    InputError
        When it is no valid sensor.
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
    """Put a sensor upright on the surface that the base of its body was dropped on."""
    try:
        mount = mount_for(catalog.load(obj.perception_entropy.model))
    except pe.InputError:  # the model is not in this catalogue: its view is unknown
        return
    spot = spot_below(obj)
    upright = Stance(0.0).placed(spot, mount, middle)
    stand_off = clearance(obj, upright, spot.normal, mount)
    placed = Stance(stand_off).placed(spot, mount, middle)
    obj.matrix_world = placed @ Matrix.Diagonal((*obj.scale, 1.0))


def spot_below(obj: bpy.types.Object) -> SurfaceSpot:
    """Return the spot of a dropped object: Blender puts the base of its bounding box there."""
    low, high = np.min(obj.bound_box, axis=0), np.max(obj.bound_box, axis=0)
    base = Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]))
    ground_from_local = obj.matrix_world
    return SurfaceSpot(ground_from_local @ base, ground_from_local.col[2].to_3d().normalized(), "")


def clearance(
    obj: bpy.types.Object, ground_from_sensor: Matrix, normal: Vector, mount: Mount
) -> float:
    """Return how far a sensor's origin is from the surface so that its body just touches it [m].

    A sensor without a body has the stand-off of its kind.
    """
    if obj.data is None:
        return mount.stand_off_m
    turned = ground_from_sensor.to_3x3()
    return max(0.0, *(-normal.dot(turned @ Vector(corner)) for corner in obj.bound_box))


def on_moving() -> None:
    """Place dropped sensors, where there is a window: a script places what it appends itself."""
    if not bpy.app.background:
        place_dropped()


CLASSES = (PE_OT_stand_upright,)
