"""Margins: how far a zone could grow before a requirement fails, or would have to shrink.

All figures err to the safe side: a step is taken off, and they are rounded down to the centimetre.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...base.arrays import Flags, Floats
from .zones import INSIDE_M, PlacedZone

DECIMALS = 2
"""Margins are rounded to the centimetre, to the safe side."""
FARTHEST_M = 10.0
"""Zones are grown no farther than this."""


def growth(zone: PlacedZone) -> Iterator[float]:
    """Yield how far a zone is grown, time after time [m]: each twice as far as the one before."""
    grown = zone.grow
    while grown < FARTHEST_M:
        grown = min(2.0 * grown, FARTHEST_M)
        yield grown


def margin_of(
    distance: Floats, passed: Flags, wanted: float, step: float, looked: float
) -> tuple[float, bool]:
    """Return how far a zone could grow [m] before it fails, and whether it could grow farther.

    A zone that is grown by d has all samples with a distance of at most d. Negative: how far a zone
    that fails would have to shrink. Between two samples nothing is known, so a step is taken off,
    and figures are rounded down.

    The `distance` (N,) of samples to the zone is negative inside [m]; a share of `wanted` of them
    has to be `passed` (N,). Samples are a `step` apart, and reach as far as was `looked` [m].
    """
    order = np.argsort(distance, kind="stable")
    away, ok = distance[order], passed[order]
    share = np.cumsum(ok) / np.arange(1, len(ok) + 1)
    last = np.append(away[1:] - away[:-1] > INSIDE_M, True)  # the last sample at its distance
    away, share = away[last], share[last]
    fails = share < wanted
    grown = away > INSIDE_M
    inner = away[~grown]
    if len(inner) and not fails[~grown][-1]:
        first = np.flatnonzero(fails & grown)
        if not len(first):
            return rounded_down(looked), True
        return max(0.0, rounded_down(float(away[first[0]]) - step)), False
    met = np.flatnonzero(~fails & ~grown)
    inward = float(away[met[-1]]) if len(met) else float(inner[0]) - step
    return min(rounded_down(inward), -rounded_down(step)), False


def rounded_down(value: float) -> float:
    """Round down to the centimetre."""
    return math.floor(value * 10**DECIMALS + 1e-6) / 10**DECIMALS
