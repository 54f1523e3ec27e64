"""A search that is asked for placements and told their values, by a program of the user's own."""

import math
import sys
from collections.abc import Generator, Sequence
from typing import Any

from ..base.errors import InputError, shown
from ..base.values import Whole, real
from ..scene.rig import Rig
from .journal import BATCH, EvaluatedRig, Journal, checked_entries
from .methods import METHODS, Given, checked_method
from .objective import NO_VALUE, Value
from .parametrization import Parametrization, feasible_start
from .search_space import Schedule, SearchSpace

COUNT = Whole(1)


class SearchRun:
    """A running search: `ask` returns placements, `tell` takes what they are worth.

    It follows its method, its seed and the values alone: told the same, it asks the same.

    `InputError`: As of `optimize`; or when the journal is of another search.

    Parameters
    ----------
    rig, search_space, seed, schedule, method, evaluations
        As of `optimize`.
    journal : sequence of EvaluatedRig, or what JSON makes of them, optional
        The `journal` of an earlier run of the same search, perhaps from a file of JSON: what that
        was told is not asked again.

    Attributes
    ----------
    best : Rig or None
        The placement of the lowest `value` told so far; None before the first.
    evaluations : int
        Number of values told, those of the journal included.
    is_done : bool
        Whether the search is over: nothing is asked any more.
    """

    def __init__(
        self,
        rig: Rig,
        search_space: SearchSpace,
        seed: int = 0,
        schedule: Schedule | None = None,
        *,
        method: str | None = None,
        evaluations: int = 0,
        journal: Sequence[Sequence[Any]] = (),
    ) -> None:
        name = checked_method("search_run", method, schedule is not None)
        self._options: tuple[Any, ...] = seed, schedule or Schedule(), 1, BATCH, evaluations
        self._coding = Parametrization(rig, search_space)
        self._ask = METHODS[name].ask
        self._journal = Journal(checked_entries(journal, "search_run", "journal"), "search_run")
        self.best: Rig | None = None
        self.value = math.inf
        self.evaluations = 0
        self.is_done = False
        self._batches = self._questions()
        self._batch = next(self._batches)
        self._given = 0
        self._told: dict[int, Value] = {}
        self._values: list[Value] = []
        self._advance()
        if self.is_done:
            self._journal.require_used()

    @property
    def journal(self) -> tuple[EvaluatedRig, ...]:
        """Every value in the order of the questions; JSON can hold it."""
        return self._journal.entries

    def ask(self, count: int = 1) -> list[Rig]:
        """Return at most `count` placements to evaluate, each once.

        None of them, while the method waits for values of those that it has asked for.
        """
        first = max(self._given, len(self._values))
        count = COUNT.checked("search_run", "count", count)
        self._given = min(first + count, len(self._batch))
        return self._batch[first : self._given]

    def tell(self, rigs: Sequence[Rig], values: Sequence[float]) -> None:
        """Take the value of each placement, in any order; lower is better. All of them, or none.

        `InputError` when a placement was not asked for, or was told before; when there are more or
        fewer values than placements; or a value is no number.
        """
        rigs = list(rigs)
        values = list(values)
        if len(rigs) != len(values):
            expected = f"{len(rigs)}, one for each rig"
            raise InputError("search_run", "values", expected, len(values))
        told = dict(self._told)
        for rig, value in zip(rigs, values, strict=True):
            waiting = range(len(self._values), self._given)
            found = [k for k in waiting if self._batch[k] is rig and k not in told]
            if not found:
                raise InputError("search_run", "rig", "one that `ask` returned, once", "another")
            if not (number := real(value)) > -math.inf:
                expected = "a number above -inf for each rig"
                raise InputError("search_run", "value", expected, shown(value))
            told[found[0]] = Value(0.0, number)
        self._told = told
        self._advance()

    def _advance(self) -> None:
        """Take values in the order of the questions; begin the next batch when one is complete."""
        while not self.is_done:
            for number in range(len(self._values), len(self._batch)):
                rig = self._batch[number]
                if (value := self._journal.replay(rig, 0)) is None:
                    if number not in self._told:
                        return
                    value = self._told[number]
                    self._journal.record(rig, 0, value)
                self._values.append(value)
                self.evaluations += 1
                if value.is_feasible and value.objective < self.value:
                    self.best = rig
                    self.value = value.objective
            try:
                self._batch = self._batches.send(self._values)
            except StopIteration:
                self.is_done = True
                self._batch = []
            self._given = 0
            self._told = {}
            self._values = []

    def _questions(self) -> Generator[list[Rig], list[Value], None]:
        """Yield the placements of each question; is sent their values."""
        start = feasible_start(self._coding, self._options[0])
        [value] = yield [start.rig]
        left = (self._options[-1] or sys.maxsize) - 1
        if not self._coding.variables:
            return
        questions = self._ask(Given(self._coding, start, value, *self._options))
        question = next(questions, None)
        while question is not None and left > 0:
            candidates = question.candidates
            cutoff = question.cutoff
            rigs = [each.rig for each in candidates if each is not None][:left]
            values = iter((yield rigs))
            left -= len(rigs)
            if not left:
                return
            told = (None if c is None else next(values) for c in candidates)
            answers = [v if v is None or v < cutoff else NO_VALUE for v in told]
            try:
                question = questions.send(answers)
            except StopIteration:
                return
