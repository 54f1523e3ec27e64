"""Operators: each reads the scene, calls the engine, and writes the result.

Panels take from here the operators, and what menus list.
"""

from ..bridge import after_of, holder_of, shown_state
from ..diagnostics import warnings_outdated
from ..live import (
    BETTER,
    SAME,
    WORSE,
    ShownScore,
    figure_rows,
    live_lines,
    nats_text,
    sense_icon,
    sense_of,
    shown_score,
    text_of,
)
from ..preferences import is_updated
from ..sensor_cache import sensors as listed_sensors
from ..sensor_kinds import kind_label
from . import (
    compare_variants,
    conditions,
    edit_sensors,
    exports,
    first_steps,
    inset,
    look_through,
    mounts,
    place_sensor,
    placement,
    running_job,
    shortcuts,
    upright,
    variants,
    whats_new,
)
from .add_sensor import Offer, brief, known_makers, makers, models, offers
from .declared import CLASSES
from .fix_warnings import FIX_LABELS
from .imports import known_rigs
from .jobs import costs_nothing
from .panel_rows import own_fields, reference_label
from .query_location import answer
from .requirements import ShownSource, ShownVerdict, shown_verdicts, source_of

__all__ = ["BETTER", "CLASSES", "FIX_LABELS", "SAME", "WORSE", "Offer", "ShownScore", "ShownSource"]
__all__ += ["ShownVerdict", "after_of", "answer", "brief", "compare_variants", "conditions"]
__all__ += ["costs_nothing", "edit_sensors", "exports", "figure_rows", "first_steps", "holder_of"]
__all__ += ["is_updated", "kind_label", "known_makers", "known_rigs", "listed_sensors"]
__all__ += ["live_lines", "look_through", "makers", "models", "mounts", "nats_text", "offers"]
__all__ += ["own_fields", "place_sensor", "reference_label", "register", "running_job"]
__all__ += ["sense_icon", "sense_of", "shown_score", "shown_state", "shown_verdicts", "source_of"]
__all__ += ["text_of", "unregister", "upright", "variants", "warnings_outdated", "whats_new"]


def register() -> None:
    """Add keys, draw handlers and listeners of operators."""
    shortcuts.register()
    inset.register()


def unregister() -> None:
    """End what is running, and what waits for the mouse; remove what `register` added."""
    running_job.unregister()
    placement.end()
    exports.unregister()
    inset.unregister()
    shortcuts.unregister()
