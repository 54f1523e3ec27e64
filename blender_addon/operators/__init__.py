"""Operators: what can be pressed. Each reads the scene, calls the engine, writes the result."""

from . import add_sensor, export, focus, job, review, select

CLASSES = (
    *add_sensor.CLASSES,
    *select.CLASSES,
    *focus.CLASSES,
    *job.CLASSES,
    *export.CLASSES,
    *review.CLASSES,
)
