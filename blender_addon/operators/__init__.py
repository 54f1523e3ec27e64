"""Operators: what can be pressed. Each reads the scene, calls the engine, writes the result.

Panels take from here what there is to press and to choose from.
"""

from . import (
    add_sensor,
    ask_place,
    comparing,
    export,
    focus,
    job,
    known_rigs,
    mending,
    review,
    running,
    select,
    variants,
)
from .ask_place import answer
from .known_rigs import rigs
from .mending import LABELS as FIX_LABELS
from .mounting import Offer, offers
from .select import listed_sensors

__all__ = [
    "CLASSES",
    "FIX_LABELS",
    "Offer",
    "answer",
    "listed_sensors",
    "offers",
    "rigs",
    "running",
]

CLASSES = (
    *add_sensor.CLASSES,
    *select.CLASSES,
    *focus.CLASSES,
    *job.CLASSES,
    *export.CLASSES,
    *review.CLASSES,
    *variants.CLASSES,
    *comparing.CLASSES,
    *known_rigs.CLASSES,
    *mending.CLASSES,
    *ask_place.CLASSES,
)
