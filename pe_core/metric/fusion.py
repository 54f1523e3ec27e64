"""Equations 6 and 7: measurements summed inside a group, groups fused; and eqs. 4 to 8 by look-up.

A whole number as m, such as a count of beams, soon saturates AP: its 1 / sigma^2 is then a table,
and so is its entropy when its group stands alone. The plain definitions come first; the tables are
held to them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import add
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .entropy import BLIND_PRECISION, H_BLIND, ApCurve, entropy_of, precision_of

Floats = NDArray[np.float64]
CurveOf = str | ApCurve
"""Whose AP curve: a kind's ("lidar", "camera"), or one of its own."""
Measurement = tuple[CurveOf, NDArray]
"""Curve and m of a group: whole numbers (beams) or not (pixels)."""

LONGEST_TABLE = (1 << 16) - 1
"""Counts are kept in 16 bits."""
MOST_BYTES = 257
"""Numbers of 8 bits whose sum 16 bits hold."""


class Curves(Protocol):
    """What fusion asks of a perception model: an AP curve by kind, and the rule for the blind."""

    blind: str

    def curve(self, kind: str) -> ApCurve:
        """Return the AP curve of a kind of sensor."""


def early_fusion(measurements: Iterable[ArrayLike]) -> Floats:
    """m of a fusion group: the sum over its sensors, eq. 6."""
    return np.asarray(sum(np.asarray(m, dtype=float) for m in measurements), dtype=float)


def group_sum(measured: Sequence[Any]) -> Any:
    """Sum measurements as kernels give them, eq. 6: counts of few bits each, or what adds up."""
    if len(measured) == 1:
        return measured[0]
    if not (isinstance(measured[0], np.ndarray) and is_whole(measured[0])):
        return reduce(add, measured)
    is_short = all(m.itemsize == 1 for m in measured) and len(measured) <= MOST_BYTES
    total = measured[0].astype(np.uint16 if is_short else np.uint32)
    for m in measured[1:]:
        np.add(total, m, out=total, casting="unsafe")
    return total


def late_fusion(precisions: Iterable[ArrayLike], blind: str = "floor") -> Floats:
    """Fuse 1 / sigma^2 over groups and cameras, eq. 7; returns the fused 1 / sigma^2.

    "floor" sums the precision above that of a blind sensor, f = 1 / 999^2:
    ``f + sum(1 / sigma_i^2 - f)``. "literal" is the literal formula (eq. 7), the plain sum.
    """
    floor = BLIND_PRECISION if blind == "floor" else 0.0
    fused = sum(np.asarray(p, dtype=float) - floor for p in precisions)
    return np.asarray(fused + floor, dtype=float)


class ByCount(NamedTuple):
    """1 / sigma^2 and entropy of a lone group by its m = 0, 1, ...; AP is saturated at the end."""

    precision: Floats
    entropy: Floats


class Fusion:
    """Fuses measurements of fusion groups under one perception model."""

    def __init__(self, model: Curves) -> None:
        self.model = model
        self._known: dict[CurveOf, ByCount] = {}  # by curve: as many as there are

    def curve(self, kind: CurveOf) -> ApCurve:
        """Return the AP curve of a kind, or the one that it is."""
        return kind if isinstance(kind, ApCurve) else self.model.curve(kind)

    def tables(self, kind: CurveOf) -> ByCount:
        """Return what whole numbers of a kind are looked up in."""
        if kind not in self._known:
            curve = self.curve(kind)
            precision = precision_of(np.arange(self.enough(kind) + 1), curve)
            entropy = entropy_of(late_fusion([precision], self.model.blind))
            self._known[kind] = ByCount(precision, entropy)
        return self._known[kind]

    def enough(self, kind: CurveOf) -> int:
        """Whole m from which on AP is saturated: more changes nothing."""
        return int(min(self.curve(kind).saturation, LONGEST_TABLE - 1)) + 1

    def precision(self, m: NDArray, kind: CurveOf) -> Floats:
        """1 / sigma^2 of a group's measurement."""
        if is_whole(m):
            return np.take(self.tables(kind).precision, m, mode="clip")
        return precision_of(m, self.curve(kind))

    def entropies(self, groups: Sequence[Measurement]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy H of every voxel [nats] and whether any group sees it.

        Where only one group of whole numbers sees anything, H is looked up; elsewhere it is
        computed. A blind group changes nothing, unless the literal formula (eq. 7) is asked for.
        """
        whole = (g for g in groups if is_whole(g[1]) and self._blind_is_silent)
        tabled = next(whole, None)
        others = [g for g in groups if g is not tabled]
        if tabled is not None:
            entropies = np.take(self.tables(tabled[0]).entropy, tabled[1], mode="clip")
            seen = tabled[1] > 0
        else:
            entropies = np.full(groups[0][1].shape, H_BLIND)
            seen = np.zeros(entropies.shape, bool)
        if others:
            voiced = np.logical_or.reduce([m > 0 for _, m in others])
            seen |= voiced
            where = voiced if self._blind_is_silent else np.ones_like(voiced)
            entropies[where] = self._computed([(kind, m[where]) for kind, m in groups])
        return entropies, seen

    @property
    def _blind_is_silent(self) -> bool:
        return self.model.blind == "floor"

    def _computed(self, groups: Sequence[Measurement]) -> Floats:
        """Entropy by the equations."""
        precisions = [self.precision(m, kind) for kind, m in groups]
        return entropy_of(late_fusion(precisions, self.model.blind))


def is_whole(m: NDArray) -> bool:
    """Whether a measurement is in whole numbers."""
    return m.dtype.kind in "iu"
