"""Whether stored results are still those of the scene: its own result, and its variants.

Both are checked whenever the scene becomes idle.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from . import bridge, sensor_cache, signals, vehicle_cache


def fingerprint(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph | None = None,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> bridge.Fingerprint:
    """Return the fingerprint of what a score of the scene, as it is now, depends on."""
    depsgraph = depsgraph or bridge.view_layer_of(scene).depsgraph
    # A scene that was not shown yet is not evaluated: its vehicle cannot be read.
    shape = "" if depsgraph is None else vehicle_cache.shared.digest(scene, depsgraph)
    found = sensor_cache.sensors(scene) if sensors is None else sensors
    return bridge.fingerprint(scene, shape, found)


def update_result() -> None:
    """Set `result_stale` of every scene that has a result."""
    for scene in bpy.data.scenes:
        settings = scene.perception_entropy
        if not settings.has_result or bridge.view_layer_of(scene).depsgraph is None:
            continue
        stale = fingerprint(scene).text != settings.result_signature
        if stale != settings.result_stale:
            settings.result_stale = stale
            signals.view_changed.emit()  # a timer that sets a property does not redraw panels


def update_variants() -> None:
    """Update the marks of stale variants and of unsaved changes in every scene."""
    for scene in bpy.data.scenes:
        if scene.perception_entropy.variants and bridge.view_layer_of(scene).depsgraph is not None:
            bridge.check_variants(scene, fingerprint(scene))
