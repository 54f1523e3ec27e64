"""Voxels within a LiDAR's minimum range: their beams are counted one by one.

They are few, so the kernels know nothing of a minimum range: what they found is counted again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .definition import cube_crossing
from .lattice import windows_of
from .points import CUBE_REACH, PlacedLidar, VoxelPoints, count_pairs

AT_ONCE = 64
"""Voxels looked at together: next to the sensor each may be met by all beams."""


def count_again_near(
    voxels: VoxelPoints,
    lidar: PlacedLidar,
    counts: NDArray[np.signedinteger],
    nearest: float,
    is_free: bool = False,
) -> NDArray[np.signedinteger]:
    """Return counts (V,) in which beams that leave a voxel nearer than `nearest` [m] are none.

    With `is_free` as if there were no vehicle.
    """
    if nearest <= 0.0:
        return counts
    least = nearest / lidar.side
    offsets = voxels.offsets(lidar.position)
    near = np.flatnonzero((offsets * offsets).sum(axis=1) < (least + CUBE_REACH) ** 2)
    counts = counts.copy()
    for start in range(0, len(near), AT_ONCE):
        some = near[start : start + AT_ONCE]
        own = offsets[some]
        windows = windows_of(own, 0.5, lidar.ground_from_sensor)
        voxel, beam = lidar.lattice.candidates(windows)
        _, leave = cube_crossing(own[voxel], np.stack(list(lidar.beams.speeds(beam)), axis=1))
        kept = np.flatnonzero(leave >= least)
        if not is_free:
            kept = kept[_come_far(lidar, beam[kept], least)]
        counts[some] = count_pairs(own, lidar, voxel[kept], beam[kept], is_free)
    return counts


def _come_far(lidar: PlacedLidar, beams: NDArray[np.int64], least: float) -> NDArray[np.bool_]:
    """Whether beams are not stopped nearer than the minimum range, in sides."""
    far = np.ones(len(beams), bool)
    at = np.flatnonzero(lidar.ends.stopped[beams])
    far[at] = lidar.ends.some(beams[at]) / lidar.side >= least
    return far
