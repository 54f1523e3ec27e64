"""Tells when a stored result no longer is that of the scene.

Blender calls the handler at every change; it only asks for a check soon after, because data must
not be written inside a handler.
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from . import bridge, changes, roster

CHECK_AFTER_S = 0.25


@persistent
def on_change(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Handler of depsgraph_update_post."""
    if scene.perception_entropy.has_result and depsgraph.id_type_updated("OBJECT"):
        check_soon()


@persistent
def on_undo(_scene: bpy.types.Scene) -> None:
    """Handler of undo_post and redo_post: they bring the flag back as it once was."""
    check_soon()


def check_soon() -> None:
    """Check a moment from now; several wishes become one check."""
    # Without a window nobody looks, and a timer left behind makes Blender crash at its exit.
    if not bpy.app.background and not bpy.app.timers.is_registered(check):
        bpy.app.timers.register(check, first_interval=CHECK_AFTER_S)


def check() -> None:
    """Set `result_stale` of every scene."""
    for scene in bpy.data.scenes:
        settings = scene.perception_entropy
        if not settings.has_result:
            continue
        stale = bridge.signature(scene, roster.sensors(scene)) != settings.result_signature
        if stale != settings.result_stale:
            settings.result_stale = stale


def _handlers() -> tuple[tuple[list, object], ...]:
    lists = bpy.app.handlers
    return (
        (lists.depsgraph_update_post, on_change),
        (lists.undo_post, on_undo),
        (lists.redo_post, on_undo),
    )


def register() -> None:
    """Start listening."""
    for handlers, function in _handlers():
        handlers.append(function)
    changes.study.connect(check_soon)


def unregister() -> None:
    """Stop listening, also to the check that may be due."""
    changes.study.disconnect(check_soon)
    for handlers, function in reversed(_handlers()):
        handlers.remove(function)
    if bpy.app.timers.is_registered(check):
        bpy.app.timers.unregister(check)
