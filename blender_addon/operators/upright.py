"""Sensors that stand upright and look away from the vehicle: by a button, or dropped as assets.

Blender turns an asset that is dropped onto a surface so that its z axis is the surface's normal: a
camera on a tailgate would look along the tailgate. A dropped sensor is put as *Place* puts one, in
Blender's next turn; undo of the drop takes both back.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from bpy.props import StringProperty
from mathutils import Matrix, Vector

from .. import bridge, changes, roster
from ..engine import catalog, pe
from .mounting import Mount, mount_for
from .placing import middle_of
from .pointing import UPRIGHT_M, Stance, outward
from .reports import REFUSALS, refuse, tell
from .surface import Spot


class PE_OT_stand_upright(bpy.types.Operator):
    """Turn the selected sensors upright where they are: cameras look away from the vehicle.

    So do LiDARs with a limited horizontal field of view; others keep their heading"""

    bl_idname = "pe.stand_upright"
    bl_label = "Stand Upright, Look Outward"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the selected ones if empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are turned in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        middle = middle_of(scene.perception_entropy.vehicle)
        try:
            chosen = self._chosen(context)
            poses = {obj.name: upright_pose(obj, depsgraph, middle) for obj in chosen}
            bridge.place_poses(scene, poses)
        except REFUSALS as error:
            return refuse(self, error)
        tell(self, "INFO", f"Upright: {', '.join(poses)}")
        return {"FINISHED"}

    def _chosen(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        named = context.scene.objects.get(self.name)
        objects = [named] if self.name else [*context.selected_objects, context.active_object]
        found = [obj for obj in objects if obj is not None and obj.perception_entropy.is_sensor]
        if not found:
            raise pe.InputError("scene", "selection", "at least one sensor", self.name or "none")
        return list(dict.fromkeys(found))


def upright_pose(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, middle: Vector) -> pe.Pose:
    """Return a sensor's pose with its z axis up, on a vehicle with that middle.

    Raises
    ------
    InputError
        When it is no possible sensor.
    """
    sensor = bridge.sensor_from_object(obj, depsgraph)
    position, ahead = sensor.pose.position, sensor.pose.ground_from_sensor[:, 0]
    if mount_for(sensor.model).outward:
        yaw = outward(Vector(position), middle)
    elif math.hypot(ahead[0], ahead[1]) > UPRIGHT_M:
        yaw = math.atan2(ahead[1], ahead[0])
    else:
        yaw = 0.0  # it looks straight up or down: it has no heading to keep
    return pe.Pose(position, (0.0, 0.0, yaw))


def stand_dropped() -> None:
    """Put sensors that have just been dropped from the asset browser as *Place* puts them."""
    scene = bpy.context.scene
    dropped = [obj for obj in roster.sensors(scene) if is_dropped(obj)]
    if dropped:
        bpy.context.view_layer.update()  # Blender has noted where they are, not worked it out
        middle = middle_of(scene.perception_entropy.vehicle)
    for obj in dropped:
        obj.perception_entropy.stands_when_dropped = False
        stand_on_surface(obj, middle)


def is_dropped(obj: bpy.types.Object) -> bool:
    """Whether a sensor came from the asset browser and does not stand yet.

    Blender takes the mark of an asset from what is dropped; on what is appended otherwise it stays.
    """
    own = obj.library is None and obj.asset_data is None
    return own and obj.perception_entropy.stands_when_dropped


def stand_on_surface(obj: bpy.types.Object, middle: Vector) -> None:
    """Put a sensor upright on the surface that the base of its body was dropped on."""
    try:
        mount = mount_for(catalog.load(obj.perception_entropy.model))
    except pe.InputError:  # a model of another catalogue: where it looks is not known
        return
    spot = spot_below(obj)
    upright = Stance(0.0).placed(spot, mount, middle)
    stand_off = clearance(obj, upright, spot.normal, mount)
    placed = Stance(stand_off).placed(spot, mount, middle)
    obj.matrix_world = placed @ Matrix.Diagonal((*obj.scale, 1.0))


def spot_below(obj: bpy.types.Object) -> Spot:
    """Return where a dropped object stands: Blender puts the base of its bounding box there."""
    low, high = np.min(obj.bound_box, axis=0), np.max(obj.bound_box, axis=0)
    base = Vector(((low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, low[2]))
    ground_from_local = obj.matrix_world
    return Spot(ground_from_local @ base, ground_from_local.col[2].to_3d().normalized(), "")


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


def register() -> None:
    """Have dropped sensors stand."""
    if not bpy.app.background:  # a script puts what it appends itself
        changes.moved.connect(stand_dropped)


def unregister() -> None:
    """Leave them as they are dropped."""
    changes.moved.disconnect(stand_dropped)


CLASSES = (PE_OT_stand_upright,)
