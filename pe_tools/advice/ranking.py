"""Several rigs in sentences: which is better overall, by zone and class, and what a search cost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from pe_core.scene.rig import Rig
from pe_core.scoring.score import Score

from ..wording import degrees, joined, metres
from .key_figures import KeyFigures
from .location import WAYS
from .score_comparison import AP, BLIND, COVERAGE, ENTROPY, MIN_CHANGE, SECTOR, TRAFFIC, ComparedRow
from .summary_text import WHERE

MAX_PAIRS = 3
"""Up to this number, pairs that are alike behind the best are named; of more, only the number."""
ZONES_NAMED = 2
SENSORS_NAMED = 3
NOTHING = "It cost nothing"


class _Measure(NamedTuple):
    """How a measure is called, its units after a value and after a difference, its decimals."""

    noun: str
    unit: str
    unit_of_gap: str
    digits: int
    wins: str


RANKED = {
    ENTROPY: _Measure("entropy", " nats", " nats", 2, "is better by entropy"),
    COVERAGE: _Measure("coverage", "", " points", 1, "sees more"),
    AP: _Measure("expected AP", "", "", 3, "has the highest expected AP"),
}


@dataclass(frozen=True, slots=True)
class Notation:
    """How the sentences write figures.

    `number` formats a number with a number of decimals, `share` a share, 0 to 1, in percent;
    `plus_minus` is the sign before a standard error.
    """

    number: Callable[[float, int], str] = lambda value, digits: f"{value:.{digits}f}"
    share: Callable[[float], str] = lambda share: f"{100.0 * share:.1f}%"
    plus_minus: str = "+-"


PLAIN = Notation()


def ranking(
    names: Sequence[str], rows: Sequence[ComparedRow], notation: Notation = PLAIN
) -> tuple[str, ...]:
    """Describe which of several rigs is better overall: by entropy, by coverage, by AP.

    `names` are those of the rigs in the order of the values of `rows`, the result of `compare`. The
    result is a paragraph for each measure; none for fewer than two rigs.
    """
    whole = {row.measure: row for row in rows if row.group == "rig"}
    if len(names) < 2:
        return ()
    return tuple(
        " ".join(_RankingSentences(names, whole[m], notation).sentences())
        for m in RANKED
        if m in whole
    )


def win_words(names: Sequence[str], rows: Sequence[ComparedRow]) -> tuple[str, ...]:
    """Return a sentence for each rig and measure with a zone or class in which the rig is the best.

    Only significant differences count. The parameters are those of `ranking`.
    """
    if len(names) < 2:
        return ()
    return tuple(
        f"{name} {words.wins} {where}."
        for k, name in enumerate(names)
        for measure, words in RANKED.items()
        if (where := _where(rows, measure, k))
    )


def _where(rows: Sequence[ComparedRow], measure: str, k: int) -> str:
    """Return the zones and classes in which rig `k` wins: "ahead and behind; for car and truck"."""
    texts = []
    for group, all_text in (("zone", "in every zone"), ("class", "for every class")):
        rows_of_group = [row for row in rows if (row.group, row.measure) == (group, measure)]
        won = [WHERE.get(row.name, row.name) for row in rows_of_group if row.winner == k]
        if won and len(won) == len(rows_of_group) > 1:
            texts.append(all_text)
        elif won:
            texts.append(f"{'for ' if group == 'class' else ''}{joined(won)}")
    return "; ".join(texts)


class _RankingSentences:
    """The sentences about one figure of several rigs."""

    def __init__(self, names: Sequence[str], row: ComparedRow, notation: Notation) -> None:
        self._names, self._row, self._notation = names, row, notation
        self._words, self._in_percent = RANKED[row.measure], row.measure == COVERAGE

    def sentences(self) -> Iterator[str]:
        """Yield the best rigs, how much worse the others are, and the pairs that are alike."""
        names, row, order = self._names, self._row, self._row.order
        if len(order) < 2:
            return
        best = [k for k in order if not row.differ(order[0], k)]
        rest = [k for k in order if k not in best]
        yield f"Overall {self._leaders(best, bool(rest))}."
        for i, j in combinations(best, 2):
            if row.differ(i, j):
                yield f"{names[j]} is worse than {names[i]}, by {self._gap(i, j)}."
        if rest:
            gaps = [f"{names[k]} by {self._gap(best[0], k)}" for k in rest]
            than = f" than {names[best[0]]}" if len(best) > 1 else ""
            yield f"Worse{than}: {joined(gaps)}."
        alike = [(i, j) for i, j in combinations(order, 2) if j in rest and not row.differ(i, j)]
        if len(alike) > MAX_PAIRS:
            yield f"{len(alike)} other pairs are alike."
        elif alike:
            pairs = "; ".join(f"{names[i]} and {names[j]}" for i, j in alike)
            yield f"Alike are also {pairs}."

    def _leaders(self, best: Sequence[int], has_rest: bool) -> str:
        row, leaders, words = self._row, [self._names[k] for k in best], self._words
        values = [value for k in best if (value := row.values[k]) is not None]
        share, number = self._notation.share, self._notation.number
        texts = [share(v) if self._in_percent else number(v, words.digits) for v in values]
        figures = f"{joined(texts)}{words.unit}"
        better = f"{'lower' if row.lower_is_better else 'higher'} is better"
        if len(leaders) == 1:
            return f"{leaders[0]} is best by {words.noun}: {figures}, {better}"
        also = ", and better than the others" if has_rest else ""
        if error := max(row.errors[i][j] for i in best for j in best):
            subject = "the difference" if len(best) == 2 else "a difference at most"
            shown = f"{self._difference(error)}{words.unit_of_gap}"
            better = f"{better}; standard error of {subject} {shown}"
        return f"{joined(leaders)} are alike by {words.noun}{also}: {figures}, {better}"

    def _gap(self, one: int, other: int) -> str:
        a, b = self._row.values[one], self._row.values[other]
        assert a is not None and b is not None
        error = self._row.errors[one][other]
        error_text = f" {self._notation.plus_minus} {self._difference(error)}" if error else ""
        return f"{self._difference(abs(a - b))}{error_text}{self._words.unit_of_gap}"

    def _difference(self, value: float) -> str:
        """Format a difference or an error, of shares in percentage points. A value that would be
        shown as 0 is rounded up to the last digit."""
        digits = self._words.digits
        shown = 100.0 * value if self._in_percent else value
        return self._notation.number(max(shown, 10.0**-digits) if shown else 0.0, digits)


def disagreement(names: Sequence[str], rows: Sequence[ComparedRow]) -> str:
    """Return one sentence where the three figures prefer different rigs; empty where one is best.

    The figures are entropy, expected AP in traffic, and the widest blind sector for the lowest
    body. `rows` are those of `compare` and of `compare_figures`. Rigs that do not differ clearly
    from the best one are as good as it.
    """
    entropy = (row for row in rows if (row.group, row.measure) == ("rig", ENTROPY))
    traffic = (row for row in rows if (row.group, row.name) == (TRAFFIC, ""))
    sector = (row for row in rows if row.measure == SECTOR)
    best = {}
    for called, found in (
        ("entropy", entropy),
        ("expected AP in traffic", traffic),
        ("the widest blind sector", sector),
    ):
        if (row := next(found, None)) is not None and row.order:
            best[called] = [k for k in row.order if not row.differ(row.order[0], k)]
    if not best or set.intersection(*map(set, best.values())):
        return ""
    told = [f"{joined([names[k] for k in own])} by {called}" for called, own in best.items()]
    return f"The figures disagree: best is {', '.join(told)}."


def moved_words(before: Rig, after: Rig) -> str:
    """Return which sensors moved, and how: "roof 8 cm up, rear 1.20 m ahead and turned 12 deg"."""
    moved = []
    for sensor in after:
        old, pose = before[sensor.name].pose, sensor.pose
        if pose == old:
            continue
        steps = [b - a for a, b in zip(old.position, pose.position, strict=True)]
        axis = max(range(3), key=lambda k: abs(steps[k]))
        ways = [f"{metres(abs(steps[axis]))} {WAYS[axis][steps[axis] < 0.0]}"] * any(steps)
        angles = zip(old.rotation_deg, pose.rotation_deg, strict=True)
        turned = max(abs(math.remainder(a - b, 360.0)) for a, b in angles)
        ways += [f"turned {turned:.0f} deg"] * (turned >= 0.5)
        moved.append(f"{sensor.name} {' and '.join(ways)}" if ways else sensor.name)
    others = len(moved) - SENSORS_NAMED
    return joined([*moved[:SENSORS_NAMED], *[f"{others} others"] * (others > 0)])


def gain_sentence(before: Rig, after: Rig, start: KeyFigures, result: KeyFigures) -> str:
    """Return the move from a rig to another, its gain and its error, in one sentence.

    The gain is that of the expected AP in traffic by distance. The error is the largest standard
    error of these, so that of a difference is smaller. Empty without a move or such an AP.
    """
    if start.traffic is None or result.traffic is None or before == after:
        return ""
    first, last = start.traffic.rings, result.traffic.rings
    rings = [f"{name} {first[name][0]:.2f} to {ap:.2f}" for name, (ap, _) in last.items()]
    error = max(each for _, each in last.values())
    told = f"expected AP in traffic {', '.join(rings)} (+- {math.ceil(100.0 * error) / 100.0:.2f})"
    return f"{moved_words(before, after)}: {told}"


def search_cost(before: Score, after: Score, start: KeyFigures, result: KeyFigures) -> str:
    """Return one sentence on what a search made worse, or that nothing is.

    `start` and `result` are the key figures of the rigs with the scores `before` and `after`.
    """
    losses, areas = [], _areas(start.blind_m2, result.blind_m2)
    if result.blind_m2 > start.blind_m2 + MIN_CHANGE[BLIND]:
        losses.append(f"blind ground ({areas})")
    for one, other in zip(start.sectors, result.sectors, strict=True):
        if other.width > one.width + MIN_CHANGE[SECTOR]:
            widths = f"{degrees(one.width)} to {degrees(other.width)}"
            losses.append(f"the widest blind sector for what is {one.height:g} m tall ({widths})")
    first, last = (0.0 if f.traffic is None else f.traffic.ap for f in (start, result))
    if first - last >= MIN_CHANGE[AP]:
        losses.append(f"expected AP in traffic ({first:.3f} to {last:.3f})")
    if before.coverage - after.coverage >= MIN_CHANGE[COVERAGE]:
        losses.append(f"coverage ({before.coverage:.1%} to {after.coverage:.1%})")
    if before.objects is not None and after.objects is not None:
        if before.objects.ap - after.objects.ap >= MIN_CHANGE[AP]:
            losses.append(f"expected AP ({before.objects.ap:.3f} to {after.objects.ap:.3f})")
    elif after.entropy - before.entropy >= MIN_CHANGE[ENTROPY]:
        losses.append(f"entropy ({before.entropy:.3f} to {after.entropy:.3f} nats)")
    rises = {
        name: after.per_zone[name].entropy - zone.entropy
        for name, zone in before.per_zone.items()
        if name in after.per_zone
    }
    worse = [name for name, rise in rises.items() if rise >= MIN_CHANGE[ENTROPY]]
    for name in sorted(worse, key=lambda name: -rises[name])[:ZONES_NAMED]:
        first, last = before.per_zone[name].entropy, after.per_zone[name].entropy
        losses.append(f"sight {WHERE.get(name, name)} ({first:.2f} to {last:.2f} nats)")
    if losses:
        return f"It cost {joined(losses)}"
    rest = "blind sectors, expected AP in traffic, coverage and all zones are no worse"
    return f"{NOTHING}: blind ground {areas}, {rest}"


def costs_nothing(cost: str) -> bool:
    """Whether a sentence of `search_cost` says that nothing got worse."""
    return cost.startswith(NOTHING)


def _areas(before_m2: float, after_m2: float) -> str:
    """Return "24.1 to 53.0 m2", rounded up."""
    before, after = (math.ceil(area * 10.0 - 1e-6) / 10.0 for area in (before_m2, after_m2))
    return f"{before:.1f} to {after:.1f} m2"
