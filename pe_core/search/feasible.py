"""A placement to start from that breaks no rule, or the rules that exclude each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..errors import InputError
from .coding import Candidate, Coding

TRIES = 2000
"""Placements looked at before a set of rules is said to leave none: nearest to the start first."""
NAMED = 4
"""Rules that the message names."""


def first_allowed(coding: Coding, seed: int = 0) -> Candidate:
    """Return the start; where it breaks a rule, a placement near it that breaks none.

    Raises
    ------
    InputError
        When none is found; the message names rules that exclude each other.
    """
    if coding.allowed(coding.start.rig):
        return coding.start
    found = [coding.broken(coding.start.rig)]
    for vector in _ever_wider(coding, seed):
        candidate = coding.candidate(vector)
        broken = coding.broken(candidate.rig)
        if not broken:
            return candidate
        found.append(broken)
    raise _excluded([rule.words for rule in coding.rules], found)


def _ever_wider(coding: Coding, seed: int) -> Iterator[list[float]]:
    """Yield vectors round the start, from its neighbourhood to all that the unknowns may be."""
    rng = np.random.default_rng(seed)
    for number in range(TRIES if coding.unknowns else 0):
        share = (number + 1) / TRIES
        drawn = rng.uniform(-1.0, 1.0, len(coding.unknowns)).tolist()
        known = zip(coding.unknowns, coding.start.vector, drawn, strict=True)
        yield [u.brought(v + share * (u.high - u.low) * step) for u, v, step in known]


def _excluded(rules: Sequence[str], found: Sequence[frozenset[str]]) -> InputError:
    """Return the error that names a smallest set of rules of which each placement breaks one."""
    left = [words for words in rules if any(words in broken for broken in found)]
    for words in list(left):
        fewer = [other for other in left if other != words]
        if all(broken & set(fewer) for broken in found):
            left = fewer
    named = " and ".join(left[:NAMED]) + (", ..." if len(left) > NAMED else "")
    told = f"{named} leaves no place" if len(left) == 1 else f"{named} exclude each other"
    expected = "a placement that keeps to all of them"
    return InputError("optimize", told, expected, f"none in {len(found)} tried")
