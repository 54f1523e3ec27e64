"""A LiDAR in words, with a small plot of its channels."""

from __future__ import annotations

import math

import numpy as np

from .model import Lidar

PLOT_ROWS = 24
BAR_WIDTH = 48


def figures(lidar: Lidar) -> list[str]:
    """Channels, azimuths, beams, range."""
    low, high = math.degrees(lidar.elevations.min()), math.degrees(lidar.elevations.max())
    left, right = (math.degrees(a) for a in lidar.horizontal_fov)
    return [
        f"channels        {len(lidar.elevations)}, {low:g} to {high:g} deg",
        f"azimuths        {len(lidar.azimuth_steps)}, {left:g} to {right:g} deg, "
        f"every {math.degrees(lidar.azimuth_step):.4g} deg",
        f"beams a frame   {lidar.beam_count}",
        f"range           {_range(lidar)}",
    ]


def _range(lidar: Lidar) -> str:
    """Maximum range, after the minimum if there is one."""
    least = f"{lidar.min_range:g} to " if lidar.min_range > 0.0 else ""
    return f"{least}{lidar.max_range:g} m"


def brief(lidar: Lidar) -> str:
    """Channels, field of view across and up, range."""
    across = math.degrees(lidar.horizontal_fov[1] - lidar.horizontal_fov[0])
    up = math.degrees(lidar.elevations.max() - lidar.elevations.min())
    fov = f"{min(across, 360.0):.0f} x {up:.0f} deg"
    return f"{len(lidar.elevations)} channels, {fov}, {lidar.max_range:g} m"


def channel_plot(lidar: Lidar) -> list[str]:
    """One row an elevation interval, top first; a bar of one mark a channel."""
    degrees = np.degrees(lidar.elevations)
    counts, edges = np.histogram(degrees, bins=PLOT_ROWS)
    scale = min(1.0, BAR_WIDTH / counts.max())
    return [
        f"{(edges[i] + edges[i + 1]) / 2:8.2f} deg |{'#' * math.ceil(counts[i] * scale)}"
        for i in reversed(range(PLOT_ROWS))
    ]
