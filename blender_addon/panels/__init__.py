"""The sidebar tab: draws what is stored, computes nothing. Panels stand in the order of CLASSES."""

from . import (
    advanced,
    breakdown,
    explain,
    export,
    focus,
    live,
    main,
    mounts,
    overlay,
    part,
    search,
    selection,
    sensor,
    swatches,
    tolerance,
    variants,
)

CLASSES = (
    *main.CLASSES,
    *live.CLASSES,
    *sensor.CLASSES,
    *part.CLASSES,
    *explain.CLASSES,
    *breakdown.CLASSES,
    *variants.CLASSES,
    *selection.CLASSES,
    *search.SCORING_CLASSES,
    *focus.CLASSES,
    *search.CLASSES,
    *mounts.CLASSES,
    *tolerance.CLASSES,
    *advanced.CLASSES,
    *overlay.CLASSES,
    *export.CLASSES,
)


def register() -> None:
    """Add icons, and what stands in headers and menus of Blender's own."""
    swatches.register()
    overlay.register()
    export.register()


def unregister() -> None:
    """Take them out again."""
    export.unregister()
    overlay.unregister()
    swatches.unregister()
