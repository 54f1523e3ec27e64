"""Which objects are sensors, for what is drawn again and again: looked for once a change.

A panel and a 3D view are drawn at every turn of the view, and looking through a scene takes as
long as the scene is large. Scripts may ask before Blender has noted what they did: operators look
for themselves (`bridge.sensor_objects`).
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from . import bridge, changes

_found: dict[str, list[bpy.types.Object]] = {}
"""Sensors by the scene's name. Objects are held to the next change only: to look one up by its name
takes Blender a good part of what it takes to look through all."""


def sensors(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """All sensors of a scene by name, hidden ones included."""
    if scene.name not in _found or not all(map(_is_sensor, _found[scene.name])):
        _found[scene.name] = bridge.sensor_objects(scene)
    return list(_found[scene.name])


@persistent
def forget(*_: object) -> None:
    """Look again when asked the next time."""
    _found.clear()


def _is_sensor(obj: bpy.types.Object) -> bool:
    """Whether an object still is there, and a sensor."""
    try:
        return obj.perception_entropy.is_sensor
    except ReferenceError:  # a script removed it a moment ago
        return False


def _handlers() -> tuple[list, ...]:
    lists = bpy.app.handlers
    changed = (lists.depsgraph_update_post, lists.undo_post, lists.redo_post, lists.load_post)
    return (*changed, lists.undo_pre, lists.redo_pre, lists.load_pre)


def register() -> None:
    """Start listening to what may make another object a sensor."""
    for handlers in _handlers():
        handlers.append(forget)
    changes.study.connect(forget)


def unregister() -> None:
    """Stop listening, and forget what was found."""
    changes.study.disconnect(forget)
    for handlers in _handlers():
        handlers.remove(forget)
    forget()
