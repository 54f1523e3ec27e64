"""Operators: what can be pressed. Each reads the scene, calls the engine, writes the result.

Panels take from here what there is to press and to choose from.
"""

from . import add_sensor, comparing, export, focus, job, review, running, select, variants
from .mounting import Offer, offers
from .select import listed_sensors

__all__ = ["CLASSES", "Offer", "listed_sensors", "offers", "running"]

CLASSES = (
    *add_sensor.CLASSES,
    *select.CLASSES,
    *focus.CLASSES,
    *job.CLASSES,
    *export.CLASSES,
    *review.CLASSES,
    *variants.CLASSES,
    *comparing.CLASSES,
)
