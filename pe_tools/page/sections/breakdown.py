"""The score by class, zone and condition, without each sensor, and for objects by class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pe_core as pe
from pe_core.study.condition_table import ConditionTable

from ... import advice
from ..markup import capitalized, number
from ..report_context import ReportContext

LOSS_SAMPLES = 65_536
"""Voxels on which coverage and zones without a sensor are evaluated."""
PALE, DARK = (255, 255, 255), (242, 165, 120)
"""Colours of the lowest and of the highest entropy."""


def by_class_and_zone(context: ReportContext) -> dict[str, Any] | None:
    """Return no values: the template shows coverage and entropy of the scores.

    On a page of several studies that were only scored, the comparison contains these values.
    """
    return None if context.study_count > 1 and not context.was_searched else {}


def objects(context: ReportContext) -> dict[str, Any] | None:
    """Return AP, points and reach by class of a study scored on objects; else None."""
    score = context.after.objects
    if score is None:
        return None
    classes = score.per_class.values()
    first = next(iter(classes), None)
    return {
        "score": score,
        "sample": advice.objects_looked_at(score),
        "thresholds": [f"{n} points or more" for n in (first.points if first else ())],
        "reach": [
            [
                capitalized(direction),
                *(advice.lone_reach(each.reach[direction]) for each in classes),
            ]
            for direction in (first.reach if first else ())
        ],
    }


@dataclass(frozen=True, slots=True)
class SensorLoss:
    """The rig without one of its sensors, compared with the whole rig.

    `rise` is that of the entropy, as scored [nats], `uncovered` the coverage that is lost, 0 to 1;
    `zone` is the one in which the entropy rises most, by `zone_rise` [nats], empty if in none.
    """

    sensor: str
    rise: float
    uncovered: float
    zone: str
    zone_rise: float


def sensor_loss(context: ReportContext) -> dict[str, Any]:
    """Return the loss of each sensor, the largest rise first; none for a single sensor."""
    losses: list[SensorLoss] = []
    if len(context.rig) > 1:
        evaluator = context.study.evaluator(LOSS_SAMPLES)
        whole = evaluator.summary(context.rig)
        losses = [_loss_of(context, sensor.name, evaluator, whole) for sensor in context.rig]
    losses.sort(key=lambda loss: -loss.rise)
    max_rise = max((loss.rise for loss in losses), default=0.0)
    return {"losses": losses, "max_rise": max(max_rise, 1e-9)}


def _loss_of(
    context: ReportContext, name: str, evaluator: pe.RigEvaluator, whole: pe.SummaryScore
) -> SensorLoss:
    remaining = pe.Rig([sensor for sensor in context.rig if sensor.name != name])
    score = evaluator.summary(remaining)
    rises = {
        zone: part.entropy - whole.per_zone[zone].entropy for zone, part in score.per_zone.items()
    }
    zone = max(rises, key=lambda zone: rises[zone], default="")
    zone_rise = rises.get(zone, 0.0)
    rise = context.after.per_sensor[name].lost
    uncovered = whole.coverage - score.coverage
    return SensorLoss(name, rise, uncovered, zone if zone_rise > 0.0 else "", zone_rise)


def conditions(context: ReportContext) -> dict[str, Any] | None:
    """Return the tables of a study's conditions; None for a study without."""
    found = context.outcome.conditions
    return None if found is None else table_values(found)


def table_values(found: ConditionTable) -> dict[str, Any]:
    """Return what the template shows of a table of conditions."""
    rows = found.rows
    matrix = [("Whole rig", found.mean, [row.entropy for row in rows])]
    if len(found.sensors) > 1:
        matrix += [
            (f"without {name}", found.mean_without(name), [row.without[name] for row in rows])
            for name in found.sensors
        ]
    values = [value for _, _, entropies in matrix for value in entropies]
    low, high = min(values), max(values)

    def color_of(value: float) -> str:
        share = (value - low) / (high - low) if high > low else 0.0
        rgb = (str(round(p + (d - p) * share)) for p, d in zip(PALE, DARK, strict=True))
        return f"rgb({' '.join(rgb)})"

    with_ap = all(row.ap_per_class for row in rows)
    classes = list(dict.fromkeys(name for row in rows for name in row.per_class))
    by_class = [(row.name, (row.ap_per_class or {}) if with_ap else row.per_class) for row in rows]
    return {
        "table_of": found,
        "names": [row.name for row in rows],
        "matrix": matrix,
        "highest": max(
            value
            for _, _, entropies in matrix
            for value, row in zip(entropies, rows, strict=True)
            if row.weight
        ),
        "color_of": color_of,
        "per_class": {
            "title": "Expected AP by class" if with_ap else "Entropy by class [nats]",
            "classes": classes,
            "rows": [
                [name, *(number(own[n], 3) if n in own else "" for n in classes)]
                for name, own in by_class
            ],
        },
    }
