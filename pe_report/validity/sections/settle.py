"""What experiment would settle it, and what it would cost."""

from __future__ import annotations

import math

from ...words import table
from ..facts import ValidityFacts

RHO = (0.3, 0.5, 0.7, 0.9)
Z_TWO_SIDED, Z_POWER = 1.959964, 0.841621
"""Normal quantiles: 5 % two-sided, and to be found four times out of five."""
SPEARMAN_VARIANCE = 1.06
"""Variance of Fisher's z of Spearman's rho, times n - 3 (Fieller, Hartley and Pearson 1957)."""
HOURS = 10
SEEDS, DETECTORS = 3, 2


def settle(facts: ValidityFacts) -> str:
    """Return what experiment would settle it."""
    lines = [
        [f"{rho:g}", str(placements_for(rho)), f"{runs(rho)}", f"{runs(rho) * HOURS:,}"]
        for rho in RHO
    ]
    titles = ["rho that is there", "placements", "trainings", "GPU hours, at 10 each"]
    return f"""
## What would settle it

More placements, not more detectors. To tell a rank correlation from chance (5 %, two-sided) four
times out of five, by Fisher's z with a variance of 1.06/(n - 3), takes:

{table(titles, lines)}

- **Which placements**: drawn so that height, spread of the LiDARs over the roof, and number of beams on
objects do not go together (a Latin hypercube over them, roof, fenders and bumpers, rolled and level);
a quarter of them in pairs that perception entropy and object entropy rank in opposite order.
- **Which runs**: {DETECTORS} detectors, {SEEDS} seeds each, on the same logs for every placement, so that the scatter
of a training run is known; the published tables have one run each. Two sensors as well as four.
- **What is written down first**: the score of every placement, one primary class, one test.
- **Cost**: trainings in the table are placements x {DETECTORS} detectors x {SEEDS} seeds. Neither paper says what a training
took; {HOURS} GPU hours is our assumption, and the last column follows from it. The data are rendered once a
placement: CARLA replays the same routes with other sensors.
"""


def placements_for(rho: float) -> int:
    """Return how many placements tell a rank correlation from chance four times out of five."""
    needed = ((Z_TWO_SIDED + Z_POWER) / math.atanh(rho)) ** 2
    return 3 + math.ceil(SPEARMAN_VARIANCE * needed)


def runs(rho: float) -> int:
    """Return how many trainings that takes."""
    return placements_for(rho) * DETECTORS * SEEDS
