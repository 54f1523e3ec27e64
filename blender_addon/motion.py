"""Tells that sensors or the vehicle move, and that they rest: for what follows the hand.

Blender calls the handler once a drawn move of the mouse. Data must not be written there and work
would hold up the picture, so it is only noted; timers tell, `changes.moved` as long as things move
and `changes.rested` once after. Without a window nobody moves anything, and nothing is told.
"""

from __future__ import annotations

import time
from collections.abc import Hashable

import bpy
from bpy.app.handlers import persistent

from . import body, changes, roster

REST_S = 0.25
"""How long nothing has to move until it rests."""

_rests_at = 0.0
_count = 0
_known: dict[str, Hashable] = {}
"""What counted in each scene when it was looked at last, by the scene's name: plain values."""


def count() -> int:
    """How often something was noted to have moved; rises at once, before it is told."""
    return _count


@persistent
def note_changes(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update or a change of frame: note when a sensor or the vehicle is not as it was."""
    if bpy.app.background or not _may_matter(depsgraph):
        return
    present = _present(scene, depsgraph)
    if _known.get(scene.name) != present or _sensor_moved(depsgraph):
        _known[scene.name] = present
        note()


@persistent
def note(*_: object) -> None:
    """Tell soon that something has moved, and when it rests."""
    global _rests_at, _count
    _count += 1
    if bpy.app.background:  # a timer left behind makes Blender crash at its exit
        return
    _rests_at = time.monotonic() + REST_S
    for function, wait in ((tell_moved, 0.0), (tell_rested, REST_S)):
        if not bpy.app.timers.is_registered(function):
            bpy.app.timers.register(function, first_interval=wait)


@persistent
def forget(*_: object) -> None:
    """Before another file comes: its scenes may have the same names."""
    _known.clear()


def tell_moved() -> float | None:
    """Timer: something has just moved."""
    count = _count
    changes.moved.tell()
    return None if count == _count else 0.0


def tell_rested() -> float | None:
    """Timer: tell once nothing has moved for long enough; wait on until then.

    Timers are called between a move of the mouse and Blender's update of it. Who listens may bring
    that update about: what is noted then finds this timer registered still, so that it has to go
    on by itself.
    """
    left, count = _rests_at - time.monotonic(), _count
    if left > 0.0:
        return left
    changes.rested.tell()
    return None if count == _count else REST_S


def _may_matter(depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update is of a kind that can be a sensor's or the vehicle's."""
    return any(depsgraph.id_type_updated(kind) for kind in ("OBJECT", "COLLECTION", "SCENE"))


def _present(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Hashable:
    """Which sensors and parts of the vehicle count, and the version of the vehicle's shape."""
    layer, vehicle = depsgraph.view_layer, scene.perception_entropy.vehicle
    sensors = tuple((s.name, s.visible_get(view_layer=layer)) for s in roster.sensors(scene))
    parts = () if vehicle is None else body.members_of(vehicle, depsgraph)
    return sensors, parts, body.shared.version


def _sensor_moved(depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update moved a sensor; by a parent or a constraint as well."""
    return any(
        isinstance(update.id, bpy.types.Object)
        and update.is_updated_transform
        and update.id.original.perception_entropy.is_sensor
        for update in depsgraph.updates
    )


def _handlers() -> tuple[tuple[list, object], ...]:
    lists = bpy.app.handlers
    return (
        (lists.depsgraph_update_post, note_changes),
        (lists.frame_change_post, note_changes),
        (lists.undo_post, note),
        (lists.redo_post, note),
        (lists.load_pre, forget),
        (lists.load_post, note),
    )


def register() -> None:
    """Start listening."""
    for handlers, function in _handlers():
        handlers.append(function)
    changes.study.connect(note)


def unregister() -> None:
    """Stop listening, also to what is due to be told."""
    changes.study.disconnect(note)
    for handlers, function in reversed(_handlers()):
        handlers.remove(function)
    for function in (tell_moved, tell_rested):
        if bpy.app.timers.is_registered(function):
            bpy.app.timers.unregister(function)
    forget()
