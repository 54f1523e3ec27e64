"""What a search cost: everything that its result is worse in than its start, in one sentence."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pe_core.scoring.score import Score

from ..wording import joined
from .score_comparison import AP, BLIND, COVERAGE, ENTROPY, MIN_CHANGE
from .summary_text import WHERE

ZONES_NAMED = 2
NOTHING = "It cost nothing"


def search_cost(before: Score, after: Score, blind_m2: tuple[float, float]) -> str:
    """Return one sentence: what got worse by a search, or that nothing did.

    Parameters
    ----------
    before, after : Score
        Of start and result.
    blind_m2 : (float, float)
        Blind ground of start and result [m2] (`blind_area`).
    """
    losses = list(_losses(before, after, blind_m2))
    if losses:
        return f"It cost {joined(losses)}"
    rest = "coverage and all zones are no worse"
    return f"{NOTHING}: blind ground {_areas(blind_m2)}, {rest}"


def costs_nothing(cost: str) -> bool:
    """Whether a sentence of `search_cost` says that nothing got worse."""
    return cost.startswith(NOTHING)


def _losses(before: Score, after: Score, blind_m2: tuple[float, float]) -> Iterator[str]:
    if blind_m2[1] > blind_m2[0] + MIN_CHANGE[BLIND]:
        yield f"blind ground ({_areas(blind_m2)})"
    if before.coverage - after.coverage >= MIN_CHANGE[COVERAGE]:
        yield f"coverage ({before.coverage:.1%} to {after.coverage:.1%})"
    if before.objects is not None and after.objects is not None:
        if before.objects.ap - after.objects.ap >= MIN_CHANGE[AP]:
            yield f"expected AP ({before.objects.ap:.3f} to {after.objects.ap:.3f})"
    elif after.entropy - before.entropy >= MIN_CHANGE[ENTROPY]:
        yield f"entropy ({before.entropy:.3f} to {after.entropy:.3f} nats)"
    worse = {
        name: (zone.entropy, after.per_zone[name].entropy)
        for name, zone in before.per_zone.items()
        if name in after.per_zone
        and after.per_zone[name].entropy - zone.entropy >= MIN_CHANGE[ENTROPY]
    }
    most = sorted(worse, key=lambda name: worse[name][0] - worse[name][1])[:ZONES_NAMED]
    for name in most:
        first, last = worse[name]
        yield f"sight {WHERE.get(name, name)} ({first:.2f} to {last:.2f} nats)"


def _areas(blind_m2: tuple[float, float]) -> str:
    """Return "24.1 to 53.0 m2", rounded up."""
    before, after = (math.ceil(area * 10.0 - 1e-6) / 10.0 for area in blind_m2)
    return f"{before:.1f} to {after:.1f} m2"
