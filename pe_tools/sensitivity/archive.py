"""The archive of a search: placements that it evaluated exactly, the best of each neighbourhood."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pe_core.scene.rig import Rig
from pe_core.scoring.score import Evaluation
from pe_core.study.requirement_search import is_infeasible

APART_M, APART_RAD = 0.15, math.radians(6.0)
"""Placements are in one neighbourhood if no sensor is farther away or turned more than this."""
KEPT = 48
"""Neighbourhoods that are kept for each level of the search."""


def is_near(one: Rig, other: Rig) -> bool:
    """Whether two placements are in one neighbourhood."""
    return all(
        math.dist(a.pose.position, b.pose.position) <= APART_M
        and all(
            abs(math.remainder(p - q, math.tau)) <= APART_RAD
            for p, q in zip(a.pose.rpy, b.pose.rpy, strict=True)
        )
        for a, b in zip(one, other, strict=True)
    )


class Archive:
    """Keeps the best placement of each neighbourhood, by level; lower bounds are not kept.

    The content follows from what the search was told, in its order: a search that resumes from its
    journal fills its archive with the same placements.
    """

    def __init__(self) -> None:
        self._levels: dict[int, list[tuple[float, Rig]]] = {}

    def note(self, rig: Rig, level: int, value: Evaluation) -> None:
        """Keep a placement if it is the best of its neighbourhood."""
        if value.is_lower_bound or is_infeasible(value.entropy):
            return
        kept = self._levels.setdefault(level, [])
        if len(kept) == KEPT and value.entropy >= kept[-1][0]:
            return
        for known, other in kept:
            if known <= value.entropy and is_near(rig, other):
                return
        better = [each for each in kept if each[0] <= value.entropy or not is_near(rig, each[1])]
        better.append((value.entropy, rig))
        better.sort(key=lambda each: each[0])
        self._levels[level] = better[:KEPT]

    def placements(self) -> Iterator[Rig]:
        """Yield the placements kept: the best first, one level after the other, finest first."""
        for level in sorted(self._levels, reverse=True):
            yield from (rig for _, rig in self._levels[level])
