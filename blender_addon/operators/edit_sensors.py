"""Operators on sensors that exist: select, show or hide, mirror, apply the scale."""

import bpy
from bpy.props import BoolProperty, StringProperty
from mathutils import Matrix

from .. import document, signals
from ..caches import vehicle_cache
from ..engine import advice, pe
from .add_sensor import select_only
from .declared import INTERNAL, Refused, Report, chosen_sensor, operator

NAME = StringProperty(name="Name", description="Name of the sensor; the active one when empty")


@operator(
    "Select Object",
    mode="Objects are selected in Object Mode",
    options=INTERNAL | {"UNDO"},
    name=StringProperty(name="Name", description="Name of the sensor, part or test body"),
)
def select_object(context: bpy.types.Context, name: str) -> None:
    """Select this object and show its settings"""
    # The name of a linked part includes its file; the view layer's objects have no such key.
    matches = (o for o in context.view_layer.objects if name in (o.name_full, o.name))
    obj = next(matches, None)
    if obj is None or not obj.visible_get():
        raise Refused(f"{name} is hidden, or was removed")
    select_only(context, obj)


@operator(
    "Show or Hide Sensor",
    signal=signals.study_changed,
    options=INTERNAL | {"UNDO"},
    name=StringProperty(name="Name", description="Name of the sensor's object"),
)
def toggle_sensor(context: bpy.types.Context, name: str) -> Report | None:
    """Show or hide this sensor, like the Outliner's eye. A hidden sensor is not scored"""
    obj = context.scene.objects.get(name)
    if obj is None or obj.name not in context.view_layer.objects:
        raise Refused(f"{name} is in a collection that is excluded from the view layer")
    hide = obj.visible_get()
    if not hide:
        obj.hide_viewport = False
    obj.hide_set(hide)
    if hide != obj.visible_get():
        return None
    return Report(f"{name} is hidden by its collection, or by local view", level="WARNING")


@operator(
    "Mirror",
    mode="Sensors are mirrored in Object Mode",
    name=NAME,
    linked=BoolProperty(
        name="Linked", description="The two stay mirror images: a move of one moves the other"
    ),
)
def mirror_sensor(context: bpy.types.Context, name: str, linked: bool) -> None:
    """Add a mirrored copy of this sensor on the other side of the vehicle"""
    obj = chosen_sensor(context, name)
    made = mirrored_copy(context, obj)
    if linked:
        document.unlink_mirror(obj)
        document.link_mirror(obj, made)
    select_only(context, made)


@operator("Unlink", name=NAME)
def unlink_mirror(context: bpy.types.Context, name: str) -> None:
    """Remove the link between this sensor and its mirror image"""
    obj = context.scene.objects.get(name) if name else context.active_object
    if obj is None or not obj.perception_entropy.mirror_of:
        raise Refused("This sensor is not linked")
    document.unlink_mirror(obj)


def mirrored_copy(context: bpy.types.Context, obj: bpy.types.Object) -> bpy.types.Object:
    """Return a copy of a sensor on the other side. `InputError` when it is its own mirror image, or
    when its image is not on the vehicle."""
    depsgraph = context.evaluated_depsgraph_get()
    sensor = document.sensor_from_object(obj, depsgraph)
    pose = sensor.pose
    image = document.mirrored_pose(sensor.pose)
    if document.in_the_middle(pose):
        expected = "a sensor beside the vehicle's middle plane"
        raise pe.InputError("scene", f"sensor {obj.name!r}", expected, "its own mirror image")
    vehicle = vehicle_cache.shared.read(context.scene, depsgraph).vehicle
    if vehicle is not None:
        advice.check_mirror_image(vehicle, sensor, image)
    made = obj.copy()
    made.name = document.mirrored_name(obj.name, "right" if pose.position[1] > 0.0 else "left")
    made.perception_entropy.mirror_of = ""
    for collection in obj.users_collection:
        collection.objects.link(made)
    document.place_poses(context.scene, {made.name: image})
    return made


def rigid(matrix: Matrix) -> Matrix:
    """Return a pose (4, 4) without scale: same position and x axis, z as close as possible."""
    ahead = matrix.col[0].to_3d().normalized()
    up = matrix.col[2].to_3d()
    left = up.cross(ahead).normalized()
    turned = Matrix((ahead, left, ahead.cross(left))).transposed()
    return Matrix.Translation(matrix.to_translation()) @ turned.to_4x4()
