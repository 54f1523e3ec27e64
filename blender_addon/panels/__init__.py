"""The sidebar tab: panels draw what is stored and compute nothing.

Panels appear in the order of CLASSES; a parent is registered before its children.
"""

from . import (
    layout,
    main,
    overlay_popover,
    requirement_panel,
    score_details,
    scoring_panels,
    search_panels,
    selected_object,
    variant_panels,
)

CLASSES = (
    *main.CLASSES,
    *score_details.LIVE_CLASSES,
    *selected_object.CLASSES,
    *score_details.CLASSES,
    *variant_panels.CLASSES,
    *scoring_panels.CLASSES,
    *requirement_panel.CLASSES,
    *search_panels.CLASSES,
    *scoring_panels.ADVANCED_CLASSES,
    *overlay_popover.CLASSES,
    *main.EXPORT_CLASSES,
)


def register() -> None:
    """Add icons, and entries in Blender's own headers and menus."""
    layout.register()
    overlay_popover.register()
    main.register()


def unregister() -> None:
    """Remove them."""
    main.unregister()
    overlay_popover.unregister()
    layout.unregister()
