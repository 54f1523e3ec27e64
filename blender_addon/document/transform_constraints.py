"""Blender's own restrictions of a sensor's pose: locks, constraints, animations and drivers.

A lock fixes an axis in a search. An animation, a driver or a constraint defines the sensor's pose,
so that a search of that sensor is impossible.
"""

from collections.abc import Collection, Iterator
from typing import cast

import bpy
from bpy.types import Object, PropertyGroup

from ..engine import search
from .study_table import value_at

AXIS_LABELS = dict(zip(search.AXES, ("X", "Y", "Z", "Roll", "Pitch", "Yaw"), strict=True))
PLACING = ("location", "rotation", "delta_location", "delta_rotation")
"""First parts of the data paths that place an object."""


def locked_axes(obj: Object) -> tuple[str, ...]:
    """Return the locked axes of a sensor, in its parent's frame if it has a parent."""
    locks = (*obj.lock_location, *obj.lock_rotation)
    return tuple(axis for axis, lock in zip(search.AXES, locks, strict=True) if lock)


def free_axes(obj: Object) -> tuple[str, ...]:
    """Return the axes that the search may change: those that are ticked and not locked."""
    return unlocked_axes(ticked_axes(obj.perception_entropy), locked_axes(obj))


def ticked_axes(settings: PropertyGroup) -> Collection[str]:
    """Return the axes of a sensor's table that a search may change."""
    axes: Collection[str] = value_at(settings.table, ("free",), search.PAPER_FREE)
    return axes


def unlocked_axes(free: Collection[str], locked: Collection[str]) -> tuple[str, ...]:
    """Return the names of the axes that are free and not locked, in their order."""
    return tuple(axis for axis in search.AXES if axis in free and axis not in locked)


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
        if constraint.enabled and constraint.influence > 0.0:
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
