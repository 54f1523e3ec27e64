"""Several scores side by side: a table of what differs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ..scoring.score import PartScore, Score

ENTROPY, COVERAGE, AP, REACH = "entropy", "coverage", "ap", "reach"
AHEAD = "front"
"""The direction whose reach is put side by side."""


@dataclass(frozen=True, slots=True)
class ComparedRow:
    """A figure of several rigs.

    Attributes
    ----------
    group : {"rig", "zone", "class"}
    name : str
        Which zone or class; empty for the rig itself.
    measure : {"entropy", "coverage", "ap", "reach"}
        Entropy [nats], lower is better. Higher is better of coverage, 0 to 1, and of scores on
        objects of expected AP, 0 to 1, and of reach ahead [m].
    values : tuple of float or None
        In the order of the scores; None where one has no such zone or class.
    differences : tuple of float or None
        Value less the first one's.
    best : tuple of bool
        Which are the best; none where all are alike.
    """

    group: str
    name: str
    measure: str
    values: tuple[float | None, ...]
    differences: tuple[float | None, ...]
    best: tuple[bool, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return asdict(self)


def compare(scores: Mapping[str, Score]) -> tuple[ComparedRow, ...]:
    """Put scores side by side: the rigs, then every zone and class, entropy and coverage of each.

    Parameters
    ----------
    scores : mapping of name to Score
        In the order of the columns; differences are from the first.
    """
    return tuple(_rows(list(scores.values())))


def _rows(scores: list[Score]) -> Iterator[ComparedRow]:
    for measure in (ENTROPY, COVERAGE):
        yield _row("rig", "", measure, [getattr(score, measure) for score in scores])
    yield from _parts("zone", scores, lambda score: score.per_zone)
    yield from _parts("class", scores, lambda score: score.per_class)
    yield from _found(scores)


def _found(scores: list[Score]) -> Iterator[ComparedRow]:
    """Yield expected AP of all and each class, and the reach ahead, where objects were scored."""
    objects = [score.objects for score in scores]
    each = [{} if found is None else found.per_class for found in objects]
    names = dict.fromkeys(name for own in each for name in own)
    if names:
        yield _row("rig", "", AP, [None if found is None else found.ap for found in objects])
    for name in names:
        yield _row("class", name, AP, [own[name].ap if name in own else None for own in each])
    for name in names:
        ahead = [own[name].reach[AHEAD] if name in own else None for own in each]
        yield _row("class", name, REACH, ahead)


def _parts(
    group: str, scores: list[Score], parts_of: Callable[[Score], dict[str, PartScore]]
) -> Iterator[ComparedRow]:
    parts = [parts_of(score) for score in scores]
    for name in dict.fromkeys(name for each in parts for name in each):
        for measure in (ENTROPY, COVERAGE):
            own = [getattr(each[name], measure) if name in each else None for each in parts]
            yield _row(group, name, measure, own)


def _row(group: str, name: str, measure: str, values: list[float | None]) -> ComparedRow:
    first = values[0] if values else None
    less = [None if v is None or first is None else v - first for v in values]
    return ComparedRow(group, name, measure, tuple(values), tuple(less), _best(measure, values))


def _best(measure: str, values: list[float | None]) -> tuple[bool, ...]:
    """Mark the best of the values that are there, unless they are alike."""
    there = [v for v in values if v is not None]
    if len(set(there)) < 2:
        return (False,) * len(values)
    best = min(there) if measure == ENTROPY else max(there)
    return tuple(v == best for v in values)
