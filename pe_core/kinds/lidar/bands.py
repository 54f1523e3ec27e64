"""Looking up the beams of an arbitrary pattern by direction.

A pattern has no lattice to compute with. Its beams are sorted by elevation band, and by azimuth
inside a band, each listed once more a turn lower and a turn higher, so that no window wraps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.numbering import count_up

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BAND_RAD = math.radians(0.5)
TURN = 2.0 * math.pi
STRIDE = 4.0 * TURN
"""Distance between the keys of two bands: wider than any azimuth or window."""


@dataclass(frozen=True, slots=True)
class BeamBands:
    """Beams by elevation band and azimuth: sorted `keys` (K,) and their `beams` (K,)."""

    keys: Floats
    beams: Ints

    @classmethod
    def of(cls, directions: Floats) -> BeamBands:
        """Sort the (B, 3) sensor-frame directions of a pattern."""
        elevation = np.arctan2(directions[:, 2], np.hypot(directions[:, 0], directions[:, 1]))
        azimuth = np.arctan2(directions[:, 1], directions[:, 0])
        band = _band(elevation)
        turns = [band * STRIDE + azimuth + turn for turn in (-TURN, 0.0, TURN)]
        keys, beams = np.concatenate(turns), np.tile(np.arange(len(directions)), 3)
        order = np.argsort(keys, kind="stable")
        return cls(keys[order], beams[order])

    def candidates(
        self, azimuth: Floats, half: Floats, low: Floats, high: Floats
    ) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the beams that may lie in each voxel's window.

        Parameters
        ----------
        azimuth, half : (V,) float
            Middle and half width of the windows [rad]; a half width of pi or more is all round.
        low, high : (V,) float
            Elevations [rad]; beyond +-90 degrees is allowed.
        """
        first = _band(np.maximum(low, -math.pi / 2))
        n = _band(np.minimum(high, math.pi / 2)) - first + 1
        voxel = np.repeat(np.arange(len(n)), n)
        start = (np.repeat(first, n) + count_up(n)) * STRIDE
        round_ = half[voxel] >= math.pi
        middle = np.where(round_, 0.0, azimuth[voxel])
        reach = np.where(round_, math.pi, half[voxel])
        # All round is [-pi, pi): the copies a turn away begin just outside.
        i0 = np.searchsorted(self.keys, start + middle - reach, side="left")
        i1 = np.searchsorted(self.keys, start + middle + reach, side="left")
        i1 = np.where(round_, i1, np.searchsorted(self.keys, start + middle + reach, side="right"))
        n = i1 - i0
        return np.repeat(voxel, n), self.beams[np.repeat(i0, n) + count_up(n)]


def _band(elevation: Floats) -> Ints:
    """Band of each elevation in [-90, 90] degrees, from 0."""
    return np.floor((elevation + math.pi / 2) / BAND_RAD).astype(np.int64)
