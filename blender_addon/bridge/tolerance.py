"""Mounting errors and failures: what a scene's search reckons with, and what they cost."""

from __future__ import annotations

import math

import bpy

from ..engine import advice, pe
from .typed import as_typed


def tolerance_of(settings: bpy.types.PropertyGroup) -> pe.Tolerance:
    """Return what a scene's settings say; "worst" is only heard where there are several cases."""
    on = settings.mounting_errors
    position = as_typed(settings.tolerance_position) if on else 0.0
    angle = math.radians(as_typed(settings.tolerance_angle)) if on else 0.0
    several = position > 0.0 or angle > 0.0 or settings.failures
    worst = settings.worst and several
    return pe.Tolerance(position, angle, failures=settings.failures, worst=worst)


def store_robustness(settings: bpy.types.PropertyGroup, outcome: pe.Outcome) -> None:
    """Keep how far the entropy of a search's start and end moves; nothing of a score."""
    found = outcome.robustness
    off = lost = ""
    if found is not None:
        off = _told(found.before.rise, found.after.rise)
        lost = _told(found.before.loss, found.after.loss)
    settings.result_mounted_off, settings.result_sensor_lost = off, lost
    fragile = (each.text for each in outcome.warnings if each.code == advice.FRAGILE)
    settings.result_fragile = next(fragile, "")


def _told(before: float | None, after: float | None) -> str:
    if before is None or after is None:
        return ""
    return f"{before:+.3f} \N{RIGHTWARDS ARROW} {after:+.3f} nats"
