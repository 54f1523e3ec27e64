"""A reach as a closed line on the ground: what views and pages draw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .reach import Reach

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

AT_LEAST_M = 0.5
"""A reach nearer than this to where was looked ends there: it is at least that far."""
ARC_STEPS = 12
"""Points along the arc of a sector."""


@dataclass(frozen=True, slots=True, eq=False)
class ReachLine:
    """`points` (N, 2) [m], the last one beside the first, and where they are `at_least` (N,)."""

    points: Floats
    at_least: Flags


def reach_line(found: Reach, distance: Floats) -> ReachLine:
    """Return the line of some distances (B,) of a reach, those of the rig or of one sensor.

    Reaches along bearings are weighed with their neighbours 1 2 1: what beams leave is ragged. A
    reach of sectors is an arc for each.
    """
    at_least = ends_with_space(found, distance)
    bearings = found.bearings
    if found.sector:
        aside = (np.arange(ARC_STEPS) / (ARC_STEPS - 1) - 0.5) * found.sector
        bearings = np.add.outer(bearings, aside).reshape(-1)
        distance, at_least = np.repeat(distance, ARC_STEPS), np.repeat(at_least, ARC_STEPS)
    else:
        round_ = (np.roll(distance, 1) + 2.0 * distance + np.roll(distance, -1)) / 4.0
        distance = np.where(at_least, distance, round_)
    points = np.stack([distance * np.cos(bearings), distance * np.sin(bearings)], axis=1)
    return ReachLine(points, at_least)


def ends_with_space(found: Reach, distance: Floats) -> Flags:
    """Whether reaches (B,) end where was looked: they are at least so far."""
    return np.asarray(distance >= found.limit - AT_LEAST_M)
