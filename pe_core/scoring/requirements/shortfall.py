"""How far a rig is off a requirement on bodies: what leads a search in."""

from __future__ import annotations

import math

import numpy as np

from ...base.arrays import Floats
from ...scene.rig import Rig
from .body_checks import counted
from .criteria import Requirement
from .verdict import Samples, ZoneResult
from .zones import INSIDE_M

SHARE_WEIGHT, LACKING_WEIGHT, AWAY_WEIGHT = 0.45, 0.45, 0.1
"""Weights of the samples that fail, of sensors and kinds that lack, and of the angle."""


def shortfall(requirement: Requirement, samples: Samples, result: ZoneResult, rig: Rig) -> float:
    """Return 0 where a requirement is met, else how far it is off, above 0 to 1."""
    criterion, inside = requirement.criterion, samples.inside
    share = float(result.passed[inside].mean())
    if share >= criterion.zone_share:
        return 0.0
    counts, kinds = counted(rig, result.seen, criterion, [s.name for s in rig])
    spare = int(requirement.under.one_lost)
    wanted = criterion.sensors + spare + criterion.kinds
    has = np.minimum(counts, criterion.sensors + spare) + np.minimum(kinds, criterion.kinds)
    lacks = 1.0 - float(has.mean()) / wanted
    fails = 1.0 - share / criterion.zone_share
    away = _turned_away(requirement, samples.points[~result.passed & inside], rig)
    return SHARE_WEIGHT * fails + LACKING_WEIGHT * lacks + AWAY_WEIGHT * away


def _turned_away(requirement: Requirement, points: Floats, rig: Rig) -> float:
    """Return the mean angle between points (N, 2) and the nearest boresight, 1 for 180 deg."""
    sensors = [s for s in rig if requirement.criterion.counts(s.kind)]
    if not sensors or not len(points):
        return 1.0
    body, cosines = requirement.bodies[0], []
    places = np.column_stack([points, np.full(len(points), body.low + body.size[2] / 2.0)])
    for sensor in sensors:
        x, y, z = (places - np.asarray(sensor.pose.position)).T
        ahead = sensor.pose.ground_from_sensor[:, 0]
        length = np.sqrt(x * x + y * y + z * z)
        along = ahead[0] * x + ahead[1] * y + ahead[2] * z
        cosines.append(along / np.maximum(length, INSIDE_M))
    nearest = np.clip(np.max(cosines, axis=0), -1.0, 1.0)
    angles = [math.acos(c) for c in nearest.tolist()]  # the same bits in all builds
    return sum(angles) / len(angles) / math.pi
