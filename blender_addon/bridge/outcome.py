"""The outcome of a job, stored in the scene for the panel."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import bpy

from ..engine import advice, jobs, pe, studies
from .requirements import store_verdicts
from .rig import sensor_objects
from .scene_diagnostics import DRIVER, MISSING
from .versions import migrate_scene, score_to_dict

PARTS_NAMED = 3
"""The panel names so many parts of the vehicle that block beams."""
MARKING = (MISSING, DRIVER)
"""Codes of warnings that mark a result: what was scored is not what was meant."""


def store_outcome(
    scene: bpy.types.Scene,
    outcome: pe.Outcome,
    signature: str,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> None:
    """Store an outcome in the scene: figures for display, and result.json in full.

    `signature` is the scene's signature at the time when it was read: the scene may have changed
    since. `sensors` are the scene's sensors, if the caller has already read them.
    """
    migrate_scene(scene)  # or the first save would mark the result as one of an earlier version
    settings = scene.perception_entropy
    settings.result_kind = outcome.kind
    settings.result_entropy = outcome.after.entropy
    settings.result_before = outcome.before.entropy
    settings.result_cost, settings.result_coverage_before = outcome.cost, outcome.before.coverage
    settings.result_blind = [math.ceil(10.0 * m2) / 10.0 for m2 in outcome.blind_m2 or (0.0, 0.0)]
    settings.result_coverage = outcome.after.coverage
    settings.result_stderr = outcome.after.stderr
    result = pe.result_dict(outcome, blender_version())
    result["after"] = score_to_dict(outcome.after)
    settings.result_json = json.dumps(result)
    store_warnings(settings, outcome.warnings)
    store_robustness(settings, outcome)
    settings.result_missing = "\n".join(w.text for w in outcome.warnings if w.code in MARKING)
    settings.result_signature = signature
    store_verdicts(settings, outcome.verdicts)
    settings.result_conditions = "\n".join(_condition_lines(outcome.conditions))
    for obj in sensor_objects(scene) if sensors is None else sensors:
        _store_sensor(obj.perception_entropy, outcome.after.per_sensor.get(obj.name))
        obj.perception_entropy.result_of = obj.name
        obj.perception_entropy.result_run = signature
    store_text(scene, outcome.study, outcome.after)
    _store_breakdown(settings, outcome.after)
    store_object_score(settings, outcome.after.objects)
    settings.result_in_traffic = _in_traffic_text(outcome)
    settings.result_stale = False
    settings.has_result = True


def _condition_lines(table: studies.ConditionTable | None) -> list[str]:
    """Return a line for each condition, the mean and the worst, and what a state covers."""
    if table is None:
        return []
    lines = [line.strip() for line in jobs.condition_lines(table)[1:]]
    warnings = advice.condition_warnings(table)
    return lines + [f"{w.subject}: {w.text}" if w.subject else w.text for w in warnings]


def store_text(
    scene: bpy.types.Scene,
    study: pe.Study,
    score: pe.Score,
    seen: advice.Outlook | None = None,
) -> None:
    """Store a result's sentences: on the rig in the scene, on each sensor in its object."""
    scene.perception_entropy.result_words = "\n".join(advice.rig_words(score, seen, study.rig))
    for row in advice.sensor_rows(score, study.rig, study.vehicle, seen):
        obj = scene.objects.get(row.name)
        if obj is not None and obj.perception_entropy.is_sensor:
            _store_row(obj.perception_entropy, row)
            zones = None if seen is None or score.objects else seen.shares.zones[row.name]
            sensor_score, sensor = score.per_sensor[row.name], study.rig[row.name]
            sentences = advice.sensor_words(
                sensor_score, sensor, study.vehicle, zones, alone=row.loss is None
            )
            obj.perception_entropy.words = "\n".join(sentences)


def _store_row(settings: bpy.types.PropertyGroup, row: advice.SensorRow) -> None:
    """Store a sensor's table row: loss, the zone of the largest loss, and occluding parts."""
    _, settings.loss_text, settings.loss_where, _ = row.cells
    settings.stopped_parts.clear()
    for name, share in list(row.occluded_by.items())[:PARTS_NAMED]:
        part = settings.stopped_parts.add()
        part.name, part.share = name, share


def _store_breakdown(settings: bpy.types.PropertyGroup, score: pe.Score) -> None:
    """Store entropy and coverage by zone and by class, for the panel's table."""
    settings.result_parts.clear()
    zones = {advice.WHERE.get(name, name): part for name, part in score.per_zone.items()}
    for is_class, parts in ((False, zones), (True, score.per_class)):
        for name, part in parts.items():
            row = settings.result_parts.add()
            row.name, row.is_class = name[:1].upper() + name[1:], is_class
            row.entropy, row.coverage = part.entropy, part.coverage


def store_warnings(settings: bpy.types.PropertyGroup, warnings: Sequence[pe.Advice]) -> None:
    """Store the warnings about a scene's sensors and vehicle, for the panel."""
    settings.result_warnings.clear()
    for warning in (w for w in warnings if w.code != advice.FRAGILE):
        row = settings.result_warnings.add()
        row.subject, row.code, row.text = warning.subject or "", warning.code, warning.text
        row.part, row.fix = warning.part or "", warning.fix or ""
        row.amounts = len(warning.amount)
        row.amount = (*warning.amount, 0.0, 0.0, 0.0)[:3]


def blender_version() -> dict[str, str]:
    """Return the version of Blender, as result.json holds it."""
    return {"blender": bpy.app.version_string}


def _store_sensor(settings: bpy.types.PropertyGroup, score: pe.SensorScore | None) -> None:
    settings.has_result = score is not None
    if score is None:
        return
    settings.entropy, settings.coverage = score.entropy, score.coverage
    settings.beams, settings.stopped = score.beams, score.occluded
    settings.stopped_text = _stopped_text(score)


def _stopped_text(score: pe.SensorScore) -> str:
    """Return the parts that block most beams: "roof 7.5%, hood 1.2%"."""
    by_count = sorted(score.occluded_by.items(), key=lambda item: (-item[1], item[0]))
    named = [f"{part} {count / score.beams:.1%}" for part, count in by_count[:PARTS_NAMED] if count]
    more = ["..."] if len(by_count) > PARTS_NAMED else []
    return ", ".join(named + more)


def store_robustness(settings: bpy.types.PropertyGroup, outcome: pe.Outcome) -> None:
    """Store how much mounting errors and failures raise the entropy of a search's start and end."""
    robustness = outcome.robustness
    off = lost = ""
    if robustness is not None:
        off = _change(robustness.before.rise, robustness.after.rise)
        lost = _change(robustness.before.loss, robustness.after.loss)
    settings.result_mounted_off, settings.result_sensor_lost = off, lost
    settings.result_sureness = "\n".join(jobs.sureness_lines(outcome))
    fragile = (warning.text for warning in outcome.warnings if warning.code == advice.FRAGILE)
    settings.result_fragile = next(fragile, "")


def _in_traffic_text(outcome: pe.Outcome) -> str:
    """Return the expected AP that a search by it began and ended with; empty for others."""
    if outcome.in_traffic is None:
        return ""
    before, after = (each.ap for each in outcome.in_traffic)
    return f"{before:.3f} \N{RIGHTWARDS ARROW} {after:.3f}"


def _change(before: float | None, after: float | None) -> str:
    if before is None or after is None:
        return ""
    return f"{before:+.3f} \N{RIGHTWARDS ARROW} {after:+.3f} nats"


def store_object_score(settings: bpy.types.PropertyGroup, score: pe.ObjectScore | None) -> None:
    """Store the expected AP of objects for the panel: of all objects, and by class."""
    settings.result_ap = ""
    if score is None:
        return
    settings.result_ap = f"{score.ap:.3f} \N{PLUS-MINUS SIGN} {max(score.ap_stderr, 1e-3):.3f}"
    by_name = {_shown(name): class_score for name, class_score in score.per_class.items()}
    for row in settings.result_parts:
        class_score = by_name.get(row.name) if row.is_class else None
        if class_score is not None:
            row.ap = f"{class_score.ap:.2f}"
            row.reach = advice.lone_reach(class_score.reach["front"])


def _shown(name: str) -> str:
    return name[:1].upper() + name[1:]
