"""Mirror a sensor to the vehicle's other side, as a copy of its own or linked to stay alike."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import bridge
from ..engine import pe
from .add_sensor import select_only
from .reports import REFUSALS, refuse, tell


class PE_OT_mirror_sensor(bpy.types.Operator):
    """Put a copy of this sensor onto the vehicle's other side, across its middle plane"""

    bl_idname = "pe.mirror_sensor"
    bl_label = "Mirror"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")
    linked: BoolProperty(
        name="Linked", description="Stay mirror images: when one of the two is moved, both are"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Sensors are mirrored in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.scene.objects.get(self.name) if self.name else context.active_object
        try:
            made = mirrored_copy(context, obj)
        except REFUSALS as error:
            return refuse(self, error)
        if self.linked:
            bridge.unlink_mirror(obj)
            bridge.link_mirror(obj, made)
        select_only(context, made)
        return {"FINISHED"}


class PE_OT_unlink_mirror(bpy.types.Operator):
    """Let this sensor and its mirror image go their own ways from here"""

    bl_idname = "pe.unlink_mirror"
    bl_label = "Unlink"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.scene.objects.get(self.name) if self.name else context.active_object
        if obj is None or not obj.perception_entropy.mirror_of:
            tell(self, "WARNING", "This sensor is not linked")
            return {"CANCELLED"}
        bridge.unlink_mirror(obj)
        return {"FINISHED"}


def mirrored_copy(context: bpy.types.Context, obj: bpy.types.Object | None) -> bpy.types.Object:
    """Return a copy of a sensor on the other side.

    Raises
    ------
    InputError
        When it is no possible sensor, or its own mirror image.
    """
    if obj is None or not obj.perception_entropy.is_sensor:
        raise pe.InputError("scene", "active object", "a sensor", obj.name if obj else "none")
    pose = bridge.pose_of(obj, context.evaluated_depsgraph_get())
    if bridge.in_the_middle(pose):
        expected = "a sensor beside the vehicle's middle plane"
        raise pe.InputError("scene", f"sensor {obj.name!r}", expected, "its own mirror image")
    made = obj.copy()
    made.name = bridge.mirrored_name(obj.name)
    made.perception_entropy.has_result, made.perception_entropy.mirror_of = False, ""
    for collection in obj.users_collection:
        collection.objects.link(made)
    bridge.place_poses(context.scene, {made.name: bridge.mirrored_pose(pose)})
    return made


CLASSES = (PE_OT_mirror_sensor, PE_OT_unlink_mirror)
