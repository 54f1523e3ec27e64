"""Keeps the sensors of scenes consistent, whatever was done outside the add-on's operators.

A duplicated, copied or appended sensor is a new one and gets a colour of its own. Sensors that are
linked to mirror images move with them, and a view camera goes with its sensor. All this happens on
the moving signal, after a file was opened and before one is saved: at these times data may be
written.
"""

import bpy

from .. import document
from . import sensor_cache

TOLD_S = 8.0  # How long the status bar says so


def after_load(*_: object) -> None:
    """After a file was opened: repair it."""
    document.clear_mirrors()
    repair_scenes()


def before_save(*_: object) -> None:
    """Before a file is saved: mirror images of sensors that have just moved follow."""
    repair_scenes()


def repair_scenes() -> None:
    """Repair the sensors of all scenes."""
    document.sync_own_sensors()  # undo may have brought others back
    for scene in bpy.data.scenes:
        sensors = sensor_cache.sensors(scene)
        document.assign_colors(scene, sensors)
        document.update_view_cameras(scene, sensors)
    if bpy.context.view_layer is not None:  # other scenes are not evaluated
        scene = bpy.context.scene
        depsgraph = bpy.context.evaluated_depsgraph_get()
        released = document.follow_mirrors(scene, depsgraph, sensor_cache.sensors(scene))
        if released and not bpy.app.background:
            tell = bpy.data.workspaces[0].status_text_set  # any one: it is shown in all
            tell(f"In the middle of the vehicle, so no longer linked: {', '.join(released)}")
            bpy.app.timers.register(lambda: tell(None), first_interval=TOLD_S)


def unregister() -> None:
    """Take own sensors out of the catalogue, and drop what is known of mirror images."""
    document.remove_own_sensors()
    document.clear_mirrors()
