"""Look through a sensor: a camera's view, or a picture of a LiDAR's ranges; and back again.

While a view shows what a camera sees, Blender overwrites its rotation, and loses whether it was
orthographic. The states of views are kept in the scene, so that a file saved meanwhile has
them, and in this module, because undo takes the scene's away.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import bpy
from bpy.props import StringProperty

from .. import bridge
from ..engine import pe
from ..language import shown
from ..sensor_kinds import kind_label, row_of
from . import sensor_pictures
from .reports import USER_ERRORS, OperatorResult, chosen_sensor, report, report_error

SPACE_FIELDS = ("lens", "clip_start", "clip_end", "lock_camera")
VIEW_FIELDS = (
    *("view_perspective", "view_location", "view_rotation", "view_distance"),
    *("view_camera_zoom", "view_camera_offset", "is_orthographic_side_view"),
)
"""In the order in which they are set: an axis view has to follow its rotation."""
CAMERA_PERSPECTIVE = "CAMERA"

_states: dict[str, str] = {}
"""States of the views that look through a sensor, by the scene's name, as stored in the scene."""


def look_along(scene: bpy.types.Scene, area: bpy.types.Area | None) -> None:
    """Have a 3D view look through the scene's camera; store its state of before, once."""
    if area is None or area.type != "VIEW_3D":
        return
    settings, space = scene.perception_entropy, area.spaces.active
    states = json.loads(settings.views_before_look or "[]")
    if not any(find_view(state) == space for state in states):
        states.append(state_of(area))
        settings.views_before_look = json.dumps(states)
    _states[scene.name] = settings.views_before_look
    space.lock_camera = False  # turning the view would turn the camera away from its sensor
    space.use_local_camera = False
    space.region_3d.view_perspective = CAMERA_PERSPECTIVE


def restore(scene: bpy.types.Scene) -> None:
    """Restore the views; those that do not show the camera any more stay as they are."""
    settings = scene.perception_entropy
    noted = settings.views_before_look or _states.get(scene.name, "[]")
    settings.views_before_look = ""
    _states.pop(scene.name, None)
    for state in json.loads(noted):
        space = find_view(state)
        if space is not None:
            apply_state(space, state)


def restore_lost() -> None:
    """Restore views of scenes that look through no sensor any more: after undo, or its deletion."""
    for name in list(_states):
        scene = bpy.data.scenes.get(name)
        if scene is None:
            del _states[name]
        elif not scene.perception_entropy.before_look:
            restore(scene)


def state_of(area: bpy.types.Area) -> dict[str, object]:
    """Return the state of a 3D view and its position on the screen, as JSON data."""
    space, screen = area.spaces.active, area.id_data
    look = space.region_3d
    camera = space.camera.name if space.use_local_camera and space.camera else None
    return {
        "space": space.as_pointer(),
        "screen": screen.name,
        "area": list(screen.areas).index(area),
        "local_camera": camera,
        **{name: getattr(space, name) for name in SPACE_FIELDS},
        **{name: _json_value(getattr(look, name)) for name in VIEW_FIELDS},
    }


def apply_state(space: bpy.types.SpaceView3D, state: dict[str, object]) -> None:
    """Restore a view's state, its lens and lock included."""
    for name in SPACE_FIELDS:
        setattr(space, name, state[name])
    camera = bpy.data.objects.get(str(state["local_camera"]))
    if camera is not None:
        space.use_local_camera = True
        space.camera = camera
    if space.region_3d.view_perspective == CAMERA_PERSPECTIVE:
        for name in VIEW_FIELDS:
            setattr(space.region_3d, name, state[name])


def find_view(state: dict[str, object]) -> bpy.types.SpaceView3D | None:
    """Return the view that a state is of; after opening a file, the one at its position."""
    for area in _view_areas():
        if area.spaces.active.as_pointer() == state["space"]:
            return area.spaces.active
    screen = bpy.data.screens.get(str(state["screen"]))
    number = int(str(state["area"]))
    if screen is None:
        return None
    areas = list(screen.areas)[number : number + 1]
    return next((a.spaces.active for a in areas if a.type == "VIEW_3D"), None)


def _view_areas() -> Iterator[bpy.types.Area]:
    for screen in bpy.data.screens:
        yield from (area for area in screen.areas if area.type == "VIEW_3D")


def _json_value(value: Any) -> Any:
    """Return numbers of a vector as a list."""
    return value if isinstance(value, str | float | bool) else list(value)


class PE_OT_look_through(bpy.types.Operator):
    """Show what this sensor sees: through a camera (press again to come back), or as a picture"""

    bl_idname = "pe.look_through"
    bl_label = "Look Through"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(name="Name", description="Name of the sensor; the active one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Look Through works in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        try:
            obj = chosen_sensor(context, self.name)
            sensor = bridge.sensor_from_object(obj, context.evaluated_depsgraph_get())
        except USER_ERRORS as error:
            return report_error(self, error)
        row = row_of(sensor.kind)
        if row.pixels is not None:
            return self._picture(context, sensor, row.legend)
        if row.camera is None:
            what = kind_label(sensor.kind)
            report(self, "WARNING", f"{obj.name}: there is no picture of sensors of kind {what}")
            return {"CANCELLED"}
        if looking_through(scene) == obj:
            come_back(scene)
            return {"FINISHED"}
        bridge.look_through(scene, obj, row.camera(sensor.model))
        look_along(scene, context.area)
        return {"FINISHED"}

    def _picture(
        self, context: bpy.types.Context, sensor: pe.Sensor, legend: str
    ) -> OperatorResult:
        """Have a picture made by the background worker, and show it when it is there."""
        try:
            vehicle = _vehicle(context)
        except USER_ERRORS as error:
            return report_error(self, error)
        sensor_pictures.request_image(sensor, vehicle)
        report(self, "INFO", f"{sensor.name}: {legend}")
        return {"FINISHED"}


class PE_OT_look_back(bpy.types.Operator):
    """Stop looking through a sensor: restore the view and the scene's camera"""

    bl_idname = "pe.look_back"
    bl_label = "Stop Looking Through"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.mode == "OBJECT" and looking_through(context.scene) is not None

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        come_back(context.scene)
        return {"FINISHED"}


def looking_through(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Return the sensor that is looked through."""
    camera = scene.camera
    if not scene.perception_entropy.before_look or camera is None:
        return None
    return camera.parent if camera.perception_entropy.is_view else None


def come_back(scene: bpy.types.Scene) -> None:
    """Restore the scene's camera, size of renders, and views."""
    bridge.look_back(scene)
    restore(scene)


def _vehicle(context: bpy.types.Context) -> pe.Vehicle | None:
    if context.scene.perception_entropy.vehicle is None:
        return None
    return bridge.vehicle_of_scene(context.scene, context.evaluated_depsgraph_get())


CLASSES = (
    PE_OT_look_through,
    PE_OT_look_back,
)
