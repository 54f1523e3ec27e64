"""What becomes of a rig when one of its sensors fails."""

from __future__ import annotations

from dataclasses import dataclass

from .engine import pe
from .reviewed import Reviewed

SAMPLES = 65_536
"""Voxels that coverage and zones without a sensor are looked at on."""


@dataclass(frozen=True, slots=True)
class Failure:
    """One sensor lost.

    Attributes
    ----------
    sensor : str
    rise : float
        What the entropy rises by, as scored [nats].
    uncovered : float
        What is no longer seen of where objects are, 0 to 1.
    zone : str
        Where the entropy rises most; empty where it does nowhere.
    zone_rise : float
        By how much there [nats].
    """

    sensor: str
    rise: float
    uncovered: float
    zone: str
    zone_rise: float


def failures(one: Reviewed) -> tuple[Failure, ...]:
    """Tell of each sensor what its loss costs, the dearest first; nothing of a single sensor."""
    return one.once("failures", lambda: _failures(one))


def _failures(one: Reviewed) -> tuple[Failure, ...]:
    if len(one.rig) < 2:
        return ()
    evaluator = one.evaluator(SAMPLES)
    whole = evaluator.glance(one.rig)
    found = [_failure(one, sensor.name, evaluator, whole) for sensor in one.rig]
    return tuple(sorted(found, key=lambda failure: -failure.rise))


def _failure(one: Reviewed, name: str, evaluator: pe.RigJudge, whole: pe.Glance) -> Failure:
    left = evaluator.glance(pe.Rig([sensor for sensor in one.rig if sensor.name != name]))
    rises = {
        zone: part.entropy - whole.per_zone[zone].entropy for zone, part in left.per_zone.items()
    }
    zone = max(rises, key=lambda zone: rises[zone], default="")
    most = rises.get(zone, 0.0)
    rise = one.after.per_sensor[name].lost
    return Failure(name, rise, whole.coverage - left.coverage, zone if most > 0.0 else "", most)
