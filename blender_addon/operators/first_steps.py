"""The first steps in an empty tab: choose the vehicle from what is selected, or open an example."""

from collections.abc import Sequence
from typing import Any

import bpy

from .. import document, library
from ..engine import pe
from .declared import Failed, OperatorResult, operator
from .surface_pose import is_part

VEHICLE = "Vehicle"  # Name of a new collection for the vehicle


@operator("Use Selected Objects", mode="The vehicle is chosen in Object Mode")
def use_selected(context: bpy.types.Context) -> str:
    """Choose the selected objects, with all objects parented to them, as the vehicle.

    They are moved into a new collection, unless a collection has them and no other mesh"""
    scene = context.scene
    parts = selected_parts(context.selected_objects)
    vehicle = common_collection(scene, parts) or new_vehicle(scene, parts)
    scene.perception_entropy.vehicle = vehicle
    return f"Vehicle: {vehicle.name}, objects: {len(parts)}"


def selected_parts(selected: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the selected objects that may be parts of a vehicle, and such objects below them.
    `InputError` when there is none."""
    family = [member for obj in selected for member in (obj, *obj.children_recursive)]
    parts = [obj for obj in dict.fromkeys(family) if may_be_part(obj)]
    if not parts:
        found = ", ".join(obj.name for obj in selected) or "nothing selected"
        raise pe.InputError("scene", "selection", "at least one mesh of the vehicle", found)
    return parts


def may_be_part(obj: bpy.types.Object) -> bool:
    """Whether an object is a mesh or an instance of a collection, and belongs to no sensor."""
    is_instance = obj.instance_collection is not None and not document.mounted_on_sensor(obj)
    return is_instance or is_part(obj)


def common_collection(
    scene: bpy.types.Scene, parts: Sequence[bpy.types.Object]
) -> bpy.types.Collection | None:
    """Return the scene's smallest collection that has all these parts and no other part."""
    wanted = set(parts)
    fitting = [
        each
        for each in scene.collection.children_recursive
        if {obj for obj in each.all_objects if may_be_part(obj)} == wanted
    ]
    return min(fitting, key=lambda each: len(each.all_objects), default=None)


def new_vehicle(scene: bpy.types.Scene, parts: Sequence[bpy.types.Object]) -> bpy.types.Collection:
    """Return a new collection of the scene with these objects, moved out of the scene's others."""
    vehicle = bpy.data.collections.new(VEHICLE)
    before = [scene.collection, *scene.collection.children_recursive]
    scene.collection.children.link(vehicle)
    for obj in parts:
        for each in before:
            if each.library is None and obj.name in each.objects:
                each.objects.unlink(obj)
        vehicle.objects.link(obj)
    return vehicle


def _ask_about_changes(self: Any, context: bpy.types.Context, event: Any) -> OperatorResult:
    """Ask where the open file has changes that are not saved."""
    if not bpy.data.is_dirty:
        return self.execute(context)
    message = "The open file has changes that are not saved; they are lost"
    manager = context.window_manager
    return manager.invoke_confirm(self, event, message=message, translate=False)


@operator("Open an Example", options=frozenset(), invoke=_ask_about_changes)
def open_example(_context: bpy.types.Context) -> OperatorResult:
    """Open the example: a sedan with a LiDAR on its roof, as a new file without a name"""
    example = library.example_file()
    if example is None:
        raise Failed("The example is not in this installation of the extension")
    # As a start-up file it has no name: Save never writes into the extension's folder.
    return bpy.ops.wm.read_homefile(filepath=str(example), load_ui=False)
