"""Whether a search can place the sensors: told before it begins, not at its end."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..engine import pe
from .holds import CALLED, free_axes, locked_axes
from .mounting import followers_of

PLACING = ("location", "rotation", "delta_location", "delta_rotation")
"""How the paths of properties begin that say where an object stands."""
BOUNDING = "LIMIT_"
"""How the types of constraints begin that hold an object only outside their bounds."""


def check_placeable(scene: bpy.types.Scene, study: pe.Study) -> None:
    """Complain about a rig of which nothing may be moved, or that something else moves.

    Raises
    ------
    InputError
        When no axis of the study's sensors is free, or an animation, a driver or a constraint holds
        one that is moved: the placement would be lost at the next frame. When one that is to move
        on a mount is locked.
    """
    mounting = study.search.mounting
    sensors = [scene.objects[sensor.name] for sensor in study.rig]
    follow = followers_of(mounting.pairs, mounting.groups)
    leading = [obj for obj in sensors if obj.name not in follow]
    free = [obj for obj in leading if free_axes(obj) or obj.name in mounting.on]
    if not free:
        expected = "X, Y, Z, Roll, Pitch or Yaw ticked of at least one sensor (panel Sensor)"
        raise pe.InputError("scene", "what the search may change", expected, "nothing")
    for obj in leading:
        _check_locks(obj, mounting)
    for obj in (*free, *(scene.objects[name] for name in sorted(follow))):
        for holder in _holders(obj):
            expected = "an object that can be placed"
            raise pe.InputError("scene", f"sensor {obj.name!r}: placement", expected, holder)


def _check_locks(obj: bpy.types.Object, mounting: pe.Mounting) -> None:
    """Complain of a lock that a mount takes no notice of: on a surface, a place is found as one."""
    mount, locked = mounting.mount_of(obj.name), locked_axes(obj)
    if isinstance(mount, pe.SurfaceMount):
        locked = tuple(axis for axis in locked if axis in "xyz")
    if mount is not None and locked:
        expected = "no lock of what its mount moves (bounds are kept to)"
        found = f"a lock of {', '.join(CALLED[axis] for axis in locked)}"
        raise pe.InputError("scene", f"sensor {obj.name!r}", expected, found)


def holder_of(obj: bpy.types.Object) -> str:
    """Name what decides where an object stands, in its own stead; empty for one that is free."""
    if obj.library is not None:
        return f"the file that it is linked from, {obj.library.name}"
    return next(_holders(obj), "")


def _holders(obj: bpy.types.Object) -> Iterator[str]:
    """Name what decides where an object stands, besides its own location and rotation."""
    for path in _animated(obj):
        if path.startswith(PLACING):
            yield f"an animation or a driver of its {path}"
    for each in obj.constraints:
        if each.enabled and each.influence > 0.0 and not each.type.startswith(BOUNDING):
            yield f"a constraint that holds it, {each.name!r}"


def _animated(obj: bpy.types.Object) -> Iterator[str]:
    """Paths of an object's properties that curves or drivers set."""
    data = obj.animation_data
    if data is None:
        return
    strips = (strip.action for track in data.nla_tracks for strip in track.strips)
    for action in filter(None, (data.action, *strips)):
        yield from (curve.data_path for curve in _curves(action))
    yield from (driver.data_path for driver in data.drivers)


def _curves(action: bpy.types.Action) -> Iterator[bpy.types.FCurve]:
    """Curves of an action, in layers since Blender 4.4."""
    if not hasattr(action, "layers"):
        yield from action.fcurves
        return
    for layer in action.layers:
        for strip in layer.strips:
            for bag in strip.channelbags:
                yield from bag.fcurves
