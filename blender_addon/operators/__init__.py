"""Operators: each reads the scene, calls the engine, and writes the result.

Panels take from here the operators, and what menus list.
"""

from ..bridge import after_of, shown_state
from ..diagnostics import warnings_outdated
from ..live import (
    BETTER,
    SAME,
    WORSE,
    ShownScore,
    live_lines,
    nats_text,
    sense_icon,
    sense_of,
    shown_score,
    text_of,
)
from ..sensor_kinds import kind_label
from . import (
    add_sensor,
    body_mesh,
    compare_variants,
    conditions,
    edit_sensors,
    export_files,
    export_job,
    first_steps,
    fix_warnings,
    inset,
    look_through,
    mounts,
    panel_rows,
    place_sensor,
    placement,
    query_location,
    replace_sensors,
    requirements,
    rig_files,
    running_job,
    score_jobs,
    shortcuts,
    upright,
    variants,
)
from .add_sensor import (
    Offer,
    brief,
    holder_of,
    known_makers,
    makers,
    models,
    offers,
)
from .edit_sensors import listed_sensors
from .fix_warnings import FIX_LABELS
from .panel_rows import own_fields, reference_label
from .query_location import answer
from .replace_sensors import known_rigs
from .requirements import ShownSource, ShownVerdict, shown_verdicts, source_of
from .score_jobs import costs_nothing

__all__ = [
    "BETTER",
    "CLASSES",
    "FIX_LABELS",
    "SAME",
    "WORSE",
    "Offer",
    "ShownScore",
    "ShownSource",
    "ShownVerdict",
    "after_of",
    "answer",
    "brief",
    "costs_nothing",
    "export_job",
    "holder_of",
    "kind_label",
    "known_makers",
    "known_rigs",
    "listed_sensors",
    "live_lines",
    "makers",
    "models",
    "nats_text",
    "offers",
    "own_fields",
    "reference_label",
    "register",
    "running_job",
    "sense_icon",
    "sense_of",
    "shown_score",
    "shown_state",
    "shown_verdicts",
    "source_of",
    "text_of",
    "unregister",
    "warnings_outdated",
]

CLASSES = (
    *first_steps.CLASSES,
    *add_sensor.CLASSES,
    *place_sensor.CLASSES,
    *edit_sensors.CLASSES,
    *mounts.CLASSES,
    *panel_rows.CLASSES,
    *requirements.CLASSES,
    *body_mesh.CLASSES,
    *conditions.CLASSES,
    *look_through.CLASSES,
    *upright.CLASSES,
    *score_jobs.CLASSES,
    *export_job.CLASSES,
    *export_files.CLASSES,
    *rig_files.CLASSES,
    *replace_sensors.CLASSES,
    *variants.CLASSES,
    *compare_variants.CLASSES,
    *fix_warnings.CLASSES,
    *query_location.CLASSES,
)


def register() -> None:
    """Add keys, draw handlers and listeners of operators."""
    shortcuts.register()
    inset.register()


def unregister() -> None:
    """End what is running, and what waits for the mouse; remove what `register` added."""
    running_job.unregister()
    placement.end()
    export_job.unregister()
    inset.unregister()
    shortcuts.unregister()
