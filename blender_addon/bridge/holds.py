"""What Blender itself holds a sensor by: locks of its coordinates, and Limit constraints."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..engine import pe, search
from .advanced import Limits
from .typed import as_typed

LOCATION, ROTATION = "LIMIT_LOCATION", "LIMIT_ROTATION"
CALLED = dict(zip(search.AXES, ("X", "Y", "Z", "Roll", "Pitch", "Yaw"), strict=True))


def locked_axes(obj: bpy.types.Object) -> tuple[str, ...]:
    """Axes of a sensor that are locked; an own frame's, of one that has a parent."""
    locks = (*obj.lock_location, *obj.lock_rotation)
    return tuple(axis for axis, lock in zip(search.AXES, locks, strict=True) if lock)


def free_axes(obj: bpy.types.Object) -> tuple[str, ...]:
    """Axes of a sensor that the search may change: those that are chosen and not locked."""
    chosen, locked = obj.perception_entropy.free, locked_axes(obj)
    pairs = zip(search.AXES, chosen, strict=True)
    return tuple(axis for axis, free in pairs if free and axis not in locked)


def constrained(
    obj: bpy.types.Object, sensor: pe.Sensor, vehicle: pe.Vehicle | None, own: Limits
) -> Limits:
    """Return a sensor's bounds, `own` ones and those of its Limit constraints together.

    Raises
    ------
    InputError
        When they leave nothing between them.
    """
    usual = search.default_bounds(sensor, vehicle)
    found = dict(own)
    for axis, low, high in _limits(obj):
        least, most = found.get(axis, usual[axis])
        least, most = least if low is None else low, most if high is None else high
        if axis in found:
            least, most = max(least, found[axis][0]), min(most, found[axis][1])
        if least > most:
            expected = "bounds and constraints that leave something between them"
            field = f"sensor {obj.name!r}: {CALLED[axis]}"
            raise pe.InputError("scene", field, expected, f"{least:g} to {most:g}")
        found[axis] = (least, most)
    return {axis: found[axis] for axis in search.AXES if axis in found}


def _limits(obj: bpy.types.Object) -> Iterable[tuple[str, float | None, float | None]]:
    """Yield axes with the ends that Limit constraints give them; None for an end that is open."""
    for each in obj.constraints:
        if not each.enabled or each.influence <= 0.0 or not _is_of_ground(obj, each):
            continue
        if each.type == LOCATION:
            ends = [(f"use_min_{a}", f"use_max_{a}") for a in "xyz"]
        elif each.type == ROTATION:
            ends = [(f"use_limit_{a}", f"use_limit_{a}") for a in "xyz"]
        else:
            continue
        axes = search.AXES[:3] if each.type == LOCATION else search.AXES[3:]
        for axis, a, (has_low, has_high) in zip(axes, "xyz", ends, strict=True):
            low = as_typed(getattr(each, f"min_{a}")) if getattr(each, has_low) else None
            high = as_typed(getattr(each, f"max_{a}")) if getattr(each, has_high) else None
            if low is not None or high is not None:
                yield axis, low, high


def _is_of_ground(obj: bpy.types.Object, constraint: bpy.types.Constraint) -> bool:
    """Whether a constraint's figures are the ground frame's, not those of a frame of its own."""
    return constraint.owner_space == "WORLD" or (
        constraint.owner_space == "LOCAL" and obj.parent is None
    )
