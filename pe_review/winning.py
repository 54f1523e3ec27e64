"""Who wins where: scores side by side, with differences that mean something."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .engine import advice, pe

ALIKE_NATS, ALIKE_SHARE = 0.005, 0.0005
"""Smaller differences do not show in the digits that the page gives."""
SURE = 2.0
"""Nor do scores on samples differ within so many standard errors of their difference."""


@dataclass(frozen=True, slots=True)
class CloseRow:
    """A figure of several studies: `values` in their order, and which one wins (None: alike).

    `group`, `name` and `measure` are those of `advice.ComparedRow`.
    """

    group: str
    name: str
    measure: str
    values: tuple[float | None, ...]
    winner: int | None


def close_rows(scores: Mapping[str, pe.Score]) -> tuple[CloseRow, ...]:
    """Put scores side by side: the rigs, every zone and class, entropy and coverage."""
    error = SURE * math.hypot(*sorted((s.stderr for s in scores.values()), reverse=True)[:2])
    return tuple(_close(row, error) for row in advice.compare(scores))


def leads(keys: Sequence[str], rows: Sequence[CloseRow]) -> dict[str, list[str]]:
    """Return the zones and classes that each study wins by entropy, in words."""
    found: dict[str, list[str]] = {key: [] for key in keys}
    for row in rows:
        if row.measure == "entropy" and row.group != "rig" and row.winner is not None:
            where = advice.WHERE.get(row.name) or f"for a {row.name}"
            found[keys[row.winner]].append(where)
    return found


def _close(row: advice.ComparedRow, error: float) -> CloseRow:
    lowest = row.measure == "entropy"
    least = max(ALIKE_NATS, error) if lowest else ALIKE_SHARE
    there = [(v if lowest else -v, k) for k, v in enumerate(row.values) if v is not None]
    first, *others = sorted(there)
    ahead = bool(others) and others[0][0] - first[0] > least
    return CloseRow(row.group, row.name, row.measure, row.values, first[1] if ahead else None)
