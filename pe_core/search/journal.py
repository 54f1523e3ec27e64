"""What a search was told, in order: from it a search goes on, to the bits of one that never ended.

Methods draw from their seed and follow what they are told, and from nothing else. So the state of a
search is the list of the values it was told, and no more is ever stored of it.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor
from typing import NamedTuple

from ..errors import InputError
from ..scene.sensors import Rig
from ..scoring import Judgement
from .batch import judge_all
from .objective import Objective

MARK_BYTES = 4
"""A placement is known again by so much of its hash."""


class JudgedRig(NamedTuple):
    """What was told of a placement, and a mark by which the placement is known again."""

    entropy: float
    is_lower_bound: bool
    mark: str


class Journal:
    """Values that a search was told, in the order in which it asked.

    Parameters
    ----------
    entries : iterable of JudgedRig
        Of a search that was broken off: these are told again without being judged.
    source : str
        What messages call it.
    """

    def __init__(self, entries: Iterable[JudgedRig] = (), source: str = "journal") -> None:
        self._entries, self._asked, self._source = list(entries), 0, source

    @property
    def entries(self) -> tuple[JudgedRig, ...]:
        """All that was told so far; it may be asked for while another thread searches."""
        return tuple(self._entries)

    def over(self, objectives: Sequence[Objective]) -> list[Objective]:
        """Return objectives (those of a method's levels) that tell what the journal knows.

        What it does not know yet is asked of the given ones, and noted.
        """
        return [Recalled(self, objective, level) for level, objective in enumerate(objectives)]

    def recall(self, rig: Rig, level: int) -> Judgement | None:
        """Return what is known of the placement that is asked for next; None behind the end.

        Raises
        ------
        InputError
            When another placement was asked for here.
        """
        if self._asked == len(self._entries):
            return None
        entry, mark = self._entries[self._asked], _mark(rig, level)
        if entry.mark != mark:
            expected = "the placements this search asks for (of the same version, on such a system)"
            raise InputError(self._source, f"judged[{self._asked}]", expected, "another")
        self._asked += 1
        return Judgement(entry.entropy, entry.is_lower_bound)

    def note(self, rig: Rig, level: int, told: Judgement) -> None:
        """Keep what was told of the placement that was asked for last."""
        self._entries.append(JudgedRig(told.entropy, told.is_lower_bound, _mark(rig, level)))
        self._asked += 1


class Recalled:
    """An objective that tells again what a journal knows, and notes what else it is asked."""

    def __init__(self, journal: Journal, objective: Objective, level: int = 0) -> None:
        self._journal, self._objective, self._level = journal, objective, level

    def entropy(self, rig: Rig) -> float:
        """As the objective's, without asking it again."""
        known = self._journal.recall(rig, self._level)
        if known is None:
            known = Judgement(self._objective.entropy(rig), False)
            self._journal.note(rig, self._level, known)
        return known.entropy

    def judge(self, rig: Rig, below: float = math.inf) -> Judgement:
        """As the objective's, without asking it again."""
        known = self._journal.recall(rig, self._level)
        if known is None:
            known = self._objective.judge(rig, below)
            self._journal.note(rig, self._level, known)
        return known

    def judge_all(
        self, rigs: Sequence[Rig], below: float, executor: Executor | None
    ) -> list[Judgement]:
        """Judge several rigs: the first ones the journal may know, the objective is asked the rest.

        What workers are sent is the objective alone.
        """
        told = list(self._known(rigs))
        rest = rigs[len(told) :]
        for rig, found in zip(rest, judge_all(self._objective, rest, below, executor), strict=True):
            self._journal.note(rig, self._level, found)
            told.append(found)
        return told

    def _known(self, rigs: Sequence[Rig]) -> Iterator[Judgement]:
        for rig in rigs:
            known = self._journal.recall(rig, self._level)
            if known is None:
                return
            yield known


def _mark(rig: Rig, level: int) -> str:
    """Return a mark of a placement: others have another, but for one in four billion."""
    placed = ((s.name, s.model.name, s.pose.position, s.pose.rpy) for s in rig)
    seen = repr((level, *placed)).encode()
    return hashlib.blake2b(seen, digest_size=MARK_BYTES).hexdigest()
