"""A LiDAR's beams, sorted for looking them up by direction.

A cube seen from the sensor lies inside a window of azimuth and elevation that its half widths
bound. The beams that may pass it are taken from the LiDAR's own lattice of channels and azimuths;
patterns without one are looked up in bands of elevation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...scene.geometry import rotate
from ...scene.numbering import count_up
from .bands import BeamBands
from .bracket import Bracket
from .model import Lidar
from .slopes import SlopeBounds, SlopeCounts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WINDOW_MARGIN = 1e-7
"""Windows are widened by this [rad] against rounding."""
LATTICES_KEPT = 16
"""Lattices kept, by the model object; a rig has few models, a search the same few."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Directions a cube may cover, seen from the sensor, each (V,) [rad]."""

    azimuth: Floats
    half_azimuth: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True)
class Lattice:
    """A LiDAR's beams, sorted by elevation, for looking them up by direction.

    The tables by slope are those of regular LiDARs: a full circle, without azimuth offsets.
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
    bands: BeamBands | None

    @classmethod
    def of(cls, lidar: Lidar) -> Lattice:
        """Sort the channels, and say where in a channel each azimuth step is (-1: nowhere)."""
        channels = np.argsort(lidar.elevations, kind="stable")
        position = np.full(lidar.azimuth_count, -1)
        position[lidar.azimuth_steps % lidar.azimuth_count] = np.arange(len(lidar.azimuth_steps))
        full = len(lidar.azimuth_steps) == lidar.azimuth_count
        regular = full and lidar.azimuth_count > 1 and not lidar.azimuth_offsets.any()
        return cls(
            channels,
            lidar.elevations[channels],
            lidar.azimuth_offsets[channels],
            lidar.azimuth_step,
            lidar.azimuth_count,
            position,
            len(lidar.azimuth_steps),
            SlopeBounds.of(lidar) if regular else None,
            SlopeCounts.of(lidar) if regular else None,
            BeamBands.of(lidar.directions) if lidar.azimuth_count == 1 else None,
        )

    def window_beams(self, bounds: Bracket, voxels: Ints) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the outer windows of some voxels, numbered as in `voxels`."""
        rows, columns = (n[voxels].astype(np.int64) for n in (bounds.rows, bounds.columns))
        item = np.repeat(np.arange(len(voxels)), rows)
        row = np.repeat(bounds.row[voxels], rows) + count_up(rows)
        n, first = columns[item], bounds.column[voxels].astype(np.int64) % self.count
        column = np.repeat(first[item], n) + count_up(n)
        column[column >= self.count] -= self.count
        return np.repeat(item, n), np.repeat(self.channels[row] * self.width, n) + column

    def candidates(self, windows: Windows) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the beams inside each voxel's window."""
        if self.bands is not None:
            half = windows.half_azimuth
            return self.bands.candidates(windows.azimuth, half, windows.low, windows.high)
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
        at = self.position[j]
        beam = self.channels[np.repeat(row, n)] * self.width + at
        exists = at >= 0
        return np.repeat(voxel, n)[exists], beam[exists]


def windows_of(offsets: Floats, half: float, ground_from_sensor: Floats) -> Windows:
    """Bound the directions of cubes with half side `half` [m] at (V, 3) offsets from the sensor."""
    x, y, z = np.moveaxis(rotate(ground_from_sensor.T, offsets), -1, 0)
    flat = np.sqrt(x * x + y * y)
    c, s = x / np.maximum(flat, half), y / np.maximum(flat, half)
    axes = ground_from_sensor  # row k: ground axis k in the sensor frame
    radial = half * sum(np.abs(a[0] * c + a[1] * s) for a in axes)
    sideways = half * sum(np.abs(a[1] * c - a[0] * s) for a in axes)
    up = half * np.abs(axes[:, 2]).sum()
    near, far = flat - radial, np.sqrt((flat + radial) ** 2 + sideways**2)
    beside = near > WINDOW_MARGIN  # not above, below or round the sensor
    room = np.where(beside, near, 1.0)
    high = np.arctan2(z + up, np.where(z + up > 0.0, room, far))
    low = np.arctan2(z - up, np.where(z - up > 0.0, far, room))
    return Windows(
        np.arctan2(y, x),
        np.where(beside, np.arctan2(sideways, room), np.pi) + WINDOW_MARGIN,
        np.where(beside, low, -np.pi) - WINDOW_MARGIN,
        np.where(beside, high, np.pi) + WINDOW_MARGIN,
    )


@lru_cache(maxsize=LATTICES_KEPT)
def lattice_of(model: Lidar) -> Lattice:
    """Return a model's beams for looking them up by direction."""
    return Lattice.of(model)
