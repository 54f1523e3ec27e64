"""Perception Entropy: places LiDARs and cameras on a vehicle by what they let it perceive."""

import bpy

from . import commands, library, live, operators, panels, properties, wiring
from .caches import change_events, consistency, sensor_cache, vehicle_cache
from .overlay import draw_handler as overlay
from .preferences import preferences_panel
from .preferences.english import keep_english
from .processes import engine_process
from .queries import body_query, diagnostics, location_query, where_map
from .view import best_so_far, variant_pictures

CLASSES = (*preferences_panel.CLASSES, *properties.CLASSES, *operators.CLASSES, *panels.CLASSES)


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    for cls in CLASSES:
        keep_english(cls)
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    properties.add_pointers()
    panels.register()
    start()


def start() -> None:
    """Add handlers, listeners, keys and commands: what works on classes that are registered."""
    wiring.register()
    operators.register()
    live.register()
    overlay.register()
    commands.register()
    library.register()
    preferences_panel.register()


def unregister() -> None:
    """Called by Blender when the add-on is disabled: what runs ends first, then all is removed."""
    stop()
    panels.unregister()
    properties.remove_pointers()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


def stop() -> None:
    """End what runs, remove what `start` added, and drop what is kept between two calls."""
    operators.unregister()
    engine_process.stop()
    wiring.unregister()
    preferences_panel.unregister()
    library.unregister()
    commands.unregister()
    overlay.unregister()
    best_so_far.searches.clear()
    live.unregister()
    location_query.clear()
    body_query.clear()
    where_map.clear()
    variant_pictures.clear()
    diagnostics.postpone_checks()
    change_events.unregister()
    consistency.unregister()
    vehicle_cache.shared.clear()
    sensor_cache.invalidate()
