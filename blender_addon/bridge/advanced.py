"""What a study holds besides sensors, vehicle and prior: space, AP curves, bounds of the search."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy

from ..engine import kinds, pe, search
from .typed import as_typed, pair_as_typed

Limits = dict[str, tuple[float, float]]
"""Bounds by axis [m or rad]."""


def space_of(settings: bpy.types.PropertyGroup) -> pe.PerceptionSpace:
    """Return the space that a scene's settings say.

    Raises
    ------
    InputError
        When a bound is not below the other, or the voxels do not fit.
    """
    x, y, z = (pair_as_typed(getattr(settings, f"space_{axis}")) for axis in "xyz")
    try:
        return pe.PerceptionSpace(x, y, z, as_typed(settings.space_interval))
    except pe.InputError as error:
        raise pe.InputError("scene", f"space: {error.field}", error.expected, error.found) from None


def perception_of(settings: bpy.types.PropertyGroup) -> pe.PerceptionModel:
    """Return the AP curves that a scene's settings say; a kind's own where they say none."""
    own = {
        row.name: pe.ApCurve(as_typed(row.a), as_typed(row.b))
        for row in settings.curves
        if row.own and row.name in kinds.KINDS
    }
    return pe.PerceptionModel(**own)


def clearance_of(scene: bpy.types.Scene) -> float:
    """Return how proud of the skin a flush-mounted sensor counts [m]."""
    return as_typed(scene.perception_entropy.clearance)


def limits_of(obj: bpy.types.Object) -> Limits:
    """Return the bounds of a sensor's axes that are its own."""
    settings = obj.perception_entropy
    return bounds_as_limits(settings.bounded, settings.bounds_low, settings.bounds_high)


def bounds_as_limits(
    bounded: Sequence[bool], low: Sequence[float], high: Sequence[float]
) -> Limits:
    """Return bounds by axis, of those that have some; angles come in degrees."""
    found = {}
    for n, axis in enumerate(search.AXES):
        if bounded[n]:
            bounds = pair_as_typed((low[n], high[n]))
            angle = axis not in ("x", "y", "z")
            found[axis] = tuple(map(math.radians, bounds)) if angle else bounds
    return found


def all_limits(objects: Sequence[bpy.types.Object]) -> dict[str, Limits]:
    """Return the bounds of several sensors by name, of those that have some."""
    limits = {obj.name: limits_of(obj) for obj in objects}
    return {name: own for name, own in limits.items() if own}


def advanced_signature(settings: bpy.types.PropertyGroup) -> list[object]:
    """Return what of it a score depends on, where it is not as usual; also where impossible."""
    names = ("space_x", "space_y", "space_z", "space_interval", "clearance")
    said = [name for name in names if settings.is_property_set(name)]
    values = [getattr(settings, name) for name in said]
    curves = [(row.name, as_typed(row.a), as_typed(row.b)) for row in settings.curves if row.own]
    return [*zip(said, map(_plain, values), strict=True), *curves]


def _plain(value: object) -> object:
    return as_typed(value) if isinstance(value, float) else pair_as_typed(value)
