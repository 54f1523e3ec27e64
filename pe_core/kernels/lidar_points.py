"""Beams through single voxels: for each voxel the few beams that may touch it, tested exactly.

A cube seen from the sensor lies inside a window of azimuth and elevation that its half widths
bound. The beams of that window, taken from the LiDAR's own lattice, are put to the test of the
definition with the same arithmetic, so the count is the definition's to the last beam.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry import rotate
from ..sensors import Lidar
from .raycast import ranges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WINDOW_MARGIN = 1e-7
"""Windows are widened by this [rad] against rounding."""
PAIRS_AT_ONCE = 1 << 20


@dataclass(frozen=True, slots=True)
class Windows:
    """Directions a cube may cover, seen from the sensor, each (V,) [rad]."""

    azimuth: Floats
    half_azimuth: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True)
class Lattice:
    """A LiDAR's beams, sorted by elevation, for looking them up by direction."""

    channels: Ints
    elevations: Floats
    offsets: Floats
    step: float
    count: int
    position: Ints
    width: int

    @classmethod
    def of(cls, lidar: Lidar) -> Lattice:
        """Sort the channels, and say where in a channel each azimuth step is (-1: nowhere)."""
        channels = np.argsort(lidar.elevations, kind="stable")
        position = np.full(lidar.azimuth_count, -1)
        position[lidar.azimuth_steps % lidar.azimuth_count] = np.arange(len(lidar.azimuth_steps))
        return cls(
            channels,
            lidar.elevations[channels],
            lidar.azimuth_offsets[channels],
            lidar.azimuth_step,
            lidar.azimuth_count,
            position,
            len(lidar.azimuth_steps),
        )

    def candidates(self, windows: Windows) -> tuple[Ints, Ints]:
        """(voxel, beam) pairs of the beams inside each voxel's window."""
        first = np.searchsorted(self.elevations, windows.low, side="left")
        n = np.searchsorted(self.elevations, windows.high, side="right") - first
        voxel = np.repeat(np.arange(len(n)), n)
        row = np.repeat(first, n) + ranges(n)
        middle = windows.azimuth[voxel] - self.offsets[row]
        half = windows.half_azimuth[voxel]
        j0 = np.ceil((middle - half) / self.step).astype(np.int64)
        n = np.floor((middle + half) / self.step).astype(np.int64) - j0 + 1
        n = np.clip(n, 0, self.count)
        j = (np.repeat(j0, n) + ranges(n)) % self.count
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
    beside = near > 0.0
    room = np.where(beside, near, 1.0)
    high = np.arctan2(z + up, np.where(z + up > 0.0, room, far))
    low = np.arctan2(z - up, np.where(z - up > 0.0, far, room))
    return Windows(
        np.arctan2(y, x),
        np.where(beside, np.arctan2(sideways, room), np.pi) + WINDOW_MARGIN,
        np.where(beside, low, -np.pi) - WINDOW_MARGIN,
        np.where(beside, high, np.pi) + WINDOW_MARGIN,
    )


def count_beams(
    offsets: Floats,
    lattice: Lattice,
    ground_from_sensor: Floats,
    directions: Floats,
    ends: Floats,
) -> Ints:
    """Count the beams through unit cubes.

    Parameters
    ----------
    offsets : (V, 3) float
        Cube centres seen from the sensor, ground axes, in voxel sides.
    lattice : Lattice
    ground_from_sensor : (3, 3) float
    directions : (B, 3) float
        All beams of the lattice in the ground frame, without zeros.
    ends : (B,) float
        Where each beam ends, in voxel sides.

    Returns
    -------
    (V,) int
    """
    counts = np.zeros(len(offsets), np.int64)
    voxel, beam = lattice.candidates(windows_of(offsets, 0.5, ground_from_sensor))
    for start in range(0, len(voxel), PAIRS_AT_ONCE):
        some = slice(start, start + PAIRS_AT_ONCE)
        through = _through(offsets, directions, ends, voxel[some], beam[some])
        counts += np.bincount(voxel[some][through], minlength=len(counts))
    return counts


def _through(
    offsets: Floats, directions: Floats, ends: Floats, voxel: Ints, beam: Ints
) -> NDArray[np.bool_]:
    """Whether each beam passes its cube: `measurement.cube_crossing`, an axis at a time."""
    enter, leave = np.zeros(len(voxel)), np.full(len(voxel), np.inf)
    for axis in range(3):
        step, center = directions[beam, axis], offsets[voxel, axis]
        t0, t1 = (center - 0.5) / step, (center + 0.5) / step
        np.maximum(enter, np.minimum(t0, t1), out=enter)
        np.minimum(leave, np.maximum(t0, t1), out=leave)
    return (enter < leave) & (enter <= ends[beam])
