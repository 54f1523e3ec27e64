"""The first steps in an empty tab: choose the vehicle from what is selected, or open an example."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.props import EnumProperty

from .. import bridge, library
from ..engine import pe
from ..language import draw_label, shown
from .add_sensor import is_part
from .reports import USER_ERRORS, OperatorResult, report, report_error

VEHICLE = "Vehicle"
"""Name of a new collection for the vehicle."""


class PE_OT_use_selected(bpy.types.Operator):
    """Choose the selected objects, with all objects parented to them, as the vehicle.

    They are moved into a new collection, unless a collection has them and no other mesh"""

    bl_idname = "pe.use_selected"
    bl_label = "Use Selected Objects"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("The vehicle is chosen in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        try:
            parts = selected_parts(context.selected_objects)
        except USER_ERRORS as error:
            return report_error(self, error)
        vehicle = common_collection(scene, parts) or new_vehicle(scene, parts)
        scene.perception_entropy.vehicle = vehicle
        report(self, "INFO", f"Vehicle: {vehicle.name}, objects: {len(parts)}")
        return {"FINISHED"}


def selected_parts(selected: Sequence[bpy.types.Object]) -> list[bpy.types.Object]:
    """Return the selected objects that may be parts of a vehicle, and such objects below them.

    Raises
    ------
    InputError
        When there is none.
    """
    family = [member for obj in selected for member in (obj, *obj.children_recursive)]
    parts = [obj for obj in dict.fromkeys(family) if may_be_part(obj)]
    if not parts:
        found = ", ".join(obj.name for obj in selected) or "nothing selected"
        raise pe.InputError("scene", "selection", "at least one mesh of the vehicle", found)
    return parts


def may_be_part(obj: bpy.types.Object) -> bool:
    """Whether an object is a mesh or an instance of a collection, and belongs to no sensor."""
    is_instance = obj.instance_collection is not None and not bridge.mounted_on_sensor(obj)
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


class PE_OT_open_example(bpy.types.Operator):
    """Open the example: a sedan with a LiDAR on its roof, as a new file without a name"""

    bl_idname = "pe.open_example"
    bl_label = "Open an Example"

    changes: EnumProperty(
        name="Changes",
        description="What happens to changes of the open file that are not saved",
        items=(
            ("SAVE", "Save", "Save the open file, then open the example"),
            ("DISCARD", "Don't Save", "Open the example; the changes are lost"),
        ),
        default="DISCARD",
        options={"SKIP_SAVE"},
    )

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        if not bpy.data.is_dirty:
            return self.execute(context)
        self.changes = "SAVE"
        title = shown("Save Changes Before Opening?")
        return context.window_manager.invoke_props_dialog(
            self, title=title, confirm_text=shown("Open"), translate=False
        )

    def draw(self, _context: bpy.types.Context) -> None:
        draw_label(self.layout, "The open file has changes that are not saved", "INFO")
        self.layout.row().prop(self, "changes", expand=True)

    def execute(self, _context: bpy.types.Context) -> OperatorResult:
        example = library.example_file()
        if example is None:
            report(self, "ERROR", "The example is not in this installation of the extension")
            return {"CANCELLED"}
        if self.changes == "SAVE" and bpy.data.is_dirty:
            if not bpy.data.filepath:
                report(self, "WARNING", "Save this file under a name, then open the example again")
                bpy.ops.wm.save_as_mainfile("INVOKE_DEFAULT")
                return {"CANCELLED"}
            try:
                bpy.ops.wm.save_mainfile()
            except RuntimeError as error:  # a path that cannot be written: Blender's own line
                report(self, "ERROR", str(error).strip().removeprefix("Error: "))
                return {"CANCELLED"}
        # As a start-up file it has no name: Save never writes into the extension's folder.
        return bpy.ops.wm.read_homefile(filepath=str(example), load_ui=False)


CLASSES = (PE_OT_use_selected, PE_OT_open_example)
