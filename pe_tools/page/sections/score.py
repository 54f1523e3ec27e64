"""The score of a study: the overview at the top of its page, and its parts by class and zone.

The overview has three sentences (question, result, notes), key figures and a picture.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from markupsafe import Markup

import pe_core as pe
from pe_core import metric
from pe_core import sensors as kinds
from pe_core.scoring import sight
from pe_core.study.condition_table import ConditionTable

from ... import advice
from ..markup import capitalized, escaped, joined, macros, number
from ..pictures.vehicle_picture import labelled_picture
from ..report_context import ReportContext

SIDES = {"front": "ahead", "rear": "behind", "left": "on the left", "right": "on the right"}
LOSS_SAMPLES = 65_536
"""Voxels on which coverage and zones without a sensor are evaluated."""
PALE, DARK = (255, 255, 255), (242, 165, 120)
"""Colours of the lowest and of the highest entropy."""


def overview(contexts: tuple[ReportContext, ...]) -> dict[str, Any] | None:
    """Return the overview of a single study; several studies have the comparison instead."""
    if len(contexts) > 1:
        return None
    (context,) = contexts
    space, sensors, scores = context.study.space, _sensor_counts(context), context.after
    blind = context.outlook.blind
    moved = sum(a.pose != b.pose for a, b in zip(context.start.rig, context.rig, strict=True))
    return {
        "sensors": sensors,
        "vehicle": _vehicle_text(context),
        "classes": joined([f"a {name}" for name in context.study.prior.class_names]),
        "ahead": _span(space.x),
        "aside": _span(space.y),
        "moved": moved,
        "zones": sorted(scores.per_zone, key=lambda zone: scores.per_zone[zone].entropy),
        "costs_nothing": advice.costs_nothing(context.outcome.cost),
        "hidden": [Markup(capitalized(line)) for line in hidden_sensor_lines(context)],
        "blind": blind,
        "blind_extents": [
            f"more than {blind.within:g} m {side}"
            if (end := blind.zone[key]) is None
            else f"up to {number(sight.shown_end(end), 1)} m {side}"
            for key, side in SIDES.items()
            if blind.zone[key] != 0.0
        ],
        "farthest_blind": _farthest_blind(context),
        "worst": max(scores.per_sensor, key=lambda name: scores.per_sensor[name].lost),
        "picture": labelled_picture(context, f"The vehicle with {sensors}"),
        "unseen_nats": metric.H_BLIND,
        "best_nats": metric.H_BEST,
    }


def hidden_sensor_lines(context: ReportContext) -> list[str]:
    """Return lines, as HTML, on the sensors that see nothing or are mostly hidden."""
    sensors = advice.hidden_sensors(context.rig, context.after, context.warnings)
    bold = macros().bold
    named = [replace(sensor, name=bold(sensor.name), why=escaped(sensor.why)) for sensor in sensors]
    return list(advice.hidden_words(named))


def _sensor_counts(context: ReportContext) -> str:
    """Return "2 LiDARs and 1 camera", the sensors of each kind."""
    rig_kinds = [kinds.kind_of(sensor) for sensor in context.rig]
    counts = []
    for kind in dict.fromkeys(rig_kinds):
        count = rig_kinds.count(kind)
        noun = kind.label if count == 1 else kind.plural
        counts.append(f"{count} {noun.lower() if noun.istitle() else noun}")
    return joined(counts)


def _vehicle_text(context: ReportContext) -> str:
    vehicle = context.vehicle
    if vehicle is None:
        return "no vehicle (nothing is occluded)"
    size = vehicle.bounds[1] - vehicle.bounds[0]
    name = (context.study.mesh or "a vehicle").replace("\\", "/").rpartition("/")[2]
    return f"{name} ({' × '.join(number(side) for side in size.tolist())} m)"


def _span(bounds: tuple[float, float]) -> str:
    low, high = bounds
    return f"{high:g}" if low == -high else f"{number(low, 0)} to {number(high, 0)}"


def _farthest_blind(context: ReportContext) -> tuple[str, str, str]:
    """Return figure, unit and note on the side where blind ground at the body extends farthest."""
    zone = context.outlook.blind.zone
    away = {side: float("inf") if end is None else end for side, end in zone.items()}
    side = max(away, key=lambda side: away[side])
    if away[side] == 0.0:
        return "none", "", "all around, within 10 m"
    end = zone[side]
    figure = "> 10" if end is None else number(sight.shown_end(end), 1)
    return figure, "m", f"from the body, {SIDES[side]}"


def warnings_and_text(context: ReportContext) -> dict[str, Any]:
    """Return the warnings about the study, and its score as text."""
    lines: list[tuple[str, list[str]]] = []
    for line in advice.words(
        context.after, context.rig, context.vehicle, context.outlook, context.warnings
    ):
        if line.startswith(" ") and lines:
            lines[-1][1].append(line.strip())
        else:
            lines.append((line.strip(), []))
    shown, error_m = context.display_vehicle
    simplified = shown is not context.vehicle
    return {"lines": lines, "simplified": simplified, "shown": shown, "error_m": error_m}


def by_class_and_zone(context: ReportContext) -> dict[str, Any] | None:
    """Return no values: the template shows coverage and entropy of the scores. On a page of several
    studies that were only scored, the comparison contains these values."""
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
    """The rig without one of its sensors, compared with the whole rig. `rise` is that of the
    entropy, as scored [nats], `uncovered` the coverage that is lost, 0 to 1; `zone` is the one in
    which the entropy rises most, by `zone_rise` [nats], empty if in none."""

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
