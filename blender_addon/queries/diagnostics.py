"""Warnings about the scene, and a score explained in words: both by the engine's process.

Checks run some time after the scene became idle, so that they do not slow down further moves. How
far a rig sees is computed after a score, and after a file with a result was opened. Words are of
this session: a file keeps the figures.
"""

import json
from collections.abc import Sequence
from typing import NamedTuple

import bpy

from .. import document, signals
from ..caches import sensor_cache, vehicle_cache
from ..engine import advice, geometry, jobs, pe
from ..processes import analysis_calls, engine_process

IDLE_DELAY_S = 1.0  # How long the scene has to be idle until the checks run
WARNINGS = "warnings"
VEHICLE_LINE = "vehicle in a line"
EXPLANATION = "words"
"""Topics of requests."""


class Explanation(NamedTuple):
    """A result in words, of the rig and of the search; and a row of a table for each sensor."""

    signature: str
    rig: tuple[str, ...]
    search: tuple[str, ...]
    rows: dict[str, advice.SensorRow]


_explained: dict[str, Explanation] = {}
_vehicle_lines: dict[str, str] = {}
"""What is known of the scenes' results, and of their vehicles in a line; by the scene's name."""


def clear(*_: object) -> None:
    """Another file is opened."""
    _explained.clear()
    _vehicle_lines.clear()


def vehicle_line(scene: bpy.types.Scene) -> str:
    """Return the scene's vehicle in a line; empty until it was checked."""
    return _vehicle_lines.get(scene.name, "")


def explanation(scene: bpy.types.Scene) -> Explanation | None:
    """Return the words of the scene's result; None until they are known."""
    found = _explained.get(scene.name)
    signature = scene.perception_entropy.result_signature
    return found if found is not None and found.signature == signature else None


def schedule_checks() -> None:
    """Run the checks after a delay, if nothing moves until then."""
    if not bpy.app.background and not bpy.app.timers.is_registered(run_checks):
        bpy.app.timers.register(run_checks, first_interval=IDLE_DELAY_S)


def postpone_checks() -> None:
    """Something moves: do not run the checks yet."""
    if bpy.app.timers.is_registered(run_checks):
        bpy.app.timers.unregister(run_checks)


def run_checks() -> None:
    """Check the open scene in the background; store the warnings in its settings."""
    scene = bpy.context.scene
    if not document.sensor_objects(scene) and scene.perception_entropy.vehicle is None:
        return
    depsgraph = bpy.context.evaluated_depsgraph_get()
    own = document.scene_advice(scene)
    name = scene.name
    vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
    sensors = document.possible_sensors(sensor_cache.sensors(scene), depsgraph)
    try:
        space = document.document_of(scene.perception_entropy, "space").space
    except pe.InputError:  # a score reports it
        space = pe.PerceptionSpace()

    def deliver(warnings: tuple[advice.Advice, ...]) -> None:
        if name in bpy.data.scenes:
            settings = bpy.data.scenes[name].perception_entropy
            found_now = (*own, *warnings)
            kept = warnings_of_result(settings, found_now)
            document.store_warnings(settings, (*found_now, *kept))
            signals.view_changed.emit()

    _describe_vehicle(name, vehicle)
    given = sensors, vehicle, space
    engine_process.ask(WARNINGS, analysis_calls.warnings, given, deliver, fail=lambda _: None)
    _explain_stored(scene, depsgraph)


def _describe_vehicle(name: str, vehicle: pe.Vehicle | None) -> None:
    """Have a scene's vehicle told in a line, without waiting for maps and checks."""
    if vehicle is None:
        engine_process.drop(VEHICLE_LINE)
        _vehicle_lines.pop(name, None)
        return

    def deliver(line: str) -> None:
        _vehicle_lines[name] = line
        signals.view_changed.emit()

    engine_process.ask(
        VEHICLE_LINE,
        geometry.vehicle_line,
        (vehicle,),
        deliver,
        fail=lambda _: None,
        lane=engine_process.FOLLOWS_MOUSE,
    )


def warnings_of_result(
    settings: bpy.types.PropertyGroup, checked: Sequence[advice.Advice]
) -> list[advice.Advice]:
    """Return the warnings of the stored result that no check of the scene computes, as what a
    search could not keep: they stay as long as the result is that of the scene."""
    if not settings.has_result or settings.result_stale:
        return []
    known = {(each.subject, each.code, each.part) for each in checked}
    stored = settings.result.warnings
    return [each for each in stored if (each.subject, each.code, each.part) not in known]


def _explain_stored(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Explain the result of a file that was opened, or that undo brought back."""
    settings = scene.perception_entropy
    known = settings.result is None or explanation(scene) is not None
    if known or settings.result_stale or document.shown_state(scene):
        return
    try:
        vehicle = vehicle_cache.shared.read(scene, depsgraph).vehicle
        study = document.study_from_scene(scene, depsgraph, vehicle)
    except pe.InputError:  # a score reports it
        return
    outcome = document.stored_outcome(scene, study, json.loads(settings.result_json)["after"])
    if outcome is not None:
        explain_score(scene, outcome, settings.result_signature)


def explain_score(scene: bpy.types.Scene, outcome: jobs.Outcome, signature: str) -> None:
    """Explain a result in words; how far the rig sees follows in the background, in a window."""
    name = scene.name
    _explained[name] = _words(outcome, signature)

    def deliver(seen: advice.Outlook) -> None:
        if name in _explained and _explained[name].signature == signature:
            _explained[name] = _words(outcome, signature, seen)
            signals.view_changed.emit()

    if not bpy.app.background:
        given = (outcome.study,)
        engine_process.ask(EXPLANATION, analysis_calls.outlook, given, deliver, fail=lambda _: None)


def _words(
    outcome: jobs.Outcome, signature: str, seen: advice.Outlook | None = None
) -> Explanation:
    """Return an outcome in words; without `seen`, not how far its rig sees."""
    study = outcome.study
    score = outcome.after
    rows = advice.sensor_rows(score, study.rig, study.vehicle, seen)
    words = advice.rig_words(score, seen, study.rig)
    search = tuple(jobs.sureness_lines(outcome))
    return Explanation(signature, words, search, {row.name: row for row in rows})
