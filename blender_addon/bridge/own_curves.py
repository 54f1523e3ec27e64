"""The AP curve that a sensor has of its own, on its object and in a variant's row."""

from __future__ import annotations

import bpy

from ..engine import pe
from .typed import as_typed


def curve_of(settings: bpy.types.PropertyGroup) -> pe.ApCurve | None:
    """Return the curve that is set on a sensor; None where it takes its kind's.

    Raises
    ------
    InputError
        When the numbers are no curve.
    """
    if not settings.own_curve:
        return None
    return pe.ApCurve(as_typed(settings.curve_a), as_typed(settings.curve_b))


def put_curve(settings: bpy.types.PropertyGroup, curve: pe.ApCurve | None) -> None:
    """Set a sensor's own curve, or that it has none; what stands already is not touched."""
    if curve is not None and (settings.curve_a, settings.curve_b) != (curve.a, curve.b):
        settings.curve_a, settings.curve_b = curve.a, curve.b
    if settings.own_curve != (curve is not None):
        settings.own_curve = curve is not None
