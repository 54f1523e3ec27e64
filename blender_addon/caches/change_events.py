"""Emits `signals.moving` while sensors or the vehicle move, and `signals.idle` once after.

Blender calls the handler once for each drawn move of the mouse. A handler must not write data, and
work in it would delay the redraw; so a change is only counted there, and timers emit the signals:
the idle signal is debounced. Without a window nothing is emitted.
"""

import time
from collections.abc import Hashable

import bpy

from .. import signals
from . import sensor_cache, vehicle_cache

IDLE_S = 0.25  # How long nothing has to move until the scene is idle

_idle_at = 0.0
_change_count = 0
_last_counted: dict[str, Hashable] = {}
"""The counted objects of each scene at the last change, by the scene's name: plain values."""


def change_count() -> int:
    """Return how many changes were noted; it rises at once, before the signal."""
    return _change_count


def note_if_changed(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update or a change of frame: note a change where a sensor or the vehicle differs."""
    # Data of other types concerns neither sensors nor the vehicle.
    kinds = depsgraph.id_type_updated
    if bpy.app.background or not (kinds("OBJECT") or kinds("COLLECTION") or kinds("SCENE")):
        return
    layer = depsgraph.view_layer
    vehicle = scene.perception_entropy.vehicle
    sensors = tuple((s.name, s.visible_get(view_layer=layer)) for s in sensor_cache.sensors(scene))
    parts = () if vehicle is None else vehicle_cache.counted_members(vehicle, depsgraph)
    units = scene.unit_settings.system, scene.unit_settings.scale_length
    present = sensors, parts, vehicle_cache.shared.version, units
    if _last_counted.get(scene.name) != present or _sensor_moved(depsgraph):
        _last_counted[scene.name] = present
        note_change()


def note_change(*_: object) -> None:
    """Count a change, and have both signals emitted by timers."""
    global _idle_at, _change_count
    _change_count += 1
    if bpy.app.background:  # a timer left behind makes Blender crash at its exit
        return
    _idle_at = time.monotonic() + IDLE_S
    for function, wait in ((emit_moving, 0.0), (emit_idle, IDLE_S)):
        if not bpy.app.timers.is_registered(function):
            bpy.app.timers.register(function, first_interval=wait)


def clear(*_: object) -> None:
    """Before another file is opened: its scenes may have the same names."""
    _last_counted.clear()


def emit_moving() -> float | None:
    """Timer: emit `moving`, after the redraw of a move, which may take as long as `IDLE_S`."""
    global _idle_at
    count = _change_count
    signals.moving.emit()
    _idle_at = time.monotonic() + IDLE_S
    return None if count == _change_count else 0.0


def emit_idle() -> float | None:
    """Timer: emit `idle` once nothing has moved for long enough; until then wait.

    Timers are called between a move of the mouse and Blender's update of it. A listener may cause
    that update: a change noted then finds this timer still registered, so the timer has to continue
    by itself. After a redraw longer than `IDLE_S` both timers are due, and Blender calls the one
    that was registered first: `moving` must not come after the last `idle`.
    """
    left = _idle_at - time.monotonic()
    count = _change_count
    if left > 0.0 or bpy.app.timers.is_registered(emit_moving):
        return max(left, 0.0)
    signals.idle.emit()
    return None if count == _change_count else IDLE_S


def _sensor_moved(depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update moved a sensor; by a parent or a constraint as well."""
    return any(
        isinstance(update.id, bpy.types.Object)
        and update.is_updated_transform
        and update.id.original.perception_entropy.is_sensor
        for update in depsgraph.updates
    )


def unregister() -> None:
    """Cancel the signals that are due."""
    for function in (emit_moving, emit_idle):
        if bpy.app.timers.is_registered(function):
            bpy.app.timers.unregister(function)
    clear()
