"""Ask a place: click the ground or any surface, and be told who sees it, and who does not, why."""

from __future__ import annotations

import bpy
from bpy.props import FloatVectorProperty
from bpy_extras import view3d_utils
from mathutils import Vector

from .. import asking, bridge
from .reports import tell

OFF_SURFACE_M = 0.05
"""How far outside a surface is asked: half a voxel, as its inside does not count."""
HINT = "Click the ground or a surface to ask about it     Esc, right click: done"


class PE_OT_ask_place(bpy.types.Operator):
    """Click a place in the 3D view: which sensors see it and how well, and what hides it"""

    bl_idname = "pe.ask_place"
    bl_label = "Ask a Place"

    point: FloatVectorProperty(
        name="Place", description="x, y and z of the place that is asked about", subtype="XYZ"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not bridge.sensor_objects(context.scene):
            cls.poll_message_set("There are no sensors yet")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Ask about `point`, as scripts do."""
        asking.ask(context.scene, context.evaluated_depsgraph_get(), tuple(self.point))
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Have each click ask, until Esc."""
        context.window_manager.modal_handler_add(self)
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(HINT)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            end(context)
            return {"FINISHED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        window = view_under(context, event.mouse_x, event.mouse_y)
        if window is None:
            return {"PASS_THROUGH"}  # another part of the screen: its buttons go on working
        area, region = window
        place = place_under(context, area, region, event.mouse_x, event.mouse_y)
        if place is None:
            tell(self, "WARNING", "There is neither ground nor surface under the mouse")
        else:
            self.point = place
            self.execute(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Called by Blender when the window or the file goes."""
        end(context)


class PE_OT_dismiss_place(bpy.types.Operator):
    """Take the answer and its mark away"""

    bl_idname = "pe.dismiss_place"
    bl_label = "Dismiss"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        asking.dismiss(context.scene)
        return {"FINISHED"}


def end(context: bpy.types.Context) -> None:
    """Put the mouse and the status bar back."""
    context.window.cursor_modal_restore()
    for workspace in bpy.data.workspaces[:1]:
        workspace.status_text_set(None)


def answer(scene: bpy.types.Scene) -> tuple[str, ...] | None:
    """Return the lines to show of the place that was asked about last."""
    found = asking.answer(scene)
    return None if found is None else found.lines


def view_under(
    context: bpy.types.Context, x: int, y: int
) -> tuple[bpy.types.Area, bpy.types.Region] | None:
    """Return the 3D view and its main region under the mouse; None over anything else."""
    for area in context.window.screen.areas:
        inside = [r for r in area.regions if _holds(r, x, y)]
        window = [r for r in inside if r.type == "WINDOW"]
        # Sidebar, header and toolbar lie over the main region, and take their clicks themselves.
        if area.type == "VIEW_3D" and window and len(inside) == len(window):
            return area, window[0]
    return None


def place_under(
    context: bpy.types.Context, area: bpy.types.Area, region: bpy.types.Region, x: int, y: int
) -> tuple[float, float, float] | None:
    """Return what is under the mouse: a place just off a surface, or on the ground, z = 0."""
    view = _region_3d(area, region)
    at = (x - region.x, y - region.y)
    origin = view3d_utils.region_2d_to_origin_3d(region, view, at)
    direction = view3d_utils.region_2d_to_vector_3d(region, view, at)
    depsgraph = context.evaluated_depsgraph_get()
    hit, place, normal, *_ = context.scene.ray_cast(depsgraph, origin, direction)
    ground = _on_ground(origin, direction)
    if hit and (ground is None or (place - origin).length <= (ground - origin).length):
        outward = normal if normal.dot(direction) < 0.0 else -normal
        ground = place + outward * OFF_SURFACE_M
        ground.z = max(ground.z, 0.0)
    return None if ground is None else tuple(ground)


def _on_ground(origin: Vector, direction: Vector) -> Vector | None:
    if abs(direction.z) < 1e-6 or origin.z / direction.z > 0.0:
        return None
    place = origin - direction * (origin.z / direction.z)
    place.z = 0.0
    return place


def _region_3d(area: bpy.types.Area, region: bpy.types.Region) -> bpy.types.RegionView3D:
    """The view of a region; of a quad view, that of its quarter."""
    space = area.spaces.active
    quarters = [r for r in area.regions if r.type == "WINDOW"]
    if len(space.region_quadviews) == len(quarters) > 1:
        return space.region_quadviews[quarters.index(region)]
    return space.region_3d


def _holds(region: bpy.types.Region, x: int, y: int) -> bool:
    across = region.x <= x < region.x + region.width
    return across and region.y <= y < region.y + region.height


CLASSES = (PE_OT_ask_place, PE_OT_dismiss_place)
