"""Query a location: click the ground or any surface to see which sensors see it, and why not."""

from collections.abc import Iterable
from typing import Any

import bpy
from bpy.props import FloatVectorProperty

from .. import bridge, location_query
from .declared import OperatorResult, operator, report
from .surface_pose import ViewUnderMouse, ray_of, view_under

OFF_SURFACE_M = 0.05
"""How far outside a surface the query is: half a voxel, as the inside does not count."""
HINT = "Click the ground or a surface to query it     Esc, right click: done"


def clicking(hint: str, once: bool = False) -> dict[str, Any]:
    """Return members of an operator that is executed at each click on a surface, until Esc. With
    `once` it ends with the first click that does something: an undo step of its own. Its property
    `point` is the location; `hint` is shown in the status bar."""

    def begin(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(hint)
        return {"RUNNING_MODAL"}

    def modal(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            end(self, context)
            return {"CANCELLED"} if once else {"FINISHED"}
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
            if self.execute(context) == {"FINISHED"} and once:
                end(self, context)
                return {"FINISHED"}
        return {"RUNNING_MODAL"}

    def end(_self: Any, context: bpy.types.Context) -> None:
        """Restore the mouse cursor and the status bar; Blender calls this at a window's close."""
        context.window.cursor_modal_restore()
        for workspace in bpy.data.workspaces[:1]:
            workspace.status_text_set(None)

    point = FloatVectorProperty(
        name="Location", description="x, y and z of the location", subtype="XYZ"
    )
    return {"invoke": begin, "modal": modal, "cancel": end, "point": point}


@operator(
    "Query Location",
    unless=lambda context: (
        None if bridge.sensor_objects(context.scene) else "There are no sensors yet"
    ),
    options=frozenset(),
    **clicking(HINT),
)
def ask_place(context: bpy.types.Context, point: Iterable[float]) -> None:
    """Click a location: which sensors see it, and what occludes it from the others"""
    x, y, z = point
    location_query.query(context.scene, context.evaluated_depsgraph_get(), (x, y, z))


def location_under(
    context: bpy.types.Context, view: ViewUnderMouse
) -> tuple[float, float, float] | None:
    """Return the location under the mouse: just off a surface, or on the ground, z = 0."""
    origin, direction = ray_of(view)
    depsgraph = context.evaluated_depsgraph_get()
    hit, location, normal, *_ = context.scene.ray_cast(depsgraph, origin, direction)
    ground = None
    if abs(direction.z) >= 1e-6 and origin.z / direction.z <= 0.0:
        ground = origin - direction * (origin.z / direction.z)
        ground.z = 0.0
    if hit and (ground is None or (location - origin).length <= (ground - origin).length):
        outward = normal if normal.dot(direction) < 0.0 else -normal
        ground = location + outward * OFF_SURFACE_M
        ground.z = max(ground.z, 0.0)
    return None if ground is None else tuple(ground)
