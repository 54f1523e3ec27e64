"""A LiDAR's field of view in triangles: at each azimuth from its lowest beam to its highest."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..view_patch import ViewPatch, grid_faces
from .model import Lidar

Floats = NDArray[np.float64]

THINNEST = math.radians(0.2)
"""What has no height, as a scanner of one channel, is drawn this high."""
POLE = math.radians(89.0)
"""Beams that come this near to the pole reach it."""
SCANNED = 8
"""A model of fewer azimuths than this has its beams one by one, at any azimuth."""


def beam_patch(lidar: Lidar, step: float) -> ViewPatch:
    """Return what lies between a LiDAR's beams, in triangles of about `step` [rad]."""
    band = _even_band if lidar.azimuth_count >= SCANNED else _uneven_band
    azimuths, low, high, closed = band(lidar, step)
    middle, half = (low + high) / 2.0, np.maximum((high - low) / 2.0, THINNEST / 2.0)
    low, high = np.maximum(middle - half, -np.pi / 2.0), np.minimum(middle + half, np.pi / 2.0)
    rows = max(math.ceil(float((high - low).max()) / step), 1) + 1
    elevation = low + np.linspace(0.0, 1.0, rows)[:, None] * (high - low)
    x, y = np.cos(elevation) * np.cos(azimuths), np.cos(elevation) * np.sin(azimuths)
    directions = np.stack([x, y, np.sin(elevation)], axis=-1).reshape(-1, 3)
    index = np.arange(len(directions)).reshape(rows, -1)
    for row, angles in ((0, -low), (-1, high)):
        if closed and float(angles.min()) > POLE:
            index[row] = index[row, 0]
            directions[index[row, 0]] = 0.0, 0.0, 1.0 if row else -1.0
    return ViewPatch(directions, grid_faces(index, closed=closed))


def _even_band(lidar: Lidar, step: float) -> tuple[Floats, Floats, Floats, bool]:
    """Azimuths of columns, lowest and highest elevation at each, and whether they close."""
    steps, offsets = lidar.azimuth_steps, lidar.azimuth_offsets
    closed = len(steps) == lidar.azimuth_count
    first = float(steps[0]) * lidar.azimuth_step + float(offsets.min())
    last = float(steps[-1]) * lidar.azimuth_step + float(offsets.max())
    azimuths = _columns(first, last, step, closed)
    flat = np.ones(len(azimuths))
    return azimuths, flat * lidar.elevations.min(), flat * lidar.elevations.max(), closed


def _uneven_band(lidar: Lidar, step: float) -> tuple[Floats, Floats, Floats, bool]:
    """As `_even_band`, of beams that are anywhere: the columns keep clear of the widest gap."""
    azimuths, elevations = np.mod(lidar.azimuth_offsets, 2.0 * np.pi), lidar.elevations
    order = np.argsort(azimuths, kind="stable")
    azimuths, elevations = azimuths[order], elevations[order]
    gaps = np.diff(azimuths, append=azimuths[0] + 2.0 * np.pi)
    after = int(np.argmax(gaps)) + 1
    closed = float(gaps.max()) < 4.0 * step
    azimuths = np.concatenate([azimuths[after:], azimuths[:after] + 2.0 * np.pi])
    elevations = np.concatenate([elevations[after:], elevations[:after]])
    columns = _columns(float(azimuths[0]), float(azimuths[-1]), step, closed)
    apart = columns[1] - columns[0]
    column = np.rint((azimuths - columns[0]) / apart).astype(np.int64) % len(columns)
    low, high = np.full(len(columns), np.inf), np.full(len(columns), -np.inf)
    np.minimum.at(low, column, elevations)
    np.maximum.at(high, column, elevations)
    some = np.isfinite(low)
    period = 2.0 * np.pi
    low = np.interp(columns, columns[some], low[some], period=period)
    return columns, low, np.interp(columns, columns[some], high[some], period=period), closed


def _columns(first: float, last: float, step: float, closed: bool) -> Floats:
    if closed:
        count = max(math.ceil(2.0 * math.pi / step), 3)
        return first + np.arange(count) * (2.0 * math.pi / count)
    middle, half = (first + last) / 2.0, max((last - first) / 2.0, THINNEST / 2.0)
    return np.linspace(middle - half, middle + half, max(math.ceil(2.0 * half / step), 1) + 1)
