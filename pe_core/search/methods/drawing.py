"""Placements drawn at random until one keeps to all rules."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..coding import Candidate, Coding

MOST_DRAWN = 100
"""Placements drawn for one candidate; where none of them is allowed, none is scored."""


def drawn(coding: Coding, sample: Callable[[], Sequence[float]]) -> Candidate | None:
    """Return the first allowed placement of those whose vectors are sampled; None: there is none.

    Samples are brought into the unknowns' ranges.
    """
    for _ in range(MOST_DRAWN):
        known = zip(coding.unknowns, sample(), strict=True)
        candidate = coding.candidate([unknown.brought(value) for unknown, value in known])
        if coding.allowed(candidate.rig):
            return candidate
    return None
