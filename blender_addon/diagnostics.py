"""Warnings about the scene, and a score explained in words: both by the engine's process.

Checks run some time after the scene became idle, so that they do not slow down further moves. How
far a rig sees is computed after a score.
"""

from __future__ import annotations

import bpy

from . import analysis_calls, bridge, engine_process, sensor_cache, signals, vehicle_cache, viewport
from .engine import advice, jobs, pe

IDLE_DELAY_S = 1.0
"""How long the scene has to be idle until the checks run."""
WARNINGS, EXPLANATION = "warnings", "words"
"""Topics of requests."""


_outdated = False
"""Whether something has moved since the warnings were found."""


def warnings_outdated() -> bool:
    """Whether the shown warnings are of before the last move."""
    return _outdated


def schedule_checks() -> None:
    """Run the checks after a delay, if nothing moves until then."""
    _mark_outdated(True)
    if not bpy.app.background and not bpy.app.timers.is_registered(run_checks):
        bpy.app.timers.register(run_checks, first_interval=IDLE_DELAY_S)


def postpone_checks() -> None:
    """Something moves: do not run the checks yet."""
    _mark_outdated(True)
    if bpy.app.timers.is_registered(run_checks):
        bpy.app.timers.unregister(run_checks)


def run_checks() -> None:
    """Check the open scene in the background; store the warnings in its settings."""
    scene = bpy.context.scene
    if not bridge.sensor_objects(scene) and scene.perception_entropy.vehicle is None:
        _mark_outdated(False)
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    own, name = bridge.scene_advice(scene), scene.name
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    sensors = bridge.possible_sensors(sensor_cache.sensors(scene), depsgraph)
    try:
        space = bridge.space_of(scene.perception_entropy)
    except pe.InputError:  # a score reports it
        space = pe.PerceptionSpace()

    def deliver(found: tuple[str, tuple[advice.Advice, ...]]) -> None:
        if name in bpy.data.scenes:
            line, warnings = found
            settings = bpy.data.scenes[name].perception_entropy
            bridge.store_warnings(settings, (*own, *warnings))
            if settings.vehicle_line != line:
                settings.vehicle_line = line
            _mark_outdated(not bpy.app.background and bpy.app.timers.is_registered(run_checks))
            signals.view_changed.emit()

    given = sensors, vehicle, space
    engine_process.ask(WARNINGS, analysis_calls.warnings, given, deliver, lambda _: None)


def _mark_outdated(behind: bool) -> None:
    """Note whether warnings are of before a move, and redraw the panels that show it."""
    global _outdated
    if behind != _outdated and not bpy.app.background:
        _outdated = behind
        viewport.redraw_editors()


def explain_score(scene: bpy.types.Scene, outcome: jobs.Outcome, signature: str) -> None:
    """Explain a result in words, in the background; do nothing without a window."""
    if bpy.app.background:
        return
    study, score, name = outcome.study, outcome.after, scene.name

    def deliver(seen: advice.Outlook) -> None:
        scene = bpy.data.scenes.get(name)
        if scene is not None and scene.perception_entropy.result_signature == signature:
            bridge.store_text(scene, study, score, seen)
            signals.view_changed.emit()

    engine_process.ask(EXPLANATION, analysis_calls.outlook, (study,), deliver, lambda _: None)
