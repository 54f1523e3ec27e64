"""Keeps the sensors of scenes consistent, whatever was done outside the add-on's operators.

A duplicated, copied or appended sensor is a new one and gets a colour of its own. Sensors that are
linked to mirror images move with them, and a view camera goes with its sensor. All this happens on
the moving signal, after a file was opened and before one is saved: at these times data may be
written.
"""

from functools import partial

import bpy

from . import bridge, sensor_cache

TOLD_S = 8.0


def after_load(*_: object) -> None:
    """After a file was opened: repair it."""
    bridge.clear_mirrors()
    repair_scenes()


def before_save(*_: object) -> None:
    """Before a file is saved: mirror images of sensors that have just moved follow."""
    repair_scenes()


def repair_scenes() -> None:
    """Repair the sensors of all scenes."""
    bridge.sync_own_sensors()  # undo may have brought others back
    for scene in bpy.data.scenes:
        sensors = sensor_cache.sensors(scene)
        bridge.assign_colors(scene, sensors)
        bridge.update_view_cameras(scene, sensors)
    if bpy.context.view_layer is not None:  # other scenes are not evaluated
        scene = bpy.context.scene
        depsgraph = bpy.context.evaluated_depsgraph_get()
        released = bridge.follow_mirrors(scene, depsgraph, sensor_cache.sensors(scene))
        if released and not bpy.app.background:
            _tell(f"No longer linked: {', '.join(released)} is in the middle of the vehicle")


def _tell(text: str) -> None:
    """Write a line into the status bar, for a while."""
    for workspace in bpy.data.workspaces[:1]:  # any one: it is written for all
        workspace.status_text_set(text)
        clear = partial(workspace.status_text_set, None)
        bpy.app.timers.register(clear, first_interval=TOLD_S)


def unregister() -> None:
    """Take own sensors out of the catalogue, and drop what is known of mirror images."""
    bridge.remove_own_sensors()
    bridge.clear_mirrors()
