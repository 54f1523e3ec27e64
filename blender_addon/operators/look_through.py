"""Look through a camera.

While a view shows what a camera sees, Blender overwrites its rotation, and loses whether it was
orthographic. The states of views are kept here: undo would take them away from the scene.
"""

from typing import Any

import bpy

from .. import document
from ..sensor_kinds import kind_label, row_of
from .declared import Refused, chosen_sensor, operator
from .edit_sensors import NAME

SPACE_FIELDS = ("lens", "clip_start", "clip_end", "lock_camera")
VIEW_FIELDS = (
    "view_perspective",
    "view_location",
    "view_rotation",
    "view_distance",
    "view_camera_zoom",
    "view_camera_offset",
    "is_orthographic_side_view",
)
"""In the order in which they are set: an axis view has to follow its rotation."""
CAMERA_PERSPECTIVE = "CAMERA"

_states: dict[str, dict[int, dict[str, Any]]] = {}
"""States of the views that look through a sensor, by the scene's name and the view's pointer."""


def look_along(scene: bpy.types.Scene, area: bpy.types.Area | None) -> None:
    """Have a 3D view look through the scene's camera; note its state of before, once."""
    if area is None or area.type != "VIEW_3D":
        return
    space = area.spaces.active
    _states.setdefault(scene.name, {}).setdefault(space.as_pointer(), state_of(space))
    space.lock_camera = False  # turning the view would turn the camera away from its sensor
    space.use_local_camera = False
    space.region_3d.view_perspective = CAMERA_PERSPECTIVE


def restore(scene: bpy.types.Scene) -> None:
    """Restore the views; those that do not show the camera any more stay as they are."""
    states = _states.pop(scene.name, {})
    for area in (area for screen in bpy.data.screens for area in screen.areas):
        space = area.spaces.active
        if area.type == "VIEW_3D" and space.as_pointer() in states:
            apply_state(space, states[space.as_pointer()])


def restore_lost() -> None:
    """Restore views of scenes that look through no sensor any more: after undo, or its deletion."""
    for name in list(_states):
        scene = bpy.data.scenes.get(name)
        if scene is None:
            del _states[name]
        elif not scene.perception_entropy.before_look:
            restore(scene)


def state_of(space: bpy.types.SpaceView3D) -> dict[str, Any]:
    """Return the state of a 3D view."""
    look = space.region_3d
    camera = space.camera.name if space.use_local_camera and space.camera else ""
    own = {name: getattr(space, name) for name in SPACE_FIELDS}
    return {"local_camera": camera, **own, **{n: _copied(getattr(look, n)) for n in VIEW_FIELDS}}


def apply_state(space: bpy.types.SpaceView3D, state: dict[str, Any]) -> None:
    """Restore a view's state, its lens and lock included."""
    for name in SPACE_FIELDS:
        setattr(space, name, state[name])
    camera = bpy.data.objects.get(state["local_camera"])
    if camera is not None:
        space.use_local_camera = True
        space.camera = camera
    if space.region_3d.view_perspective == CAMERA_PERSPECTIVE:
        for name in VIEW_FIELDS:
            setattr(space.region_3d, name, state[name])


def _copied(value: Any) -> Any:
    """Return a value that does not change with the view."""
    return value if isinstance(value, str | float | bool) else tuple(value)


@operator("Look Through", mode="Look Through works in Object Mode", name=NAME)
def look_through(context: bpy.types.Context, name: str) -> None:
    """Show what this camera sees (press again to come back)"""
    scene = context.scene
    depsgraph = context.evaluated_depsgraph_get()
    obj = chosen_sensor(context, name)
    sensor = document.sensor_from_object(obj, depsgraph)
    row = row_of(sensor.kind)
    if row.camera is None:
        what = kind_label(sensor.kind)
        raise Refused(f"{obj.name} is no camera but of kind {what}: nothing to look through")
    if looking_through(scene) == obj:
        come_back(scene)
    else:
        document.look_through(scene, obj, row.camera(sensor.model))
        look_along(scene, context.area)


def _unless_looking(context: bpy.types.Context) -> str | None:
    is_looking = context.mode == "OBJECT" and looking_through(context.scene) is not None
    return None if is_looking else ""


@operator("Stop Looking Through", unless=_unless_looking)
def look_back(context: bpy.types.Context) -> None:
    """Stop looking through a sensor: restore the view and the scene's camera"""
    come_back(context.scene)


def looking_through(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Return the sensor that is looked through."""
    camera = scene.camera
    if not scene.perception_entropy.before_look or camera is None:
        return None
    return camera.parent if camera.perception_entropy.is_view else None


def come_back(scene: bpy.types.Scene) -> None:
    """Restore the scene's camera, size of renders, and views."""
    document.look_back(scene)
    restore(scene)
