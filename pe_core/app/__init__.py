"""The command ``pe``, and what all command lines share."""

from .command import (
    BAD_INPUT,
    DONE,
    INTERRUPTED,
    USAGE,
    Answer,
    add_run_options,
    add_sensors_verb,
    answer,
    drive,
    run,
    with_options,
)

__all__ = [
    "BAD_INPUT",
    "DONE",
    "INTERRUPTED",
    "USAGE",
    "Answer",
    "add_run_options",
    "add_sensors_verb",
    "answer",
    "drive",
    "run",
    "with_options",
]
