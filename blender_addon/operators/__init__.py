"""Operators: what can be pressed. Each reads the scene, calls the engine, writes the result.

Panels take from here what there is to press and to choose from.
"""

from ..explaining import is_behind as warnings_are_behind
from ..live import ShownScore, live_lines, shown_score
from . import (
    add_sensor,
    apply_scale,
    ask_place,
    axles,
    comparing,
    exchange,
    export,
    export_scene,
    exporting,
    fix_colors,
    focus,
    inset,
    job,
    known_rigs,
    live_reference,
    look,
    mending,
    mirror_sensor,
    mounts,
    own_sensors,
    place_sensor,
    placing,
    plain_objects,
    review,
    running,
    search_sensor,
    select,
    selection,
    upright,
    variants,
)
from .ask_place import answer
from .known_rigs import rigs
from .live_reference import reference_label
from .mending import LABELS as FIX_LABELS
from .offered import SENSOR_COLORS, Offer, brief, held_by, makers, models, offers
from .select import listed_sensors

__all__ = [
    "CLASSES",
    "FIX_LABELS",
    "SENSOR_COLORS",
    "Offer",
    "ShownScore",
    "answer",
    "brief",
    "exporting",
    "held_by",
    "listed_sensors",
    "live_lines",
    "makers",
    "models",
    "offers",
    "reference_label",
    "register",
    "rigs",
    "running",
    "shown_score",
    "unregister",
    "warnings_are_behind",
]

CLASSES = (
    *add_sensor.CLASSES,
    *place_sensor.CLASSES,
    *search_sensor.CLASSES,
    *mirror_sensor.CLASSES,
    *mounts.CLASSES,
    *own_sensors.CLASSES,
    *apply_scale.CLASSES,
    *look.CLASSES,
    *upright.CLASSES,
    *select.CLASSES,
    *focus.CLASSES,
    *fix_colors.CLASSES,
    *job.CLASSES,
    *selection.CLASSES,
    *exporting.CLASSES,
    *export.CLASSES,
    *exchange.CLASSES,
    *plain_objects.CLASSES,
    *export_scene.CLASSES,
    *axles.CLASSES,
    *review.CLASSES,
    *variants.CLASSES,
    *comparing.CLASSES,
    *known_rigs.CLASSES,
    *live_reference.CLASSES,
    *mending.CLASSES,
    *ask_place.CLASSES,
)


def register() -> None:
    """Have Esc come back from looking through a sensor, and dropped sensors stand."""
    look.register()
    upright.register()
    inset.register()


def unregister() -> None:
    """Let go of what runs, and of what waits for the mouse."""
    running.unregister()
    placing.end()
    exporting.unregister()
    inset.unregister()
    upright.unregister()
    look.unregister()
