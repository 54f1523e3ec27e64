"""Describe in sentences which of several rigs is better: overall, by zone and by class."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from pe_tools.advice.advice import joined

from .score_comparison import AP, COVERAGE, ENTROPY, ComparedRow
from .summary_text import WHERE

MAX_PAIRS = 3
"""Up to this number, pairs that are alike behind the best are named; of more, only the number."""
RANKED = (ENTROPY, COVERAGE, AP)


@dataclass(frozen=True, slots=True)
class Notation:
    """How the sentences write figures.

    Attributes
    ----------
    number : callable
        Formats a number with a number of decimals.
    share : callable
        Formats a share, 0 to 1, in percent.
    plus_minus : str
        Sign before a standard error.
    """

    number: Callable[[float, int], str] = lambda value, digits: f"{value:.{digits}f}"
    share: Callable[[float], str] = lambda share: f"{100.0 * share:.1f}%"
    plus_minus: str = "+-"


PLAIN = Notation()


def ranking(
    names: Sequence[str], rows: Sequence[ComparedRow], notation: Notation = PLAIN
) -> tuple[str, ...]:
    """Describe which of several rigs is better overall: by entropy, by coverage, by AP.

    Parameters
    ----------
    names : sequence of str
        Names of the rigs, in the order of the rows' values.
    rows : sequence of ComparedRow
        Result of `compare`.
    notation : Notation

    Returns
    -------
    tuple of str
        One paragraph for each measure; none for fewer than two rigs.
    """
    whole = {row.measure: row for row in rows if row.group == "rig"}
    if len(names) < 2:
        return ()
    by_measure = (_RankingSentences(names, whole[m], notation) for m in RANKED if m in whole)
    return tuple(" ".join(measure_sentences.sentences()) for measure_sentences in by_measure)


def win_words(names: Sequence[str], rows: Sequence[ComparedRow]) -> tuple[str, ...]:
    """Return a sentence for each rig and measure with a zone or class in which the rig is the best.

    Only significant differences count. The parameters are those of `ranking`.
    """
    if len(names) < 2:
        return ()
    return tuple(
        f"{name} {_HOW[measure]} {where}."
        for k, name in enumerate(names)
        for measure in RANKED
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
        self._order = row.order
        first = self._order[0] if self._order else 0
        self._best = [k for k in self._order if not row.differ(first, k)]
        self._rest = [k for k in self._order if k not in self._best]

    def sentences(self) -> Iterator[str]:
        """Yield the best rigs, how much worse the others are, and the pairs that are alike."""
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
            gaps = [f"{self._names[k]} by {self._gap(first, k)}" for k in self._rest]
            than = f" than {self._names[first]}" if len(self._best) > 1 else ""
            yield f"Worse{than}: {joined(gaps)}."
        yield from self._alike_behind()

    def _leaders(self) -> str:
        row, leaders = self._row, [self._names[k] for k in self._best]
        values = joined([self._figure(row.values[k]) for k in self._best])
        figures = f"{values}{_UNITS[row.measure]}"
        better = "lower" if row.lower_is_better else "higher"
        by = _BY[row.measure]
        if len(leaders) == 1:
            return f"{leaders[0]} is best by {by}: {figures}, {better} is better"
        also = ", and better than the others" if self._rest else ""
        error = self._most_error(self._best)
        return f"{joined(leaders)} are alike by {by}{also}: {figures}, {better} is better{error}"

    def _alike_behind(self) -> Iterator[str]:
        """Yield the other pairs without a significant difference."""
        pairs = [
            (i, j)
            for i, j in self._pairs(self._order)
            if j in self._rest and not self._row.differ(i, j)
        ]
        if len(pairs) > MAX_PAIRS:
            yield f"{len(pairs)} other pairs are alike."
        elif pairs:
            pair_names = [f"{self._names[i]} and {self._names[j]}" for i, j in pairs]
            yield f"Alike are also {'; '.join(pair_names)}."

    @staticmethod
    def _pairs(order: Sequence[int]) -> list[tuple[int, int]]:
        return [(i, j) for a, i in enumerate(order) for j in order[a + 1 :]]

    def _figure(self, value: float | None) -> str:
        assert value is not None  # a rig with a rank has a value
        if self._row.measure == COVERAGE:
            return self._notation.share(value)
        return self._notation.number(value, _DIGITS[self._row.measure])

    def _gap(self, one: int, other: int) -> str:
        a, b = self._row.values[one], self._row.values[other]
        assert a is not None and b is not None
        error = self._row.errors[one][other]
        error_text = f" {self._notation.plus_minus} {self._difference(error)}" if error else ""
        return f"{self._difference(abs(a - b))}{error_text}{_GAPS[self._row.measure]}"

    def _difference(self, value: float) -> str:
        """Format a difference or an error, of shares in percentage points.

        A value that would be shown as 0 is rounded up to the last digit.
        """
        digits = _DIGITS[self._row.measure]
        shown = 100.0 * value if self._row.measure == COVERAGE else value
        return self._notation.number(max(shown, 10.0**-digits) if shown else 0.0, digits)

    def _most_error(self, which: Sequence[int]) -> str:
        largest = max(self._row.errors[i][j] for i in which for j in which)
        if not largest:
            return ""
        subject = "the difference" if len(which) == 2 else "a difference at most"
        return (
            f"; standard error of {subject} {self._difference(largest)}{_GAPS[self._row.measure]}"
        )


_BY = {ENTROPY: "entropy", COVERAGE: "coverage", AP: "expected AP"}
_UNITS = {ENTROPY: " nats", COVERAGE: "", AP: ""}
_GAPS = {ENTROPY: " nats", COVERAGE: " points", AP: ""}
_DIGITS = {ENTROPY: 2, COVERAGE: 1, AP: 3}
_HOW = {
    ENTROPY: "is better by entropy",
    COVERAGE: "sees more",
    AP: "has the highest expected AP",
}
