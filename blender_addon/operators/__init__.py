"""Operators: each reads the scene, calls the engine, and writes the result.

Panels take from here the operators, and what menus list.
"""

from . import (
    built,
    compare_variants,
    conditions,
    edit_sensors,
    exports,
    first_steps,
    handles,
    known_rigs,
    look_through,
    modes,
    mounts,
    named_edges,
    named_places,
    panel_rows,
    place_sensor,
    placement,
    region,
    running_job,
    shortcuts,
    steepest_way,
    suggest,
    surroundings,
    upright,
    variants,
    verify_engine,
    view_pictures,
    where,
)
from .add_sensor import Offer, models, offers
from .declared import CLASSES
from .fix_warnings import FIX_LABELS
from .imports import menu_of_rigs
from .requirements import ShownVerdict, shown_verdicts
from .rows import ROW_LISTS
from .steepest_way import shown_way


def register() -> None:
    """Add keys, draw handlers and listeners of operators."""
    shortcuts.register()
    view_pictures.register()


def unregister() -> None:
    """End what is running, and what waits for the mouse; remove what `register` added."""
    running_job.unregister()
    placement.end()
    modes.end()
    exports.unregister()
    view_pictures.unregister()
    shortcuts.unregister()
