"""3D views as they were before they looked through a sensor, to be had again exactly.

While a view shows what a camera sees, Blender overwrites its rotation, and forgets whether it was
orthographic. States are kept in the scene, so that a file that is saved meanwhile has them, and in
this module, as undo takes the scene's away.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

import bpy

SPACE = ("lens", "clip_start", "clip_end", "lock_camera")
LOOK = (
    *("view_perspective", "view_location", "view_rotation", "view_distance"),
    *("view_camera_zoom", "view_camera_offset", "is_orthographic_side_view"),
)
"""In the order in which they are set: whether a view is one along an axis follows its rotation."""
CAMERA = "CAMERA"

_turned: dict[str, str] = {}
"""States of the views that look through a sensor, by the scene's name, as the scene keeps them."""


def turn(scene: bpy.types.Scene, area: bpy.types.Area | None) -> None:
    """Have a 3D view look through the scene's camera; note how it was, unless that is known."""
    if area is None or area.type != "VIEW_3D":
        return
    settings, space = scene.perception_entropy, area.spaces.active
    states = json.loads(settings.views_before_look or "[]")
    if not any(find(state) == space for state in states):
        states.append(state_of(area))
        settings.views_before_look = json.dumps(states)
    _turned[scene.name] = settings.views_before_look
    space.lock_camera = False  # turning the view would turn the camera away from its sensor
    space.use_local_camera = False
    space.region_3d.view_perspective = CAMERA


def restore(scene: bpy.types.Scene) -> None:
    """Have views look as they did before; those that have left the camera's picture stay."""
    settings = scene.perception_entropy
    noted = settings.views_before_look or _turned.get(scene.name, "[]")
    settings.views_before_look = ""
    _turned.pop(scene.name, None)
    for state in json.loads(noted):
        space = find(state)
        if space is not None:
            put(space, state)


def settle() -> None:
    """Restore views of scenes that look through nothing any more: by undo, or a lost sensor."""
    for name in list(_turned):
        scene = bpy.data.scenes.get(name)
        if scene is None:
            del _turned[name]
        elif not scene.perception_entropy.before_look:
            restore(scene)


def state_of(area: bpy.types.Area) -> dict[str, object]:
    """Return how a 3D view looks, and where it is: both as JSON data."""
    space, screen = area.spaces.active, area.id_data
    look = space.region_3d
    camera = space.camera.name if space.use_local_camera and space.camera else None
    return {
        "space": space.as_pointer(),
        "screen": screen.name,
        "area": list(screen.areas).index(area),
        "local_camera": camera,
        **{name: getattr(space, name) for name in SPACE},
        **{name: _plain(getattr(look, name)) for name in LOOK},
    }


def put(space: bpy.types.SpaceView3D, state: dict[str, object]) -> None:
    """Have a view look as it did, its lens and lock included."""
    for name in SPACE:
        setattr(space, name, state[name])
    camera = bpy.data.objects.get(str(state["local_camera"]))
    if camera is not None:
        space.use_local_camera = True
        space.camera = camera
    if space.region_3d.view_perspective == CAMERA:
        for name in LOOK:
            setattr(space.region_3d, name, state[name])


def find(state: dict[str, object]) -> bpy.types.SpaceView3D | None:
    """Return the view that a state is of; in a file that was opened, the one at its place."""
    for area in _views():
        if area.spaces.active.as_pointer() == state["space"]:
            return area.spaces.active
    screen = bpy.data.screens.get(str(state["screen"]))
    number = int(str(state["area"]))
    areas = [] if screen is None else list(screen.areas)[number : number + 1]
    return next((a.spaces.active for a in areas if a.type == "VIEW_3D"), None)


def _views() -> Iterator[bpy.types.Area]:
    for screen in bpy.data.screens:
        yield from (area for area in screen.areas if area.type == "VIEW_3D")


def _plain(value: object) -> object:
    """Return numbers of a vector as a list."""
    return value if isinstance(value, str | float | bool) else list(value)
