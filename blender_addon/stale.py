"""Tells when a stored result no longer is that of the scene: whenever what has moved rests."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from . import body, bridge, changes, roster


def fingerprint(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph | None = None,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> bridge.Fingerprint:
    """Return what a score of the scene, as it is now, would depend on."""
    depsgraph = depsgraph or bridge.view_layer_of(scene).depsgraph
    # A scene that was not shown yet has not been evaluated: there is no vehicle to be read.
    shape = "" if depsgraph is None else body.shared.shape(scene, depsgraph)
    found = roster.sensors(scene) if sensors is None else sensors
    return bridge.fingerprint(scene, shape, found)


def check() -> None:
    """Set `result_stale` of every scene."""
    for scene in bpy.data.scenes:
        settings = scene.perception_entropy
        if not settings.has_result or bridge.view_layer_of(scene).depsgraph is None:
            continue
        stale = fingerprint(scene).text != settings.result_signature
        if stale != settings.result_stale:
            settings.result_stale = stale
            changes.picture.tell()  # a panel is not drawn anew by what a timer sets


def register() -> None:
    """Start listening."""
    changes.rested.connect(check)


def unregister() -> None:
    """Stop listening."""
    changes.rested.disconnect(check)
