"""Several scores side by side: a table of what differs, and of what only seems to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from ..scoring.score import PartScore, Score
from .certainty import LEAST, degrees_of, difference_errors, sure_factor
from .key_figures import KeyFigures

ENTROPY, COVERAGE, AP, REACH, BLIND = "entropy", "coverage", "ap", "reach", "blind"
LOWER_IS_BETTER = frozenset({ENTROPY, BLIND})
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
    measure : {"entropy", "coverage", "ap", "reach", "blind"}
        Entropy [nats] and blind ground [m2], lower is better. Higher is better of coverage and of
        expected AP, 0 to 1, and of reach ahead [m].
    values : tuple of float or None
        In the order of the scores; None where one has no such zone or class.
    differences : tuple of float or None
        Value less the first one's.
    best : tuple of bool
        Which are the best: the best value, and those not clearly worse; none where no value is
        clearly worse than the best one.
    errors : tuple of tuple of float
        Standard error of the difference between each two of them; 0 where nothing is sampled.
    factor : float
        A difference is clear beyond so many standard errors (`certainty.sure_factor`).
    """

    group: str
    name: str
    measure: str
    values: tuple[float | None, ...]
    differences: tuple[float | None, ...]
    best: tuple[bool, ...]
    errors: tuple[tuple[float, ...], ...]
    factor: float

    @property
    def lower_is_better(self) -> bool:
        """Whether it is an entropy, or blind ground."""
        return self.measure in LOWER_IS_BETTER

    @property
    def order(self) -> tuple[int, ...]:
        """Which have a value, the best first."""
        sign = 1.0 if self.lower_is_better else -1.0
        there = [(sign * v, k) for k, v in enumerate(self.values) if v is not None]
        return tuple(k for _, k in sorted(there))

    @property
    def winner(self) -> int | None:
        """The one that is clearly better than all others; None where there is none."""
        return self.best.index(True) if sum(self.best) == 1 else None

    def differ(self, one: int, other: int) -> bool:
        """Whether two of the values are clearly different; False where one is missing."""
        return _differ(self.measure, self.values, self.errors, self.factor, one, other)

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


def compare_figures(figures: Mapping[str, KeyFigures]) -> tuple[ComparedRow, ...]:
    """Put key figures side by side: blind ground, and of one class reach ahead and expected AP.

    No AP is marked as the best: it is of a sample, and the error of a difference is not known.

    Parameters
    ----------
    figures : mapping of name to KeyFigures
        In the order of the columns, all of one height and one class; differences are from the
        first.
    """
    found = list(figures.values())
    if not found:
        return ()
    what = f"{found[0].height:g} m tall, within {found[0].within:g} m"
    rows = [_exact_row("rig", what, BLIND, [f.blind_m2 for f in found])]
    if (name := found[0].class_name) is not None:
        rows.append(_exact_row("class", name, REACH, [f.reach_m for f in found]))
        ap = _exact_row("class", name, AP, [f.expected_ap for f in found])
        rows.append(replace(ap, best=(False,) * len(found)))
    return tuple(rows)


def _exact_row(group: str, name: str, measure: str, values: Sequence[float | None]) -> ComparedRow:
    """Return a row of figures without an error."""
    errors = ((0.0,) * len(values),) * len(values)
    best = _best(measure, values, errors, 0.0)
    return ComparedRow(group, name, measure, tuple(values), _less(values), best, errors, 0.0)


def _less(values: Sequence[float | None]) -> tuple[float | None, ...]:
    """Each value less the first one; None where one of the two is missing."""
    first = values[0] if values else None
    return tuple(None if v is None or first is None else v - first for v in values)


def _rows(scores: list[Score]) -> Iterator[ComparedRow]:
    for measure in (ENTROPY, COVERAGE):
        own = [getattr(score, measure) for score in scores]
        yield _row(scores, "rig", "", measure, own)
    yield from _parts("zone", scores, lambda score: score.per_zone)
    yield from _parts("class", scores, lambda score: score.per_class)
    yield from _found(scores)


def _found(scores: list[Score]) -> Iterator[ComparedRow]:
    """Yield expected AP of all and each class, and the reach ahead, where objects were scored."""
    objects = [score.objects for score in scores]
    each = [{} if found is None else found.per_class for found in objects]
    names = dict.fromkeys(name for own in each for name in own)
    if names:
        whole = [None if found is None else found.ap for found in objects]
        yield _row(scores, "rig", "", AP, whole)
    for name in names:
        own = [own[name].ap if name in own else None for own in each]
        yield _row(scores, "class", name, AP, own)
    for name in names:
        ahead = [own[name].reach[AHEAD] if name in own else None for own in each]
        yield _row(scores, "class", name, REACH, ahead)


def _parts(
    group: str, scores: list[Score], parts_of: Callable[[Score], dict[str, PartScore]]
) -> Iterator[ComparedRow]:
    parts = [parts_of(score) for score in scores]
    for name in dict.fromkeys(name for each in parts for name in each):
        for measure in (ENTROPY, COVERAGE):
            own = [getattr(each[name], measure) if name in each else None for each in parts]
            yield _row(scores, group, name, measure, own)


def _row(
    scores: list[Score], group: str, name: str, measure: str, values: list[float | None]
) -> ComparedRow:
    errors = difference_errors(scores, (group, name, measure))
    factor = sure_factor(len(scores), degrees_of(scores))
    best = _best(measure, values, errors, factor)
    return ComparedRow(group, name, measure, tuple(values), _less(values), best, errors, factor)


def _best(
    measure: str,
    values: Sequence[float | None],
    errors: Sequence[Sequence[float]],
    factor: float,
) -> tuple[bool, ...]:
    """Mark the best and what is not clearly worse; nothing where that is all there is."""
    sign = 1.0 if measure in LOWER_IS_BETTER else -1.0
    there = [(sign * v, k) for k, v in enumerate(values) if v is not None]
    if not there:
        return (False,) * len(values)
    first = min(there)[1]
    alike = {k for _, k in there if not _differ(measure, values, errors, factor, first, k)}
    return tuple(k in alike and len(alike) < len(there) for k in range(len(values)))


def _differ(
    measure: str,
    values: Sequence[float | None],
    errors: Sequence[Sequence[float]],
    factor: float,
    one: int,
    other: int,
) -> bool:
    a, b = values[one], values[other]
    least = max(LEAST[measure], factor * errors[one][other])
    return a is not None and b is not None and abs(a - b) > least
