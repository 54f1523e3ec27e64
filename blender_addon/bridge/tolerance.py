"""Mounting errors and failures that a scene's search reckons with."""

from __future__ import annotations

import math

import bpy

from ..engine import pe
from .typed import as_typed


def tolerance_of(settings: bpy.types.PropertyGroup) -> pe.Tolerance:
    """Return what a scene's settings say; "worst" is only heard where there are several cases."""
    on = settings.mounting_errors
    position = as_typed(settings.tolerance_position) if on else 0.0
    angle = math.radians(as_typed(settings.tolerance_angle)) if on else 0.0
    several = position > 0.0 or angle > 0.0 or settings.failures
    worst = settings.worst and several
    return pe.Tolerance(position, angle, failures=settings.failures, worst=worst)
