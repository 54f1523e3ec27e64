"""From measurements to entropy with look-up tables: eqs. 4 to 8 for whole arrays.

A LiDAR group's measurement is a whole number that soon saturates AP, so its 1 / sigma^2 is a table,
and so is its entropy when it stands alone. `entropy` has the plain definitions this is held to.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .entropy import BLIND_PRECISION, PerceptionModel, entropy_of, precision_of

Floats = NDArray[np.float64]
Measurement = tuple[str, NDArray]
"""Kind of sensor ("lidar" or "camera") and its beams (whole numbers) or pixels."""

LONGEST_TABLE = (1 << 16) - 1
"""Beam counts are kept in 16 bits."""


def early_fusion(measurements: Iterable[ArrayLike]) -> Floats:
    """m of a fusion group: the sum over its sensors, eq. 6."""
    return np.asarray(sum(np.asarray(m, dtype=float) for m in measurements), dtype=float)


def late_fusion(precisions: Iterable[ArrayLike], blind: str = "floor") -> Floats:
    """Fuse 1 / sigma^2 over groups and cameras, eq. 7; returns the fused 1 / sigma^2.

    "floor" sums the precision above that of a blind sensor, f = 1 / 999^2:
    ``f + sum(1 / sigma_i^2 - f)``. "literal" is the plain sum.
    """
    floor = BLIND_PRECISION if blind == "floor" else 0.0
    fused = sum(np.asarray(p, dtype=float) - floor for p in precisions)
    return np.asarray(fused + floor, dtype=float)


class Fusion:
    """Fuses measurements of fusion groups under one perception model."""

    def __init__(self, model: PerceptionModel) -> None:
        self.model = model
        last = int(min(model.lidar.saturation, LONGEST_TABLE - 1)) + 1
        self._precision = precision_of(np.arange(last + 1), model.lidar)
        self._entropy = entropy_of(late_fusion([self._precision], model.blind))

    @property
    def enough(self) -> int:
        """Beams from which on AP is saturated: more of them change nothing."""
        return len(self._precision) - 1

    def compact(self, counts: NDArray[np.uint16]) -> NDArray:
        """Copy beam counts, into one byte where AP saturates that early; enough for any entropy."""
        small = self.enough <= np.iinfo(np.uint8).max
        return np.minimum(counts, self.enough).astype(np.uint8) if small else counts.copy()

    def precision(self, m: NDArray, kind: str) -> Floats:
        """1 / sigma^2 of a group's measurement."""
        if kind == "lidar":
            return np.take(self._precision, m, mode="clip")
        return precision_of(m, self.model.camera)

    def entropies(self, groups: Sequence[Measurement]) -> tuple[Floats, NDArray[np.bool_]]:
        """Entropy H of every voxel [nats] and whether any group sees it.

        Where only one LiDAR group sees anything, H is looked up; elsewhere it is computed. A blind
        camera changes nothing, unless the letter is asked for.
        """
        lidars = (g for g in groups if g[0] == "lidar" and self._blind_is_silent)
        tabled = next(lidars, None)
        others = [g for g in groups if g is not tabled]
        if tabled is not None:
            entropies = np.take(self._entropy, tabled[1], mode="clip")
            seen = tabled[1] > 0
        else:
            entropies = np.full(groups[0][1].shape, self._entropy[0])
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
