"""The journal of a search: all values that it was told, in order.

Methods draw from their seed and follow these values, and nothing else. So they are the state of a
search, and no other state is ever stored: a search that resumes from a journal ends at the same
bits as one that was never interrupted.
"""

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any, NamedTuple

from ..base.errors import InputError, shown
from ..base.values import real
from ..scene.rig import Rig
from ..scoring.score import Objective
from .dispatch import evaluate_all

DIGEST_BYTES = 4  # Length of the digest that identifies a placement
BATCH = 16
"""Candidates that a method may ask for at once when several are evaluated in parallel."""


class EvaluatedRig(NamedTuple):
    """The value of a placement (inf: not below the best so far), and a digest of the placement."""

    entropy: float
    digest: str


def checked_entries(rows: Any, source: object, field: str) -> tuple[EvaluatedRig, ...]:
    """Return the entries of a journal from anybody's file: pairs of a value, which may be inf, and
    a digest. `InputError` for anything else."""
    entries = []
    is_listing = isinstance(rows, Iterable) and not isinstance(rows, str | Mapping)
    for number, row in enumerate(rows if is_listing else [rows]):
        entry = tuple(row) if isinstance(row, list | tuple) else ()
        value = real(entry[0]) if len(entry) == len(EvaluatedRig._fields) else math.nan
        if not value > -math.inf or not isinstance(entry[1], str):
            found = shown(row)
            raise InputError(source, f"{field}[{number}]", "an entropy, a digest", found)
        entries.append(EvaluatedRig(value, entry[1]))
    return tuple(entries)


class Journal:
    """Values that a search was told, in the order of its questions. The given entries, of an
    interrupted search, are replayed: their placements are not evaluated again. `source` names the
    journal in messages."""

    def __init__(self, entries: Iterable[EvaluatedRig] = (), source: str = "journal") -> None:
        self._entries = list(entries)
        self._position = 0
        self._source = source

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the entries: a search that begins anew replays them."""
        return Journal, (self.entries, self._source)

    @property
    def entries(self) -> tuple[EvaluatedRig, ...]:
        """All entries so far; may be read while another thread searches."""
        return tuple(self._entries)

    def wrap(self, objectives: Sequence[Objective]) -> list[Objective]:
        """Return objectives, one for each level of a method, that replay and extend the journal.
        Behind the end of the journal they evaluate with the given objectives."""
        return [JournaledObjective(self, own, k) for k, own in enumerate(objectives)]

    def replay(self, rig: Rig, level: int) -> float | None:
        """Return the journaled value of the next placement; None behind the end of the journal.
        `InputError` when the journal has another placement here."""
        if self._position == len(self._entries):
            return None
        entry = self._entries[self._position]
        digest = _digest(rig, level)
        if entry.digest != digest:
            expected = "the placements this search asks for (of the same version, on such a system)"
            field = f"evaluated[{self._position}]"
            raise InputError(self._source, field, expected, "another")
        self._position += 1
        return entry.entropy

    def require_used(self) -> None:
        """Raise `InputError` where entries are left: call it when the search has ended."""
        if left := len(self._entries) - self._position:
            expected = "no more entries, as the search has ended"
            raise InputError(self._source, f"evaluated[{self._position}]", expected, f"{left} more")

    def record(self, rig: Rig, level: int, value: float) -> None:
        """Append the value of a placement that is not in the journal yet."""
        self._entries.append(EvaluatedRig(value, _digest(rig, level)))
        self._position += 1


class JournaledObjective:
    """An objective that replays a journal, and records what it evaluates behind the end."""

    def __init__(self, journal: Journal, objective: Objective, level: int = 0) -> None:
        self._journal = journal
        self._objective = objective
        self._level = level

    def entropy(self, rig: Rig) -> float:
        """Return the entropy of a rig, from the journal or from the objective [nats]."""
        return self.evaluate_all([rig], math.inf, None)[0]

    def evaluate_all(
        self, rigs: Sequence[Rig], cutoff: float, executor: Executor | None
    ) -> list[float]:
        """Evaluate several rigs: the first ones may be in the journal, the others are evaluated.
        Workers are sent the objective without the journal."""
        replayed = (self._journal.replay(rig, self._level) for rig in rigs)
        values: list[float] = []
        for value in replayed:
            if value is None:
                break
            values.append(value)
        new_rigs = rigs[len(values) :]
        new_values = evaluate_all(self._objective, new_rigs, cutoff, executor)
        for rig, value in zip(new_rigs, new_values, strict=True):
            self._journal.record(rig, self._level, value)
        return values + new_values


def _digest(rig: Rig, level: int) -> str:
    """Return a digest of a placement; two placements share one in four billion digests."""
    poses = ((s.name, s.model.name, s.pose.position, s.pose.rpy) for s in rig)
    identity = repr((level, *poses)).encode()
    return hashlib.blake2b(identity, digest_size=DIGEST_BYTES).hexdigest()
