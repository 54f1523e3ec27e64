"""Query a location: click the ground or any surface to see which sensors see it, and why not."""

from collections.abc import Iterable
from typing import Any

import bpy
from bpy.props import FloatVectorProperty

from .. import document
from ..queries import location_query
from . import modes
from .declared import OperatorResult, PollReason, operator, report
from .surface_pose import ViewUnderMouse, ray_of, view_under

STANDS_M = 0.45
"""Height of a query on the ground: the top of what is 0.5 m tall, which blind ground is about."""
OFF_SURFACE_M = 0.05
"""How far outside a surface the query is: half a voxel, as the inside does not count."""
HINT = "Query Location: click the ground or a surface. Esc: done"


def clicking(
    hint: str, *, once: bool = False, without: PollReason = lambda _context: None
) -> dict[str, Any]:
    """Return members of an operator that is executed at each click on a surface: a mode. With
    `once` it ends with the first click that does something: an undo step of its own. It ends, too,
    where `without` says that its subject is gone. Its property `point` is the location; `hint` is
    drawn at the mouse, and in the status bar."""

    def begin(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        self.active = modes.begin(context, hint)
        _point(context, event)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self: Any, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        active = modes.current
        if active is None or active is not self.active:  # another tool has begun
            return {"CANCELLED", "PASS_THROUGH"}
        is_pressed = event.value == "PRESS"
        if is_pressed and event.type in {"ESC", "RIGHTMOUSE"}:
            modes.end()
            return {"CANCELLED"} if once else {"FINISHED"}
        if event.type == "MOUSEMOVE":
            _point(context, event)
        is_click = is_pressed and event.type == "LEFTMOUSE"
        is_other = is_pressed and not (is_click or modes.is_of_view(event.type))
        if is_other or active.is_left or without(context) is not None:
            modes.end()
            return {"CANCELLED", "PASS_THROUGH"}
        view = view_under(context, event) if is_click else None
        if view is None:
            return {"PASS_THROUGH"}  # another part of the screen: its buttons go on working
        location = location_under(context, view)
        if location is None:
            report(self, "WARNING", "There is no ground or surface under the mouse")
        else:
            self.point = location
            if self.execute(context) == {"FINISHED"} and once:
                modes.end()
                return {"FINISHED"}
        return {"RUNNING_MODAL"}

    point = FloatVectorProperty(
        name="Location", description="x, y and z of the location", subtype="XYZ"
    )
    return {
        "invoke": begin,
        "modal": modal,
        "cancel": lambda _self, _context: modes.end(),  # the window or the file is closed
        "active": None,
        "point": point,
    }


def _point(context: bpy.types.Context, event: bpy.types.Event) -> None:
    """Draw the hint of the mode where the mouse is, in a 3D view."""
    view = view_under(context, event)
    if modes.current is not None:
        region = 0 if view is None else view.region.as_pointer()
        modes.current.point(region, (0, 0) if view is None else view.mouse)


def _lacks_sensors(context: bpy.types.Context) -> str | None:
    return None if document.sensor_objects(context.scene) else "There are no sensors yet"


@operator(
    "Query Location",
    unless=_lacks_sensors,
    options=frozenset(),
    **clicking(HINT, without=_lacks_sensors),
)
def ask_place(context: bpy.types.Context, point: Iterable[float]) -> None:
    """Click a location: which sensors see it, and what occludes it from the others"""
    x, y, z = point
    location_query.query(context.scene, context.evaluated_depsgraph_get(), (x, y, z))


def location_under(
    context: bpy.types.Context, view: ViewUnderMouse
) -> tuple[float, float, float] | None:
    """Return the location under the mouse: just off a surface, or the top of what stands on the
    ground there."""
    origin, direction = ray_of(view)
    depsgraph = context.evaluated_depsgraph_get()
    hit, location, normal, *_ = context.scene.ray_cast(depsgraph, origin, direction)
    ground = None
    if abs(direction.z) >= 1e-6 and origin.z / direction.z <= 0.0:
        ground = origin - direction * (origin.z / direction.z)
        ground.z = 0.0
    is_body = hit and location.z > OFF_SURFACE_M  # a floor in the file is ground
    if is_body and (ground is None or (location - origin).length <= (ground - origin).length):
        outward = normal if normal.dot(direction) < 0.0 else -normal
        ground = location + outward * OFF_SURFACE_M
        ground.z = max(ground.z, 0.0)
    elif ground is not None:
        ground.z = STANDS_M
    return None if ground is None else tuple(ground)
