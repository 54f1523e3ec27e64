"""The score by class and by zone, without each sensor, and for objects by class."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pe_core as pe

from ... import advice
from ..markup import (
    Markup,
    bar,
    capitalized,
    coverage_bar,
    entropy_bar,
    escaped,
    number,
    percent,
    signed,
    table,
)
from ..report_context import ReportContext, Section

PART_HEADS = ("share of objects", "coverage", "entropy [nats]")


def by_class_and_zone(context: ReportContext) -> Section:
    """Return coverage and entropy of every class and zone, with the values before a search.

    On a page of several studies that were only scored, the comparison contains these values.
    """
    if context.study_count > 1 and not context.was_searched:
        return Section("parts", "By class and zone", "")
    before, after = context.before, context.after
    tables = [
        _part_table(context, "Class", before.per_class, after.per_class),
        _part_table(context, "Zone", before.per_zone, after.per_zone),
    ]
    bars = "The bar of entropy is full for an unseen part and empty for the best possible value"
    tick = "; the dark tick marks the value before the search" if context.was_searched else ""
    zones = "Zones overlap: halves of the ground, and rings around the vehicle."
    inside = f'{"".join(tables)}<p class="note">{bars}{tick}. {zones}</p>'
    return Section("parts", "By class and zone", inside)


def _part_table(
    context: ReportContext,
    title: str,
    before: Mapping[str, pe.PartScore],
    after: Mapping[str, pe.PartScore],
) -> str:
    heads = [title, *PART_HEADS, *(["change"] if context.was_searched else [])]
    caption = f"{title}: coverage and entropy"
    return table(caption, heads, _part_rows(context, before, after))


def _part_rows(
    context: ReportContext, before: Mapping[str, pe.PartScore], after: Mapping[str, pe.PartScore]
) -> Iterator[list[str]]:
    for name, part in after.items():
        was = before.get(name) if context.was_searched else None
        yield [
            capitalized(advice.WHERE.get(name, name)),
            percent(part.share, 1),
            coverage_bar(part.coverage, was.coverage if was else None),
            entropy_bar(part.entropy, was.entropy if was else None),
            *([signed(part.entropy - was.entropy)] if was else []),
        ]


def objects(context: ReportContext) -> Section:
    """Return AP, points and reach by class of a study scored on objects; else nothing."""
    score = context.after.objects
    if score is None:
        return Section("objects", "Objects", "")
    sample = advice.objects_looked_at(score)
    error = f"{number(score.ap_stderr, 3)}"
    brief = f"Expected AP {number(score.ap, 3)}, standard error {error}, on {sample}."
    tables = f"{_class_table(score)}{_reach_table(score)}"
    return Section("objects", "Objects", f"<p>{escaped(brief)}</p>{tables}")


def _class_table(score: pe.ObjectScore) -> str:
    thresholds = next(iter(score.per_class.values())).points if score.per_class else {}
    heads = ["", "AP", "Standard error", *(f"{n} points or more" for n in thresholds)]
    rows = [
        [
            capitalized(name),
            number(of_class.ap, 3),
            number(of_class.ap_stderr, 3),
            *(percent(share, 1) for share in of_class.points.values()),
        ]
        for name, of_class in score.per_class.items()
    ]
    return table("Expected AP, and the share of objects with at least so many points", heads, rows)


def _reach_table(score: pe.ObjectScore) -> str:
    classes = score.per_class
    heads = ["", *map(capitalized, classes)]
    directions = next(iter(classes.values())).reach if classes else {}
    rows = [
        [
            capitalized(direction),
            *(advice.lone_reach(of_class.reach[direction]) for of_class in classes.values()),
        ]
        for direction in directions
    ]
    return table("Reach: distance up to which a lone object has AP 0.5 or more", heads, rows)


LOSS_SAMPLES = 65_536
"""Voxels on which coverage and zones without a sensor are evaluated."""
HEADS = ("without", "entropy rises by [nats]", "coverage lost", "most in zone")
TITLE = "Loss of one sensor"


@dataclass(frozen=True, slots=True)
class SensorLoss:
    """The rig without one of its sensors, compared with the whole rig.

    Attributes
    ----------
    sensor : str
    rise : float
        Rise of the entropy, as scored [nats].
    uncovered : float
        Coverage that is lost, 0 to 1.
    zone : str
        Zone in which the entropy rises most; empty if it rises in none.
    zone_rise : float
        Rise of the entropy in that zone [nats].
    """

    sensor: str
    rise: float
    uncovered: float
    zone: str
    zone_rise: float


def sensor_loss(context: ReportContext) -> Section:
    """Return the section on the loss of each sensor."""
    losses = sensor_losses(context)
    if not losses:
        text = "The rig has a single sensor: without it, nothing is seen."
        return Section("sensor-loss", TITLE, f"<p>{text}</p>")
    max_rise = max(max(loss.rise for loss in losses), 1e-9)
    rows = [_row(loss, max_rise) for loss in losses]
    inside = f"<p>{_summary(losses)}</p>{table('The rig without each sensor', HEADS, rows)}"
    return Section("sensor-loss", TITLE, inside)


def sensor_losses(context: ReportContext) -> tuple[SensorLoss, ...]:
    """Return the loss of each sensor, the largest rise first; empty for a single sensor."""
    return context.cached("sensor losses", lambda: _losses(context))


def _losses(context: ReportContext) -> tuple[SensorLoss, ...]:
    if len(context.rig) < 2:
        return ()
    evaluator = context.evaluator(LOSS_SAMPLES)
    whole = evaluator.summary(context.rig)
    losses = [_loss_of(context, sensor.name, evaluator, whole) for sensor in context.rig]
    return tuple(sorted(losses, key=lambda loss: -loss.rise))


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


def _summary(losses: tuple[SensorLoss, ...]) -> str:
    """Return a sentence on the most important sensor, and one on the least important."""
    first, last = losses[0], losses[-1]
    zone = f"; the rise is largest {advice.WHERE.get(first.zone, first.zone)}" if first.zone else ""
    sentence = (
        f"The rig loses most without <b>{escaped(first.sensor)}</b>: entropy rises by "
        f"{signed(first.rise)} nats{zone}."
    )
    if first is last:
        return sentence
    least = f"It loses least without <b>{escaped(last.sensor)}</b>: {signed(last.rise)} nats."
    return f"{sentence} {least}"


def _row(loss: SensorLoss, max_rise: float) -> list[str]:
    zone = advice.WHERE.get(loss.zone, loss.zone)
    worst = f"{zone} ({signed(loss.zone_rise)} nats)" if loss.zone else "none"
    rise: Markup = bar(signed(loss.rise), loss.rise / max_rise)
    return [loss.sensor, rise, percent(max(loss.uncovered, 0.0), 1), worst]
