"""The journal of a search: all values that it was told, in order.

Methods draw from their seed and follow these values, and nothing else. So they are the state of a
search, and no other state is ever stored: a search that resumes from a journal ends at the same
bits as one that was never interrupted.
"""

import hashlib
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from typing import Any, NamedTuple

from ..base.codec import Node, read_value
from ..base.errors import InputError
from ..scene.rig import Rig
from .dispatch import evaluate_all
from .objective import NO_VALUE, Leader, Objective, Value

DIGEST_BYTES = 4  # Length of the digest that identifies a placement
BATCH = 16
"""Candidates that a method may ask for at once when several are evaluated in parallel."""


class EvaluatedRig(NamedTuple):
    """The value of a placement (`NO_VALUE`: not below the cutoff), and a digest of it."""

    value: Value
    digest: str


def checked_entries(rows: Any, source: str, field: str) -> tuple[EvaluatedRig, ...]:
    """Return the entries of a journal from anybody's file. `InputError` where they are none."""
    entries: tuple[EvaluatedRig, ...] = read_value(
        tuple[EvaluatedRig, ...], Node(rows, source, field)
    )
    return entries


class Journal:
    """Values that a search was told, in the order of its questions. The given entries, of an
    interrupted search, are replayed: their placements are not evaluated again. `source` names the
    journal in messages."""

    def __init__(self, entries: Iterable[EvaluatedRig] = (), source: str = "journal") -> None:
        self._entries = list(entries)
        self._position = 0
        self._source = source
        self.known: list[tuple[int, Value, Rig]] = []
        """Levels, values and placements of those whose value is known: below their cutoff."""

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the entries: a search that begins anew replays them."""
        return Journal, (self.entries, self._source)

    @property
    def entries(self) -> tuple[EvaluatedRig, ...]:
        """All entries so far; may be read while another thread searches."""
        return tuple(self._entries)

    def value(self, objective: Objective, rig: Rig, level: int = 0) -> Value:
        """Return the value of the next placement, from the journal or from its objective."""
        return self.evaluate_all(objective, [rig], level=level)[0]

    def evaluate_all(
        self,
        objective: Objective,
        rigs: Sequence[Rig],
        cutoff: Value = NO_VALUE,
        executor: Executor | None = None,
        *,
        level: int = 0,
        leader: Leader | None = None,
    ) -> list[Value]:
        """Return the values of the next placements: the first ones may be in the journal, the
        others are evaluated and recorded."""
        values: list[Value] = []
        for rig in rigs:
            if (value := self.replay(rig, level)) is None:
                break
            values.append(value)
        new_rigs = rigs[len(values) :]
        new_values = evaluate_all(objective, new_rigs, cutoff, executor, leader=leader)
        for rig, value in zip(new_rigs, new_values, strict=True):
            self.record(rig, level, value)
        return values + new_values

    def replay(self, rig: Rig, level: int) -> Value | None:
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
        self._keep(rig, level, entry.value)
        return entry.value

    def require_used(self) -> None:
        """Raise `InputError` where entries are left: call it when the search has ended."""
        if left := len(self._entries) - self._position:
            expected = "no more entries, as the search has ended"
            raise InputError(self._source, f"evaluated[{self._position}]", expected, f"{left} more")

    def record(self, rig: Rig, level: int, value: Value) -> None:
        """Append the value of a placement that is not in the journal yet."""
        self._entries.append(EvaluatedRig(value, _digest(rig, level)))
        self._position += 1
        self._keep(rig, level, value)

    def _keep(self, rig: Rig, level: int, value: Value) -> None:
        if value != NO_VALUE:
            self.known.append((level, value, rig))


def _digest(rig: Rig, level: int) -> str:
    """Return a digest of a placement; two placements share one in four billion digests."""
    poses = ((s.name, s.model.name, s.pose.position, s.pose.rpy) for s in rig)
    identity = repr((level, *poses)).encode()
    return hashlib.blake2b(identity, digest_size=DIGEST_BYTES).hexdigest()
