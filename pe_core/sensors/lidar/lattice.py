"""Looking up a LiDAR's beams by direction.

A cube seen from the sensor lies inside a window of azimuth and elevation that its half widths
bound. The beams that may pass it are found by arithmetic on the LiDAR's own lattice of channels
and azimuths (`Lattice`). A pattern without a lattice has its beams sorted by band of elevation and
by azimuth, and looked up by bisection (`BeamBands`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...base.arrays import Floats, Ints
from ...geometry.bins import count_up
from .bracket import Bracket, SlopeBounds
from .model import Lidar
from .upright import SlopeCounts

WINDOW_MARGIN = 1e-7  # Windows are widened by this against rounding [rad]
CACHED_LATTICES = 16
"""Lattices in the cache, by model; a rig has few models, and a search the same few."""
BAND_RAD = math.radians(0.5)
SEAM_RAD = 1.2345e-5
"""A full circle begins this much beside 180 degrees: there beams often are, and rounding would
decide whether one of them counts once or twice [rad]."""
TURN = 2.0 * math.pi
STRIDE = 4.0 * TURN
"""Distance between the keys of two bands: wider than any azimuth or window [rad]."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Directions that cubes may cover, seen from the sensor; (V,) each [rad]. `azimuth` is the
    middle of the window and `half_azimuth` its half width; `low` and `high` are elevations."""

    azimuth: Floats
    half_azimuth: Floats
    low: Floats
    high: Floats

    def take(self, index: Ints) -> "Windows":
        """Return the windows with these indices."""
        fields = self.azimuth, self.half_azimuth, self.low, self.high
        return Windows(*(w[index] for w in fields))


@dataclass(frozen=True, slots=True)
class Lattice:
    """A LiDAR's beams by channel and azimuth step, channels sorted by elevation.

    `channels` (C,) are the model's channel numbers, lowest first; `elevations` and `offsets` (C,)
    theirs [rad]. A full circle has `count` azimuth steps of `step` [rad]; `position` (count,) is a
    step's index among the `width` beams of a channel, -1 where the step has no beam. The tables by
    slope are those of regular LiDARs: a full circle, without azimuth offsets. `bands` hold the
    beams of a pattern without a lattice.
    """

    channels: Ints
    elevations: Floats
    offsets: Floats
    step: float
    count: int
    position: Ints
    width: int
    slope_bounds: SlopeBounds | None
    slope_counts: SlopeCounts | None
    bands: "BeamBands | None"

    @classmethod
    def of(cls, lidar: Lidar) -> "Lattice":
        """Build the tables of a model."""
        channels = np.argsort(lidar.elevations, kind="stable")
        position = np.full(lidar.azimuth_count, -1)
        position[lidar.azimuth_steps % lidar.azimuth_count] = np.arange(len(lidar.azimuth_steps))
        full_circle = len(lidar.azimuth_steps) == lidar.azimuth_count
        regular = full_circle and lidar.azimuth_count > 1 and not lidar.azimuth_offsets.any()
        return cls(
            channels=channels,
            elevations=lidar.elevations[channels],
            offsets=lidar.azimuth_offsets[channels],
            step=lidar.azimuth_step,
            count=lidar.azimuth_count,
            position=position,
            width=len(lidar.azimuth_steps),
            slope_bounds=SlopeBounds.of(lidar.elevations) if regular else None,
            slope_counts=SlopeCounts.of(lidar.elevations, lidar.azimuth_count) if regular else None,
            bands=BeamBands.of(lidar.directions) if lidar.azimuth_count == 1 else None,
        )

    def window_beams(self, bounds: Bracket, voxels: Ints) -> tuple[Ints, Ints]:
        """Return (voxel, beam) pairs (P,) of the beams in the outer windows of `bounds`. `voxels`
        (N,) are indices into `bounds`; the pairs number them 0 to N - 1."""
        rows, columns = (n[voxels].astype(np.int64) for n in (bounds.rows, bounds.columns))
        voxel = np.repeat(np.arange(len(voxels)), rows)
        row = np.repeat(bounds.row[voxels], rows) + count_up(rows)
        n = columns[voxel]
        first = bounds.column[voxels].astype(np.int64) % self.count
        column = np.repeat(first[voxel] - (np.cumsum(n) - n), n)  # as of `count_up`, in one turn
        column += np.arange(len(column))
        np.subtract(column, self.count, out=column, where=column >= self.count)
        column += np.repeat(self.channels[row] * self.width, n)
        return np.repeat(voxel, n), column

    def candidates(self, windows: Windows) -> tuple[Ints, Ints]:
        """Return (voxel, beam) pairs (P,) of the beams inside each voxel's window."""
        if self.bands is not None:
            return self.bands.candidates(windows)
        first = np.searchsorted(self.elevations, windows.low, side="left")
        n = np.searchsorted(self.elevations, windows.high, side="right") - first
        voxel = np.repeat(np.arange(len(n)), n)
        row = np.repeat(first, n) + count_up(n)
        middle = windows.azimuth[voxel] - self.offsets[row]
        half = windows.half_azimuth[voxel]
        j0 = np.ceil((middle - half) / self.step).astype(np.int64)
        n = np.floor((middle + half) / self.step).astype(np.int64) - j0 + 1
        n = np.clip(n, 0, self.count)
        j = (np.repeat(j0, n) + count_up(n)) % self.count
        position = self.position[j]
        beam = self.channels[np.repeat(row, n)] * self.width + position
        exists = position >= 0
        return np.repeat(voxel, n)[exists], beam[exists]


def windows_of(center: Floats, half_axes: Sequence[Floats]) -> Windows:
    """Return windows that hold cubes or boxes, in the sensor frame. `center` (3, V) are their
    centres, `half_axes` their three half edges, (3,) or (3, V) each. A window is all round where
    the sensor's axis may touch a box."""
    x, y, z = center
    flat = np.sqrt(x * x + y * y)
    safe = np.maximum(flat, WINDOW_MARGIN)
    c = x / safe
    s = y / safe
    radial = sum(np.abs(a[0] * c + a[1] * s) for a in half_axes)
    lateral = sum(np.abs(a[1] * c - a[0] * s) for a in half_axes)
    up = sum(np.abs(a[2]) for a in half_axes)
    near = flat - radial
    far = np.sqrt((flat + radial) ** 2 + lateral**2)
    off_axis = near > WINDOW_MARGIN  # not above, below or round the sensor
    safe_near = np.where(off_axis, near, 1.0)
    high = np.arctan2(z + up, np.where(z + up > 0.0, safe_near, far))
    low = np.arctan2(z - up, np.where(z - up > 0.0, far, safe_near))
    return Windows(
        np.arctan2(y, x),
        np.where(off_axis, np.arctan2(lateral, safe_near), np.pi) + WINDOW_MARGIN,
        np.where(off_axis, low, -np.pi) - WINDOW_MARGIN,
        np.where(off_axis, high, np.pi) + WINDOW_MARGIN,
    )


@lru_cache(maxsize=CACHED_LATTICES)
def lattice_of(model: Lidar) -> Lattice:
    """Return the lattice of a model, from a cache."""
    return Lattice.of(model)


@dataclass(frozen=True, slots=True)
class BeamBands:
    """The beams of a pattern by band of elevation and azimuth. `keys` (K,) are sorted, a band's
    number times `STRIDE` plus an azimuth; `beams` (K,) are their indices. Each beam stands at its
    azimuth and a turn to both sides, so that no window wraps."""

    keys: Floats
    beams: Ints

    @classmethod
    def of(cls, directions: Floats) -> "BeamBands":
        """Sort the beams with unit directions (B, 3), sensor frame."""
        elevation = np.arctan2(directions[:, 2], np.hypot(directions[:, 0], directions[:, 1]))
        azimuth = np.arctan2(directions[:, 1], directions[:, 0])
        band = _band(elevation)
        turns = [band * STRIDE + azimuth + turn for turn in (-TURN, 0.0, TURN)]
        keys = np.concatenate(turns)
        beams = np.tile(np.arange(len(directions)), 3)
        order = np.argsort(keys, kind="stable")
        return cls(keys[order], beams[order])

    def candidates(self, windows: Windows) -> tuple[Ints, Ints]:
        """Return (voxel, beam) pairs (P,) of the beams that may lie in each voxel's window. A half
        width of pi or more is all round; elevations beyond +-90 degrees are allowed."""
        azimuth = windows.azimuth
        half = windows.half_azimuth
        low = windows.low
        high = windows.high
        first = _band(np.maximum(low, -math.pi / 2))
        n = _band(np.minimum(high, math.pi / 2)) - first + 1
        voxel = np.repeat(np.arange(len(n)), n)
        start = (np.repeat(first, n) + count_up(n)) * STRIDE
        full_circle = half[voxel] >= math.pi
        middle = np.where(full_circle, SEAM_RAD, azimuth[voxel])
        reach = np.where(full_circle, math.pi, half[voxel])
        # The full circle is half open: the copies a turn away begin just outside.
        i0 = np.searchsorted(self.keys, start + middle - reach, side="left")
        left, right = (
            np.searchsorted(self.keys, start + middle + reach, side=side)
            for side in ("left", "right")
        )
        n = np.where(full_circle, left, right) - i0
        return np.repeat(voxel, n), self.beams[np.repeat(i0, n) + count_up(n)]


def _band(elevation: Floats) -> Ints:
    """Number of the band of each elevation within +-90 degrees, from 0."""
    return np.floor((elevation + math.pi / 2) / BAND_RAD).astype(np.int64)
