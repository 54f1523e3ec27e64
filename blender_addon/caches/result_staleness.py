"""Whether stored results are still those of the scene: its own result, and its variants.

Both are checked whenever the scene becomes idle. A score takes the vehicle as drawn, so showing
another state makes no result stale. What the scene is as drawn cannot be read while another state
is shown: going to that frame would lose a pose without a key. So the scene as drawn is remembered,
and counts until something changes in the state that is shown.
"""

from collections.abc import Sequence
from typing import NamedTuple

import bpy

from .. import document, signals
from . import sensor_cache, vehicle_cache


class LastDrawn(NamedTuple):
    """What a scene was when it was last shown as drawn; None: not since its file was opened.
    `states` are the fingerprints, by frame, of the states that were shown since."""

    fingerprint: document.Fingerprint | None
    states: dict[int, str]


_last_drawn: dict[str, LastDrawn] = {}


def clear(*_: object) -> None:
    """Forget all scenes: another file is opened."""
    _last_drawn.clear()


def fingerprint(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph | None = None,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> document.Fingerprint:
    """Return the fingerprint of what a score of the scene, as it is now, depends on."""
    shown = _fingerprint_shown(scene, depsgraph, sensors)
    return _as_drawn(scene, shown) or shown


def _fingerprint_shown(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph | None = None,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> document.Fingerprint:
    depsgraph = depsgraph or document.view_layer_of(scene).depsgraph
    # A scene that was not shown yet is not evaluated: its vehicle cannot be read.
    shape = "" if depsgraph is None else vehicle_cache.shared.digest(scene, depsgraph)
    found = sensor_cache.sensors(scene) if sensors is None else sensors
    return document.fingerprint(scene, shape, found)


def _as_drawn(scene: bpy.types.Scene, shown: document.Fingerprint) -> document.Fingerprint | None:
    """Return the fingerprint of a scene as drawn, from what it is as shown; None: unknown."""
    if not document.shown_state(scene):
        _last_drawn[scene.name] = LastDrawn(shown, {})
        return shown
    last = _last_drawn.setdefault(scene.name, LastDrawn(None, {}))
    if last.states.setdefault(scene.frame_current, shown.text) == shown.text:
        return last.fingerprint
    # Changed while this state is shown: equal to no result until the vehicle is shown as drawn.
    _last_drawn[scene.name] = LastDrawn(shown, {scene.frame_current: shown.text})
    return shown


def update_result() -> None:
    """Set `result_stale` of every scene that has a result; clear stale results of scenarios."""
    for scene in bpy.data.scenes:
        settings = scene.perception_entropy
        driven = any(row.result for row in settings.scenarios)
        if not (settings.has_result or driven) or document.view_layer_of(scene).depsgraph is None:
            continue
        now = _as_drawn(scene, _fingerprint_shown(scene))
        if now is None:  # a file that was saved with another state shown: its mark holds
            continue
        stale = settings.has_result and now.text != settings.result_signature
        changed = driven and document.clear_stale_scenarios(settings, now.text)
        if stale != settings.result_stale:
            settings.result_stale = stale
            changed = True
        if changed:
            signals.view_changed.emit()  # a timer that sets a property does not redraw panels


def update_variants() -> None:
    """Update the marks of stale variants and of unsaved changes in every scene."""
    for scene in bpy.data.scenes:
        if not scene.perception_entropy.variants or document.view_layer_of(scene).depsgraph is None:
            continue
        shown = _fingerprint_shown(scene)
        now = _as_drawn(scene, shown)
        # In another state sensors stand elsewhere than in the variant: nothing is to be marked.
        if now is not None and now.text == shown.text:
            document.check_variants(scene, now)
