"""The outcome of a job, stored in the scene for the panel."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import bpy
from bpy.types import PropertyGroup, Scene

from ..engine import advice, jobs, pe, studies
from .requirements import store_verdicts
from .scene_diagnostics import DRIVER, MISSING
from .stored import ResultPart, SensorFigures, StoredResult, StoredWarning, store
from .versions import scored_data

PARTS_NAMED = 3
"""The panel names so many parts of the vehicle that block beams."""
MARKING = (MISSING, DRIVER)
"""Codes of warnings that mark a result: what was scored is not what was meant."""


def store_outcome(scene: Scene, outcome: jobs.Outcome, signature: str) -> None:
    """Store an outcome in the scene: figures for display, and result.json in full.

    `signature` is the scene's signature at the time when it was read: the scene may have changed
    since.
    """
    settings, robustness = scene.perception_entropy, outcome.robustness
    off = lost = ""
    if robustness is not None:
        off = _change(robustness.before.rise, robustness.after.rise)
        lost = _change(robustness.before.loss, robustness.after.loss)
    before, after = outcome.before, outcome.after
    told = [figures.to_dict() for figures in outcome.figures or ()]
    shown = StoredResult(
        result_kind=outcome.kind,
        result_entropy=after.entropy,
        result_before=before.entropy,
        result_coverage=after.coverage,
        result_coverage_before=before.coverage,
        result_stderr=after.stderr,
        result_figures=dict(zip(("before", "after"), told, strict=False)),
        result_gain=outcome.gain.replace("+-", "±"),
        result_cost=outcome.cost,
        result_conditions="\n".join(_condition_lines(outcome.conditions)),
        result_missing="\n".join(w.text for w in outcome.warnings if w.code in MARKING),
        result_ap=_ap_text(after.objects),
        result_mounted_off=off,
        result_sensor_lost=lost,
        result_sureness="\n".join(jobs.sureness_lines(outcome)),
        result_fragile=next((w.text for w in outcome.warnings if w.code == advice.FRAGILE), ""),
        result_parts=tuple(_parts(after)),
        result_sensors={
            name: SensorFigures(own.entropy, own.coverage, own.beams, own.occluded)
            for name, own in after.per_sensor.items()
        },
    )
    store(settings, "result_shown", shown)
    result = jobs.result_dict(outcome, blender_version())
    result["after"] = scored_data(after, outcome.figures and outcome.figures[1])
    settings.result_json, settings.result_signature = json.dumps(result), signature
    store_warnings(settings, outcome.warnings)
    store_verdicts(settings, outcome.verdicts)
    store_text(scene, outcome.study, after)
    settings.result_stale, settings.has_result = False, True


def _condition_lines(table: studies.ConditionTable | None) -> list[str]:
    """Return a line for each condition, the mean and the worst, and what a state covers."""
    if table is None:
        return []
    lines = [line.strip() for line in jobs.condition_lines(table)[1:]]
    warnings = advice.condition_warnings(table)
    return lines + [f"{w.subject}: {w.text}" if w.subject else w.text for w in warnings]


def store_text(
    scene: Scene, study: pe.Study, score: pe.Score, seen: advice.Outlook | None = None
) -> None:
    """Store a result's sentences on the rig, and the figures of each of its sensors."""
    settings, sensors = scene.perception_entropy, {}
    for row in advice.sensor_rows(score, study.rig, study.vehicle, seen):
        _, loss, where, _ = row.cells
        parts = tuple(row.occluded_by.items())[:PARTS_NAMED]
        figures = settings.result_sensors[row.name]
        sensors[row.name] = figures._replace(parts=parts, loss=loss, where=where)
    settings.result_sensors = {**settings.result_sensors, **sensors}
    settings.result_words = "\n".join(advice.rig_words(score, seen, study.rig))


def _parts(score: pe.Score) -> Iterator[ResultPart]:
    """Yield entropy and coverage by zone and by class, for the panel's table."""
    zones = {advice.WHERE.get(name, name): part for name, part in score.per_zone.items()}
    for name, part in zones.items():
        yield ResultPart(name[:1].upper() + name[1:], False, part.entropy, part.coverage)
    found = {} if score.objects is None else score.objects.per_class
    for name, part in score.per_class.items():
        row = ResultPart(name[:1].upper() + name[1:], True, part.entropy, part.coverage)
        if (own := found.get(name)) is not None:
            row = row._replace(ap=f"{own.ap:.2f}", reach=advice.lone_reach(own.reach["front"]))
        yield row


def store_warnings(settings: PropertyGroup, warnings: Sequence[advice.Advice]) -> None:
    """Store the warnings about a scene's sensors and vehicle, for the panel."""
    rows = []
    for each in warnings:
        if each.code != advice.FRAGILE:
            x, y, z = (*each.amount, 0.0, 0.0, 0.0)[:3]
            named = each.subject or "", each.code, dict(each.values)
            rows.append(StoredWarning(*named, each.part or "", each.fix or "", (x, y, z)))
    settings.result_warnings = tuple(rows)


def blender_version() -> dict[str, str]:
    """Return the version of Blender, as result.json holds it."""
    return {"blender": bpy.app.version_string}


def _change(before: float | None, after: float | None) -> str:
    if before is None or after is None:
        return ""
    return f"{before:+.3f} \N{RIGHTWARDS ARROW} {after:+.3f} nats"


def _ap_text(score: pe.ObjectScore | None) -> str:
    """Return the expected AP of all objects with its standard error; empty without objects."""
    if score is None:
        return ""
    return f"{score.ap:.3f} \N{PLUS-MINUS SIGN} {max(score.ap_stderr, 1e-3):.3f}"
