"""What a job found, written to the scene for the panel to show."""

from __future__ import annotations

import json
from collections.abc import Sequence

import bpy

from ..engine import advice, pe
from .oddities import DRIVER, MISSING
from .rig import sensor_objects
from .targets import store_found
from .tolerance import store_robustness
from .versions import figures_of

PARTS_NAMED = 3
"""How many parts of the vehicle the panel names as stopping beams."""
MARKING = (MISSING, DRIVER)
"""Warnings that mark a result: what was scored is not what was meant."""


def store_outcome(
    scene: bpy.types.Scene,
    outcome: pe.Outcome,
    signature: str,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> None:
    """Keep a result in the scene: figures for display, and result.json in full.

    `signature` is that of what was scored, taken when it was read: the scene may have changed.
    `sensors` are the scene's, when they have been looked for already.
    """
    settings = scene.perception_entropy
    settings.result_kind = outcome.kind
    settings.result_entropy = outcome.after.entropy
    settings.result_before = outcome.before.entropy
    settings.result_coverage = outcome.after.coverage
    settings.result_stderr = outcome.after.stderr
    result = pe.result_dict(outcome, blender_version())
    result["after"] = figures_of(outcome.after)
    settings.result_json = json.dumps(result)
    store_warnings(settings, outcome.warnings)
    store_robustness(settings, outcome)
    settings.result_missing = "\n".join(w.text for w in outcome.warnings if w.code in MARKING)
    settings.result_signature = signature
    for obj in sensor_objects(scene) if sensors is None else sensors:
        _store_sensor(obj.perception_entropy, outcome.after.per_sensor.get(obj.name))
        obj.perception_entropy.result_of = obj.name
        obj.perception_entropy.result_run = signature
    store_words(scene, outcome.study, outcome.after)
    _store_breakdown(settings, outcome.after)
    store_found(settings, outcome.after.objects)
    settings.result_stale = False
    settings.has_result = True


def store_words(
    scene: bpy.types.Scene,
    study: pe.Study,
    score: pe.Score,
    seen: advice.Outlook | None = None,
) -> None:
    """Keep a result in words: the rig's with the scene, each sensor's with its object."""
    scene.perception_entropy.result_words = "\n".join(advice.rig_words(score, seen, study.rig))
    for row in advice.sensor_rows(score, study.rig, study.vehicle, seen):
        obj = scene.objects.get(row.name)
        if obj is not None and obj.perception_entropy.is_sensor:
            _store_row(obj.perception_entropy, row)
            zones = None if seen is None or score.objects else seen.shares.zones[row.name]
            own, sensor = score.per_sensor[row.name], study.rig[row.name]
            told = advice.sensor_words(own, sensor, study.vehicle, zones, alone=row.loss is None)
            obj.perception_entropy.words = "\n".join(told)


def _store_row(settings: bpy.types.PropertyGroup, row: advice.SensorRow) -> None:
    """Store a sensor's row of the table: loss, where it costs most, and the parts that hide it."""
    _, settings.loss_text, settings.loss_where, _ = row.cells
    settings.stopped_parts.clear()
    for name, share in list(row.hidden_by.items())[:PARTS_NAMED]:
        part = settings.stopped_parts.add()
        part.name, part.share = name, share


def _store_breakdown(settings: bpy.types.PropertyGroup, score: pe.Score) -> None:
    """Keep entropy and coverage by zone and by class, for the panel's table."""
    settings.result_parts.clear()
    zones = {advice.WHERE.get(name, name): part for name, part in score.per_zone.items()}
    for is_class, parts in ((False, zones), (True, score.per_class)):
        for name, part in parts.items():
            row = settings.result_parts.add()
            row.name, row.is_class = name[:1].upper() + name[1:], is_class
            row.entropy, row.coverage = part.entropy, part.coverage


def store_warnings(settings: bpy.types.PropertyGroup, told: Sequence[pe.Advice]) -> None:
    """Keep what is odd about a scene's sensors and vehicle in its settings, for the panel."""
    settings.result_warnings.clear()
    for each in (each for each in told if each.code != advice.FRAGILE):
        row = settings.result_warnings.add()
        row.subject, row.code, row.text = each.subject or "", each.code, each.text
        row.part, row.fix = each.part or "", each.fix or ""
        row.amounts = len(each.amount)
        row.amount = (*each.amount, 0.0, 0.0, 0.0)[:3]


def blender_version() -> dict[str, str]:
    """Return what a result says about the program it came from."""
    return {"blender": bpy.app.version_string}


def _store_sensor(settings: bpy.types.PropertyGroup, score: pe.SensorScore | None) -> None:
    settings.has_result = score is not None
    if score is None:
        return
    settings.entropy, settings.coverage = score.entropy, score.coverage
    settings.beams, settings.stopped = score.beams, score.stopped
    settings.stopped_text = _stopped_text(score)


def _stopped_text(score: pe.SensorScore) -> str:
    """Return who stops the beams, most first: "roof 7.5%, hood 1.2%"."""
    by_count = sorted(score.stopped_by.items(), key=lambda item: (-item[1], item[0]))
    named = [f"{part} {count / score.beams:.1%}" for part, count in by_count[:PARTS_NAMED] if count]
    more = ["..."] if len(by_count) > PARTS_NAMED else []
    return ", ".join(named + more)
