"""Where a search could have ended: optima that are apart from its result, by the hill-valley test.
The archive of the search keeps the best placement of each neighbourhood. Two placements are in one
basin if no placement on the straight line between them is worse than both (Ursem, "Multinational
evolutionary algorithms", 1999). Here the line is taken in the design variables and projected onto
the mounts."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

from pe_core.base.values import degrees_in_file, rounded
from pe_core.scene.rig import Rig
from pe_core.scoring.score import SURE
from pe_core.search import Parametrization
from pe_core.search.search_space import SearchSpace
from pe_core.study.requirement_search import is_infeasible

from .flatness import NOTICED, StepCosts

APART_M, APART_RAD = 0.15, math.radians(6.0)
"""Placements are in one neighbourhood if no sensor is farther away or turned more than this."""
KEPT = 48  # Neighbourhoods that are kept for each level of the search
MAX_RUNNERS_UP = 3
EXAMINED = 16  # Placements of the archive that are evaluated, the best first
BETWEEN = (0.25, 0.5, 0.75)
"""Shares of the way between two placements at which a hill is looked for."""


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
    """Keeps the best placement of each neighbourhood, by level. The content follows from what the
    search was told, in its order: a search that resumes from its journal fills its archive with the
    same placements."""

    def __init__(self) -> None:
        self._levels: dict[int, list[tuple[float, Rig]]] = {}

    def note(self, rig: Rig, level: int, value: float) -> None:
        """Keep a placement if it is the best of its neighbourhood."""
        if is_infeasible(value):  # or not below the best so far
            return
        kept = self._levels.setdefault(level, [])
        if len(kept) == KEPT and value >= kept[-1][0]:
            return
        for known, other in kept:
            if known <= value and is_near(rig, other):
                return
        better = [each for each in kept if each[0] <= value or not is_near(rig, each[1])]
        better.append((value, rig))
        better.sort(key=lambda each: each[0])
        self._levels[level] = better[:KEPT]

    def placements(self) -> Iterator[Rig]:
        """Yield the placements kept: the best first, one level after the other, finest first."""
        for level in sorted(self._levels, reverse=True):
            yield from (rig for _, rig in self._levels[level])


@dataclass(frozen=True, slots=True)
class RunnerUp:
    """An optimum that the search did not choose, behind its result by so much [nats], with a
    standard error. Sensors that `moved` are elsewhere than in the result."""

    rig: Rig
    behind: float
    moved: tuple[str, ...]
    stderr: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "behind": rounded(self.behind),
            "stderr": rounded(self.stderr),
            "moved": list(self.moved),
            "placements": {
                s.name: {
                    "position": list(s.pose.position),
                    "rotation": [degrees_in_file(angle) for angle in s.pose.rpy],
                }
                for s in self.rig
            },
        }


@dataclass(frozen=True, slots=True)
class Endings:
    """Where the starts of a search ended. So many placements apart from the result were `examined`;
    `same_basin` of them lead to the result without a hill between. Runners-up are other optima, the
    best first."""

    examined: int
    same_basin: int
    runners_up: tuple[RunnerUp, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "examined": self.examined,
            "same_basin": self.same_basin,
            "runners_up": [each.to_dict() for each in self.runners_up],
        }


class Basins:
    """Sorts placements into basins of attraction."""

    def __init__(self, samples: StepCosts, space: SearchSpace) -> None:
        self._samples = samples
        self._space = space
        self._coding = Parametrization(samples.reference, space)
        self._error = 0.0

    def endings(self, placements: Iterator[Rig]) -> Endings:
        """Return the optima apart from the reference among placements of a search."""
        apart = self._apart(placements)
        self._samples.evaluate(apart)
        apart.sort(key=self._samples.change)
        self._error = self._samples.error(apart)
        ways = (self._between(rig, self._samples.reference) for rig in apart)
        self._samples.evaluate(chain.from_iterable(way for way in ways if way))
        found: list[Rig] = []
        same = 0
        for rig in apart:
            if not self._is_separate(rig, [self._samples.reference]):
                same += 1
            elif len(found) < MAX_RUNNERS_UP and self._is_separate(rig, found):
                found.append(rig)
        runners_up = []
        for rig in found:
            moved = tuple(s.name for s in rig if s.pose != self._samples.reference[s.name].pose)
            runners_up.append(RunnerUp(rig, self._samples.change(rig), moved, self._error))
        runners_up.sort(key=lambda each: each.behind)
        return Endings(len(apart), same, tuple(runners_up))

    def _apart(self, placements: Iterator[Rig]) -> list[Rig]:
        """Return the first placements that are in no other one's neighbourhood."""
        apart: list[Rig] = []
        for rig in placements:
            if len(apart) == EXAMINED:
                break
            if not any(is_near(rig, other) for other in (self._samples.reference, *apart)):
                apart.append(rig)
        return apart

    def _is_separate(self, rig: Rig, others: Sequence[Rig]) -> bool:
        """Whether there is a hill between a placement and each of the others."""
        return all(self._has_hill(rig, other) for other in others)

    def _has_hill(self, one: Rig, other: Rig) -> bool:
        if is_near(one, other):
            return False
        worse = one if self._samples.change(one, other) > 0.0 else other
        way = self._between(one, other)
        if way is None:
            return True
        self._samples.evaluate(way)
        hill = max(NOTICED * self._samples.steep, SURE * self._error)
        return any(self._samples.change(rig, worse) > hill for rig in way)

    def _between(self, one: Rig, other: Rig) -> list[Rig] | None:
        """Return placements on the way; None if one of them breaks a rule."""
        first, last = (Parametrization(r, self._space).start.vector for r in (one, other))
        way = []
        for share in BETWEEN:
            vector = [a + share * (b - a) for a, b in zip(first, last, strict=True)]
            rig = self._coding.candidate(vector).rig
            if not self._coding.allowed(rig):
                return None
            way.append(rig)
        return way
