"""Blender's own restrictions of a sensor's pose: locks, constraints, animations and drivers.

Locks and Limit constraints narrow the bounds of a search. An animation, a driver or another
constraint defines the sensor's pose, so that a search of that sensor is impossible.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple, cast

import bpy
from bpy.types import Object

from ..engine import pe, search
from .scene_settings import as_typed

LOCATION, ROTATION = "LIMIT_LOCATION", "LIMIT_ROTATION"
AXIS_LABELS = dict(zip(search.AXES, ("X", "Y", "Z", "Roll", "Pitch", "Yaw"), strict=True))
Limits = dict[str, tuple[float, float]]
"""Bounds by axis [m or rad]."""
PLACING = ("location", "rotation", "delta_location", "delta_rotation")
"""First parts of the data paths that place an object."""
BOUNDING = "LIMIT_"
"""First part of the types of constraints that hold an object only outside their limits."""


class AxisLimit(NamedTuple):
    """The range of one axis by a Limit constraint [m or rad]; None for an open end."""

    axis: str
    low: float | None
    high: float | None


def locked_axes(obj: Object) -> tuple[str, ...]:
    """Return the locked axes of a sensor, in its parent's frame if it has a parent."""
    locks = (*obj.lock_location, *obj.lock_rotation)
    return tuple(axis for axis, lock in zip(search.AXES, locks, strict=True) if lock)


def free_axes(obj: Object) -> tuple[str, ...]:
    """Return the axes that the search may change: those that are ticked and not locked."""
    return unlocked_axes(obj.perception_entropy.free, locked_axes(obj))


def unlocked_axes(free: Iterable[bool], locked: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the axes that are ticked, without the locked ones."""
    pairs = zip(search.AXES, free, strict=True)
    return tuple(axis for axis, ticked in pairs if ticked and axis not in locked)


def limit_constraints(obj: Object) -> tuple[AxisLimit, ...]:
    """Return the limits that an object's enabled Limit constraints set in the ground frame."""
    return tuple(_axis_limits(obj))


def search_bounds(
    sensor: pe.Sensor, vehicle: pe.Vehicle | None, bounds: Limits, constraints: Iterable[AxisLimit]
) -> Limits:
    """Return the bounds of a sensor: the typed bounds intersected with its Limit constraints.

    `InputError` when the intersection is empty.
    """
    default = search.default_bounds(sensor, vehicle)
    limits = dict(bounds)
    for axis, constraint_low, constraint_high in constraints:
        low, high = limits.get(axis, default[axis])
        low = low if constraint_low is None else constraint_low
        high = high if constraint_high is None else constraint_high
        if axis in limits:
            low, high = max(low, limits[axis][0]), min(high, limits[axis][1])
        if low > high:
            expected = "bounds and constraints that leave something between them"
            field = f"sensor {sensor.name!r}: {AXIS_LABELS[axis]}"
            raise pe.InputError("scene", field, expected, f"{low:g} to {high:g}")
        limits[axis] = (low, high)
    return {axis: limits[axis] for axis in search.AXES if axis in limits}


def _axis_limits(obj: Object) -> Iterator[AxisLimit]:
    for constraint in obj.constraints:
        if not constraint.enabled or constraint.influence <= 0.0:
            continue
        if not _is_in_ground_frame(obj, constraint):
            continue
        if constraint.type == LOCATION:
            axes, switches = search.AXES[:3], [(f"use_min_{a}", f"use_max_{a}") for a in "xyz"]
        elif constraint.type == ROTATION:
            axes, switches = search.AXES[3:], [(f"use_limit_{a}",) * 2 for a in "xyz"]
        else:
            continue
        for axis, a, (has_low, has_high) in zip(axes, "xyz", switches, strict=True):
            low = (
                as_typed(getattr(constraint, f"min_{a}")) if getattr(constraint, has_low) else None
            )
            high = (
                as_typed(getattr(constraint, f"max_{a}")) if getattr(constraint, has_high) else None
            )
            if low is not None or high is not None:
                yield AxisLimit(axis, low, high)


def _is_in_ground_frame(obj: Object, constraint: bpy.types.Constraint) -> bool:
    """Return whether a constraint limits coordinates of the ground frame, not of its own one."""
    return constraint.owner_space == "WORLD" or (
        constraint.owner_space == "LOCAL" and obj.parent is None
    )


def holder_of(obj: Object) -> str:
    """Return a text that names what overrides an object's transform; "" for nothing."""
    if obj.library is not None:
        return f"the file that it is linked from, {obj.library.name}"
    return next(holders(obj), "")


def holders(obj: Object) -> Iterator[str]:
    """Yield a text for everything that places an object besides its location and rotation."""
    for path in _animated(obj):
        if path.startswith(PLACING):
            yield f"an animation or a driver of its {path}"
    for constraint in obj.constraints:
        if (
            constraint.enabled
            and constraint.influence > 0.0
            and not constraint.type.startswith(BOUNDING)
        ):
            yield f"a constraint that holds it, {constraint.name!r}"


def _animated(obj: Object) -> Iterator[str]:
    """Yield the data paths of an object that curves or drivers set."""
    data = obj.animation_data
    if data is None:
        return
    strips = (strip.action for track in data.nla_tracks for strip in track.strips)
    for action in filter(None, (data.action, *strips)):
        yield from (curve.data_path for curve in _curves(action))
    yield from (driver.data_path for driver in data.drivers)


def _curves(action: bpy.types.Action) -> Iterator[bpy.types.FCurve]:
    """Yield the curves of an action; Blender 4.4 and later have them in layers."""
    if not hasattr(action, "layers"):
        yield from action.fcurves
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in cast(bpy.types.ActionKeyframeStrip, strip).channelbags:
                yield from bag.fcurves
