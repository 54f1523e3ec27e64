"""Keeps sensors as they are to be, whatever was done to them outside the add-on's own operators.

A duplicated, copied or appended sensor is a new one: what it brought of another's result is not
its own. Sensors linked to their mirror images go with them, a camera that is looked through
goes with its sensor. Sensors of older files may be linked twice. It works when something is told to
have moved, after a file was opened and before one is saved: all are turns in which data may be
written.
"""

from __future__ import annotations

import sys

import bpy
from bpy.app.handlers import persistent

from . import bridge, changes, roster


@persistent
def on_load(*_: object) -> None:
    """Handler of load_post: mend what older versions wrote."""
    for scene in bpy.data.scenes:
        bridge.unlink_doubles(scene)
        bridge.bring_up_to_date(scene)
        if newer := bridge.newer_version(scene):
            print(f"perception_entropy: {newer}", file=sys.stderr)
    bridge.sync_own_sensors()
    bridge.forget_mirrors()
    go_round()


@persistent
def on_save(*_: object) -> None:
    """Handler of save_pre: scenes that are new, or were appended, are of this version.

    What has just moved has its mirror image put right before it is written.
    """
    for scene in bpy.data.scenes:
        bridge.bring_up_to_date(scene)
    go_round()


def go_round() -> None:
    """Put the sensors of all scenes right."""
    bridge.sync_own_sensors()  # undo may have brought others back
    for scene in bpy.data.scenes:
        sensors = roster.sensors(scene)
        bridge.drop_foreign_results(scene, sensors)
        bridge.tend_views(scene, sensors)
    if bpy.context.view_layer is not None:  # of another scene no places are known
        scene = bpy.context.scene
        bridge.follow_mirrors(scene, bpy.context.evaluated_depsgraph_get(), roster.sensors(scene))


def register() -> None:
    """Start listening."""
    changes.study.connect(bridge.sync_own_sensors)
    changes.moved.connect(go_round)
    bpy.app.handlers.load_post.append(on_load)
    bpy.app.handlers.save_pre.append(on_save)


def unregister() -> None:
    """Stop listening."""
    bpy.app.handlers.save_pre.remove(on_save)
    bpy.app.handlers.load_post.remove(on_load)
    changes.moved.disconnect(go_round)
    changes.study.disconnect(bridge.sync_own_sensors)
    bridge.forget_own_sensors()
    bridge.forget_mirrors()
