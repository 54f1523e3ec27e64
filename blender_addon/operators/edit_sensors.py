"""Operators on sensors that exist: select, show or hide, mirror, apply the scale."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, StringProperty
from mathutils import Matrix

from .. import bridge, sensor_cache, signals, vehicle_cache
from ..engine import advice, pe
from ..language import shown
from .add_sensor import select_only
from .reports import USER_ERRORS, OperatorResult, chosen_sensor, report, report_error


def listed_sensors(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return all sensors of a scene by name, for a list of them."""
    return sensor_cache.sensors(scene)


class PE_OT_select_sensor(bpy.types.Operator):
    """Select this sensor and show its settings"""

    bl_idname = "pe.select_sensor"
    bl_label = "Select Sensor"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor's object")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        obj = context.view_layer.objects.get(self.name)
        if obj is None or not obj.visible_get():
            report(self, "WARNING", f"{self.name} is hidden")
            return {"CANCELLED"}
        select_only(context, obj)
        return {"FINISHED"}


class PE_OT_select_part(bpy.types.Operator):
    """Select this part of the vehicle"""

    bl_idname = "pe.select_part"
    bl_label = "Select Part"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the part's object")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        # The name of a linked part includes its file; the view layer's objects have no such key.
        matches = (o for o in context.view_layer.objects if self.name in (o.name_full, o.name))
        obj = next(matches, None)
        if obj is None or not obj.visible_get():
            report(self, "WARNING", f"{self.name} is hidden, or was removed")
            return {"CANCELLED"}
        select_only(context, obj)
        return {"FINISHED"}


class PE_OT_toggle_sensor(bpy.types.Operator):
    """Show or hide this sensor, like the Outliner's eye. A hidden sensor is not scored"""

    bl_idname = "pe.toggle_sensor"
    bl_label = "Show or Hide Sensor"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor's object")

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        obj = context.scene.objects.get(self.name)
        if obj is None or obj.name not in context.view_layer.objects:
            report(
                self,
                "WARNING",
                f"{self.name} is in a collection that is excluded from the view layer",
            )
            return {"CANCELLED"}
        hide = obj.visible_get()
        if not hide:
            obj.hide_viewport = False
        obj.hide_set(hide)
        signals.study_changed.emit()
        if hide == obj.visible_get():
            report(self, "WARNING", f"{self.name} is hidden by its collection, or by local view")
        return {"FINISHED"}


class PE_OT_mirror_sensor(bpy.types.Operator):
    """Add a mirrored copy of this sensor on the other side of the vehicle"""

    bl_idname = "pe.mirror_sensor"
    bl_label = "Mirror"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")
    linked: BoolProperty(
        name="Linked", description="The two stay mirror images: a move of one moves the other"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Sensors are mirrored in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            obj = chosen_sensor(context, self.name)
            made = mirrored_copy(context, obj)
        except USER_ERRORS as error:
            return report_error(self, error)
        if self.linked:
            bridge.unlink_mirror(obj)
            bridge.link_mirror(obj, made)
        select_only(context, made)
        return {"FINISHED"}


class PE_OT_unlink_mirror(bpy.types.Operator):
    """Remove the link between this sensor and its mirror image"""

    bl_idname = "pe.unlink_mirror"
    bl_label = "Unlink"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        obj = context.scene.objects.get(self.name) if self.name else context.active_object
        if obj is None or not obj.perception_entropy.mirror_of:
            report(self, "WARNING", "This sensor is not linked")
            return {"CANCELLED"}
        bridge.unlink_mirror(obj)
        return {"FINISHED"}


def mirrored_copy(context: bpy.types.Context, obj: bpy.types.Object) -> bpy.types.Object:
    """Return a copy of a sensor on the other side.

    Raises
    ------
    InputError
        When it is its own mirror image, or when its image is not on the vehicle.
    """
    depsgraph = context.evaluated_depsgraph_get()
    sensor = bridge.sensor_from_object(obj, depsgraph)
    pose, image = sensor.pose, bridge.mirrored_pose(sensor.pose)
    if bridge.in_the_middle(pose):
        expected = "a sensor beside the vehicle's middle plane"
        raise pe.InputError("scene", f"sensor {obj.name!r}", expected, "its own mirror image")
    vehicle = vehicle_cache.shared.read(context.scene, depsgraph).vehicle
    if vehicle is not None:
        advice.check_mirror_image(vehicle, sensor, image)
    made = obj.copy()
    made.name = bridge.mirrored_name(obj.name, "right" if pose.position[1] > 0.0 else "left")
    made.perception_entropy.has_result, made.perception_entropy.mirror_of = False, ""
    for collection in obj.users_collection:
        collection.objects.link(made)
    bridge.place_poses(context.scene, {made.name: image})
    return made


class PE_OT_apply_scale(bpy.types.Operator):
    """Remove scale and mirroring from this sensor; its position and direction do not change"""

    bl_idname = "pe.apply_scale"
    bl_label = "Apply Scale"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT"

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        obj = context.scene.objects.get(self.name) if self.name else context.active_object
        if obj is None or not obj.perception_entropy.is_sensor:
            report(self, "WARNING", "No sensor is selected")
            return {"CANCELLED"}
        obj.matrix_world = rigid(obj.matrix_world)
        context.view_layer.update()
        return {"FINISHED"}


def rigid(matrix: Matrix) -> Matrix:
    """Return a pose (4, 4) without scale: same position and x axis, z as close as possible."""
    ahead = matrix.col[0].to_3d().normalized()
    up = matrix.col[2].to_3d()
    left = up.cross(ahead).normalized()
    turned = Matrix((ahead, left, ahead.cross(left))).transposed()
    return Matrix.Translation(matrix.to_translation()) @ turned.to_4x4()


CLASSES = (
    PE_OT_select_sensor,
    PE_OT_select_part,
    PE_OT_toggle_sensor,
    PE_OT_mirror_sensor,
    PE_OT_unlink_mirror,
    PE_OT_apply_scale,
)
