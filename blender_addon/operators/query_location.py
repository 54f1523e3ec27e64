"""Query a location: click the ground or any surface to see which sensors see it, and why not."""

from __future__ import annotations

import bpy
from bpy.props import FloatVectorProperty
from mathutils import Vector

from .. import bridge, location_query
from ..language import shown
from .reports import OperatorResult, report
from .surface_pose import ViewUnderMouse, ray_of, view_under

OFF_SURFACE_M = 0.05
"""How far outside a surface the query is: half a voxel, as the inside does not count."""
HINT = "Click the ground or a surface to query it     Esc, right click: done"


class PE_OT_ask_place(bpy.types.Operator):
    """Click a location in the 3D view: which sensors see it, how well, and what occludes it"""

    bl_idname = "pe.ask_place"
    bl_label = "Query Location"

    point: FloatVectorProperty(
        name="Location", description="x, y and z of the location", subtype="XYZ"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not bridge.sensor_objects(context.scene):
            cls.poll_message_set(shown("There are no sensors yet"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        """Query `point`, as scripts do."""
        location_query.query(context.scene, context.evaluated_depsgraph_get(), tuple(self.point))
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        """Query at each click, until Esc."""
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(shown(HINT))
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            end_query(context)
            return {"FINISHED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        view = view_under(context, event)
        if view is None:
            return {"PASS_THROUGH"}  # another part of the screen: its buttons go on working
        location = location_under(context, view)
        if location is None:
            report(self, "WARNING", "There is no ground or surface under the mouse")
        else:
            self.point = location
            self.execute(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file is closed."""
        end_query(context)


class PE_OT_dismiss_place(bpy.types.Operator):
    """Remove the answer and its mark"""

    bl_idname = "pe.dismiss_place"
    bl_label = "Dismiss"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        location_query.discard(context.scene)
        return {"FINISHED"}


def end_query(context: bpy.types.Context) -> None:
    """Restore the mouse cursor and the status bar."""
    context.window.cursor_modal_restore()
    for workspace in bpy.data.workspaces[:1]:
        workspace.status_text_set(None)


def answer(scene: bpy.types.Scene) -> tuple[str, ...] | None:
    """Return the lines to show of the last query."""
    result = location_query.answer(scene)
    return None if result is None else result.lines


def location_under(
    context: bpy.types.Context, view: ViewUnderMouse
) -> tuple[float, float, float] | None:
    """Return the location under the mouse: just off a surface, or on the ground, z = 0."""
    origin, direction = ray_of(view)
    depsgraph = context.evaluated_depsgraph_get()
    hit, location, normal, *_ = context.scene.ray_cast(depsgraph, origin, direction)
    ground = _on_ground(origin, direction)
    if hit and (ground is None or (location - origin).length <= (ground - origin).length):
        outward = normal if normal.dot(direction) < 0.0 else -normal
        ground = location + outward * OFF_SURFACE_M
        ground.z = max(ground.z, 0.0)
    return None if ground is None else tuple(ground)


def _on_ground(origin: Vector, direction: Vector) -> Vector | None:
    if abs(direction.z) < 1e-6 or origin.z / direction.z > 0.0:
        return None
    location = origin - direction * (origin.z / direction.z)
    location.z = 0.0
    return location


CLASSES = (
    PE_OT_ask_place,
    PE_OT_dismiss_place,
)
