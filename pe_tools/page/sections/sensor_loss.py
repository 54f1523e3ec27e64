"""What the loss of each sensor costs the rig: entropy, coverage, and the zone it hurts most."""

from __future__ import annotations

from dataclasses import dataclass

import pe_core as pe

from ... import advice
from ..markup import Markup, bar, escaped, percent, signed, table
from ..report_context import ReportContext, Section

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
    whole = evaluator.glance(context.rig)
    losses = [_loss_of(context, sensor.name, evaluator, whole) for sensor in context.rig]
    return tuple(sorted(losses, key=lambda loss: -loss.rise))


def _loss_of(
    context: ReportContext, name: str, evaluator: pe.RigJudge, whole: pe.Glance
) -> SensorLoss:
    remaining = pe.Rig([sensor for sensor in context.rig if sensor.name != name])
    score = evaluator.glance(remaining)
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
