"""Perception Entropy: places LiDARs and cameras on a vehicle by what they let it perceive."""

from __future__ import annotations

import bpy

from . import (
    asking,
    body,
    commands,
    explaining,
    library,
    live,
    motion,
    operators,
    panels,
    properties,
    roster,
    searching,
    stale,
    unsaved,
    upkeep,
    worker,
)
from .housing import fitting
from .overlay import handler as overlay

CLASSES = (*library.CLASSES, *properties.CLASSES, *operators.CLASSES, *panels.CLASSES)


def register() -> None:
    """Called by Blender when the add-on is switched on."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    properties.add_pointers()
    roster.register()
    body.register()
    operators.register()
    upkeep.register()
    motion.register()
    stale.register()
    unsaved.register()
    live.register()
    searching.register()
    explaining.register()
    asking.register()
    overlay.register()
    panels.register()
    fitting.register()
    commands.register()
    library.register()


def unregister() -> None:
    """Called by Blender when the add-on is switched off: everything above, backwards."""
    operators.unregister()
    worker.unregister()
    library.unregister()
    commands.unregister()
    fitting.unregister()
    panels.unregister()
    overlay.unregister()
    searching.unregister()
    live.unregister()
    asking.unregister()
    explaining.unregister()
    unsaved.unregister()
    stale.unregister()
    motion.unregister()
    upkeep.unregister()
    body.unregister()
    roster.unregister()
    properties.remove_pointers()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
