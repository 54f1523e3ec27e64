"""Perception Entropy: places LiDARs and cameras on a vehicle by what they let it perceive."""

from __future__ import annotations

import bpy

from . import (
    change_events,
    commands,
    consistency,
    diagnostics,
    library,
    live,
    location_query,
    operators,
    panels,
    properties,
    search_curve,
    sensor_cache,
    vehicle_cache,
    wiring,
    worker,
)
from .overlay import draw_handler as overlay

CLASSES = (*library.CLASSES, *properties.CLASSES, *operators.CLASSES, *panels.CLASSES)


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    properties.add_pointers()
    wiring.register()
    operators.register()
    live.register()
    search_curve.register()
    overlay.register()
    panels.register()
    commands.register()
    library.register()


def unregister() -> None:
    """Called by Blender when the add-on is disabled: what runs ends first, then all is removed."""
    operators.unregister()
    worker.unregister()
    wiring.unregister()
    library.unregister()
    commands.unregister()
    panels.unregister()
    overlay.unregister()
    search_curve.unregister()
    live.unregister()
    location_query.clear()
    diagnostics.postpone_checks()
    change_events.unregister()
    consistency.unregister()
    vehicle_cache.clear()
    sensor_cache.invalidate()
    properties.remove_pointers()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
