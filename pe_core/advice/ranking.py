"""Which of several rigs is better, in sentences: overall, and where."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from .figures import joined
from .phrases import WHERE
from .side_by_side import AP, COVERAGE, ENTROPY, ComparedRow

MOST_PAIRS = 3
"""So many pairs that are alike behind the best are named; of more the number is told."""
RANKED = (ENTROPY, COVERAGE, AP)


@dataclass(frozen=True, slots=True)
class Notation:
    """How figures are written where the sentences stand.

    Attributes
    ----------
    number : callable
        A number with so many digits.
    share : callable
        A share, 0 to 1, in percent.
    plus_minus : str
        Stands before a standard error.
    """

    number: Callable[[float, int], str] = lambda value, digits: f"{value:.{digits}f}"
    share: Callable[[float], str] = lambda share: f"{100.0 * share:.1f}%"
    plus_minus: str = "+-"


PLAIN = Notation()


def ranking(
    names: Sequence[str], rows: Sequence[ComparedRow], notation: Notation = PLAIN
) -> tuple[str, ...]:
    """Return sentences on which of several rigs is better overall: by entropy, by coverage, by AP.

    Parameters
    ----------
    names : sequence of str
        As readers call them, in the order of the rows' values.
    rows : sequence of ComparedRow
        Of `compare`.
    notation : Notation
    """
    whole = {row.measure: row for row in rows if row.group == "rig"}
    if len(names) < 2:
        return ()
    found = (_RankingSentences(names, whole[m], notation) for m in RANKED if m in whole)
    return tuple(" ".join(each.sentences()) for each in found)


def win_words(names: Sequence[str], rows: Sequence[ComparedRow]) -> tuple[str, ...]:
    """Return a sentence for each rig and measure by which it is clearly the best somewhere."""
    if len(names) < 2:
        return ()
    return tuple(
        f"{name} {_HOW[measure]} {where}."
        for k, name in enumerate(names)
        for measure in RANKED
        if (where := _where(rows, measure, k))
    )


def _where(rows: Sequence[ComparedRow], measure: str, k: int) -> str:
    """Return where a rig wins: "ahead and behind; for car and truck"."""
    found = []
    for group, every in (("zone", "in every zone"), ("class", "for every class")):
        there = [row for row in rows if (row.group, row.measure) == (group, measure)]
        won = [WHERE.get(row.name, row.name) for row in there if row.winner == k]
        if won and len(won) == len(there) > 1:
            found.append(every)
        elif won:
            found.append(f"{'for ' if group == 'class' else ''}{joined(won)}")
    return "; ".join(found)


class _RankingSentences:
    """The sentences on one figure of several rigs."""

    def __init__(self, names: Sequence[str], row: ComparedRow, notation: Notation) -> None:
        self._names, self._row, self._notation = names, row, notation
        self._order = row.order
        first = self._order[0] if self._order else 0
        self._best = [k for k in self._order if not row.differ(first, k)]
        self._rest = [k for k in self._order if k not in self._best]

    def sentences(self) -> Iterator[str]:
        """Yield who is best, by how much the others are worse, and which pairs are otherwise."""
        if len(self._order) < 2:
            return
        yield f"Overall {self._leaders()}."
        first = self._best[0]
        yield from (
            f"{self._names[j]} is worse than {self._names[i]}, by {self._gap(i, j)}."
            for i, j in self._pairs(self._best)
            if self._row.differ(i, j)
        )
        if self._rest:
            each = [f"{self._names[k]} by {self._gap(first, k)}" for k in self._rest]
            than = f" than {self._names[first]}" if len(self._best) > 1 else ""
            yield f"Worse{than}: {joined(each)}."
        yield from self._alike_behind()

    def _leaders(self) -> str:
        row, which = self._row, [self._names[k] for k in self._best]
        values = joined([self._figure(row.values[k]) for k in self._best])
        figures = f"{values}{_UNITS[row.measure]}"
        better = "lower" if row.lower_is_better else "higher"
        by = _BY[row.measure]
        if len(which) == 1:
            return f"{which[0]} is best by {by}: {figures}, {better} is better"
        also = ", and better than the others" if self._rest else ""
        error = self._most_error(self._best)
        return f"{joined(which)} are alike by {by}{also}: {figures}, {better} is better{error}"

    def _alike_behind(self) -> Iterator[str]:
        """Yield which other pairs are not told apart."""
        pairs = [
            (i, j)
            for i, j in self._pairs(self._order)
            if j in self._rest and not self._row.differ(i, j)
        ]
        if len(pairs) > MOST_PAIRS:
            yield f"{len(pairs)} other pairs are alike."
        elif pairs:
            each = [f"{self._names[i]} and {self._names[j]}" for i, j in pairs]
            yield f"Alike are also {'; '.join(each)}."

    @staticmethod
    def _pairs(order: Sequence[int]) -> list[tuple[int, int]]:
        return [(i, j) for a, i in enumerate(order) for j in order[a + 1 :]]

    def _figure(self, value: float | None) -> str:
        assert value is not None  # it has a rank
        if self._row.measure == COVERAGE:
            return self._notation.share(value)
        return self._notation.number(value, _DIGITS[self._row.measure])

    def _gap(self, one: int, other: int) -> str:
        a, b = self._row.values[one], self._row.values[other]
        assert a is not None and b is not None
        error = self._row.errors[one][other]
        told = f" {self._notation.plus_minus} {self._difference(error)}" if error else ""
        return f"{self._difference(abs(a - b))}{told}{_GAPS[self._row.measure]}"

    def _difference(self, value: float) -> str:
        """Return a difference or an error, of shares in percentage points; rounded up to a digit
        where it would be shown as 0."""
        digits = _DIGITS[self._row.measure]
        shown = 100.0 * value if self._row.measure == COVERAGE else value
        return self._notation.number(max(shown, 10.0**-digits) if shown else 0.0, digits)

    def _most_error(self, which: Sequence[int]) -> str:
        most = max(self._row.errors[i][j] for i in which for j in which)
        if not most:
            return ""
        each = "the difference" if len(which) == 2 else "a difference at most"
        return f"; standard error of {each} {self._difference(most)}{_GAPS[self._row.measure]}"


_BY = {ENTROPY: "entropy", COVERAGE: "coverage", AP: "expected AP"}
_UNITS = {ENTROPY: " nats", COVERAGE: "", AP: ""}
_GAPS = {ENTROPY: " nats", COVERAGE: " points", AP: ""}
_DIGITS = {ENTROPY: 2, COVERAGE: 1, AP: 3}
_HOW = {
    ENTROPY: "is better by entropy",
    COVERAGE: "sees more",
    AP: "has the highest expected AP",
}
