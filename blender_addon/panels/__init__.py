"""The sidebar tab: panels draw what is stored and compute nothing.

Panels appear in the order of CLASSES; a parent is registered before its children.
"""

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
    sensor_menus,
    variant_panels,
)

CLASSES = (
    *sensor_menus.CLASSES,
    *sensor_lists.CLASSES,
    *main.CLASSES,
    *score_details.LIVE_CLASSES,
    *selected_object.CLASSES,
    *main.WARNING_CLASSES,
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


def register() -> None:
    """Add icons, and entries in Blender's own headers and menus."""
    overlay_popover.register()
    main.register()
    sensor_menus.register()
    menus.register()


def unregister() -> None:
    """Remove them."""
    menus.unregister()
    sensor_menus.unregister()
    main.unregister()
    overlay_popover.unregister()
