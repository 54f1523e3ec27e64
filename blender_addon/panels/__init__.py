"""The sidebar tab: panels draw what is stored and compute nothing.

Panels appear in the order of CLASSES; a parent is registered before its children.
"""

from collections.abc import Callable

import bpy

from . import (
    condition_panel,
    main,
    menus,
    overlay_popover,
    requirement_panel,
    score_details,
    scoring_panels,
    search_panels,
    selected_object,
    sensor_lists,
    variant_panels,
)

CLASSES = (
    *sensor_lists.CLASSES,
    *main.CLASSES,
    *selected_object.CLASSES,
    *score_details.CLASSES,
    *variant_panels.CLASSES,
    *scoring_panels.CLASSES,
    *requirement_panel.CLASSES,
    *condition_panel.CLASSES,
    *search_panels.CLASSES,
    *scoring_panels.ADVANCED_CLASSES,
    *overlay_popover.CLASSES,
    *main.EXPORT_CLASSES,
    *menus.CLASSES,
)


PLACES: tuple[tuple[str, Callable[..., None]], ...] = (
    ("VIEW3D_HT_header", overlay_popover.draw_in_header),
    ("TOPBAR_MT_file_export", main.draw_export),
    ("TOPBAR_MT_file_import", main.draw_import),
    ("VIEW3D_MT_add", menus.draw_add_menu),
    ("VIEW3D_MT_object", menus.draw_object_menu),
    ("VIEW3D_MT_object_context_menu", menus.draw_context_menu),
    ("OUTLINER_MT_object", menus.draw_context_menu),
)
"""Blender's own menus and headers by name, and what is added to them."""


def register() -> None:
    """Add the entries to Blender's own menus."""
    for name, draw in PLACES:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Remove the entries from Blender's own menus."""
    for name, draw in reversed(PLACES):
        getattr(bpy.types, name).remove(draw)
