"""Whether a search can place the sensors: told before it begins, not at its end."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..engine import pe
from .mirroring import mirror_of
from .rig import free_axes

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
        one that has free axes: the placement would be lost at the next frame.
    """
    sensors = [scene.objects[sensor.name] for sensor in study.rig]
    free = [obj for obj in sensors if free_axes(obj)]
    if not free:
        expected = "X, Y, Z, Roll, Pitch or Yaw ticked of at least one sensor (panel Sensor)"
        raise pe.InputError("scene", "what the search may change", expected, "nothing")
    for obj in free:
        if (other := mirror_of(obj, scene)) is not None:
            expected = "one that is not linked to its mirror image, as each is moved on its own"
            raise pe.InputError(
                "scene", f"sensor {obj.name!r}", expected, f"linked to {other.name}"
            )
        for holder in _holders(obj):
            expected = "an object that can be placed"
            raise pe.InputError("scene", f"sensor {obj.name!r}: placement", expected, holder)


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
