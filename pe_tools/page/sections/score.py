"""The results of a study: the overview at the top of its page, its parts, and its search. The
overview is what one decides by, key figures and a picture."""

import math
from dataclasses import replace
from typing import Any

from pe_core import metric, scene
from pe_core import sensors as kinds
from pe_core.scoring import NO_DIFFERENCE, Score, is_noise
from pe_core.study.condition_table import ConditionTable

from ... import advice, jobs
from ...templating import Markup
from ..markup import capitalized, escaped, joined, macros, number, signed
from ..pictures.charts import step_curve
from ..pictures.vehicle_picture import labelled_picture
from ..report_context import ReportContext
from .decision import decision

SIDES = {"front": "ahead", "rear": "behind", "left": "on the left", "right": "on the right"}
WARNINGS_SHOWN = 3  # At the top; all are in a section of their own
LEAST_SHOWN = 0.01  # A standard error is never told as 0 [nats]
# Colours of the lowest and of the highest entropy
PALE = (255, 255, 255)
DARK = (242, 165, 120)


def overview(contexts: tuple[ReportContext, ...]) -> dict[str, Any] | None:
    """Return the overview of a single study; several studies have the comparison instead."""
    if len(contexts) > 1:
        return None
    (context,) = contexts
    rig_kinds = [kinds.kind_of(sensor) for sensor in context.rig]
    scores = context.after
    counts = []  # "2 LiDARs", "1 camera"
    for kind in dict.fromkeys(rig_kinds):
        count = rig_kinds.count(kind)
        noun = kind.label if count == 1 else kind.plural
        counts.append(f"{count} {noun.lower() if noun.istitle() else noun}")
    blind = context.outlook.blind
    return {
        "sensors": joined(counts),
        **decision(context),
        "warnings_shown": WARNINGS_SHOWN,
        "zones": sorted(scores.per_zone, key=lambda zone: scores.per_zone[zone].entropy),
        "costs_nothing": advice.costs_nothing(context.outcome.cost),
        "hidden": [Markup(capitalized(line)) for line in hidden_sensor_lines(context)],
        "blind": blind,
        "sides": SIDES,
        "worst": max(scores.per_sensor, key=lambda name: scores.per_sensor[name].lost),
        "picture": labelled_picture(context, f"The vehicle with {joined(counts)}"),
        "unseen_nats": metric.H_BLIND,
        "best_nats": metric.H_BEST,
    }


def hidden_sensor_lines(context: ReportContext) -> list[str]:
    """Return lines, as HTML, on the sensors that see nothing or are mostly hidden."""
    sensors = advice.hidden_sensors(context.rig, context.after, context.outcome.warnings)
    bold = macros().bold
    named = [replace(sensor, name=bold(sensor.name), why=escaped(sensor.why)) for sensor in sensors]
    return list(advice.hidden_words(named))


def warnings_and_text(context: ReportContext) -> dict[str, Any]:
    """Return the warnings about the study, and its score as text."""
    lines = advice.rig_words(context.after, context.outlook, context.rig, context.outcome.warnings)
    shown, error_m = context.display_vehicle
    simplified = shown is not context.vehicle
    return {"lines": lines, "simplified": simplified, "shown": shown, "error_m": error_m}


def by_class_and_zone(context: ReportContext) -> dict[str, Any] | None:
    """Return how the entropies of classes and zones changed in a search: the template shows the
    others of the scores. On a page of several studies that were only scored, the comparison
    contains these values."""
    if context.study_count > 1 and not context.was_searched:
        return None
    before = context.outcome.before
    changes = {
        "Class": _changes(before, context.after, "class"),
        "Zone": _changes(before, context.after, "zone"),
    }
    return {"changes": changes}


def _changes(before: Score, after: Score, group: str) -> dict[str, str]:
    """Return the changes of the entropies of all classes, or zones, with their standard errors."""
    told = {}
    for name, part in getattr(after, f"per_{group}").items():
        was = getattr(before, f"per_{group}").get(name)
        if was is None:
            continue
        by = part.entropy - was.entropy
        error = advice.difference_error(before, after, (group, name, "entropy"))
        sure = f" ± {number(max(error, LEAST_SHOWN))}" if error else ""
        told[name] = NO_DIFFERENCE if is_noise(by, error) and by else f"{signed(by)}{sure}"
    return told


def objects(context: ReportContext) -> dict[str, Any] | None:
    """Return AP, points and reach by class of a study scored on objects; else None."""
    score = context.after.objects
    if score is None:
        return None
    return {
        "score": score,
        "sample": advice.objects_looked_at(score),
        "first": next(iter(score.per_class.values()), None),
    }


def sensor_loss(context: ReportContext) -> dict[str, Any]:
    """Return the loss of each sensor, the largest rise first; none for a single sensor."""
    rows = advice.sensor_rows(context.after, context.rig, context.vehicle, context.outlook)
    losses = sorted(rows, key=lambda row: -(row.loss or 0.0)) if len(rows) > 1 else []
    return {"losses": losses, "max_rise": max([1e-9, *(row.loss or 0.0 for row in losses)])}


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
    low = min(values)
    high = max(values)

    def color_of(value: float) -> str:
        share = (value - low) / (high - low) if high > low else 0.0
        rgb = (str(round(p + (d - p) * share)) for p, d in zip(PALE, DARK, strict=True))
        return f"rgb({' '.join(rgb)})"

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
        "by_ap": all(row.ap_per_class for row in rows),
        "classes": list(dict.fromkeys(name for row in rows for name in row.per_class)),
    }


def search_history(context: ReportContext) -> dict[str, Any] | None:
    """Return the course of a search; None for a study that was only scored."""
    if not context.was_searched:
        return None
    outcome = context.outcome
    robustness = context.outcome.robustness
    figure = outcome.figure
    curve, caption = _curve(context, figure)
    moves = []  # how far each sensor was moved [m] and turned [deg]
    for old, new in zip(context.start.rig, context.rig, strict=True):
        first, last = (scene.rotation_matrix(*each.pose.rpy) for each in (old, new))
        cosine = (float((first * last).sum()) - 1.0) / 2.0  # the sum is trace(first.T @ last)
        turned = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
        moves.append((old, new, math.dist(old.pose.position, new.pose.position), turned))
    return {
        "reason": jobs.stop_text(outcome),
        "scatter": jobs.scatter_text(outcome),
        "searched": figure,
        "curve": curve,
        "caption": caption,
        "moves": moves,
        "robustness": robustness,
        "errors": capitalized(
            advice.off_by(robustness.errors.position, robustness.errors.angle) if robustness else ""
        ),
    }


def _curve(context: ReportContext, figure: jobs.SearchedFigure) -> tuple[Markup | str, str]:
    """Return the convergence curve and its caption; empty texts without any progress."""
    if len(context.outcome.history) < 2:
        return "", ""
    found = jobs.best_so_far(context.outcome.history)
    by_ap = figure.higher_is_better
    is_broken = not found[-1][1].is_feasible
    if not is_broken:  # what breaks a constraint has no figure
        found = tuple(each for each in found if each[1].is_feasible)
    points = [(n, v.violation if is_broken else figure.to_figure(v)) for n, v in found]
    first, last = (number(points[k][1], 3 if by_ap or is_broken else 2) for k in (0, -1))
    own = context.outcome.own is not None
    what = figure.label
    unit = "" if by_ap or own else " nats"
    what, unit = ("violation of constraints", "") if is_broken else (what, unit)
    sample = "" if own else ", on the samples of the search"
    caption = f"Best {what} so far: from {first} to {last}{unit}{sample}."
    label = unit.strip() or what
    alt = f"Convergence curve. {caption}"
    evaluations = context.outcome.evaluations
    return step_curve(points, evaluations, "placements evaluated", label, alt=alt), caption


def flatness(context: ReportContext) -> dict[str, Any] | None:
    """Return how flat the optimum of a search is; None without the analysis."""
    found = context.outcome.flatness
    if found is None:
        return None
    return {"found": found, "steps": sorted({step for row in found.axes for step in row.cost})}
