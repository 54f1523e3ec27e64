"""The upright kernel gives the definition's integer, or says that it is unsure."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.tie_rules import position_in_voxels
from pe_core.sensors.lidar.upright import MAX_AZIMUTHS, SlopeCounts, Upright

SPACE = pe.PerceptionSpace((-30, 30), (-15, 15), (0, 5), 0.1)
PANDAR64 = pe.catalog.load("Pandar64")

PLACES = {
    "roof": (-0.43, 0.0, 1.8),
    "on grid planes": (0.0, 0.0, 2.0),
    "between": (0.537, -0.281, 1.713),
    "on a corner of the space": (-30.0, -15.0, 0.0),
    "behind the space": (-41.0, 1.0, 1.5),
    "above the space": (0.0, 0.3, 8.2),
    "below the space": (2.0, 0.5, -3.7),
    "beside the space": (0.0, 19.0, 2.0),
}


@pytest.mark.parametrize("place", ["roof", "on grid planes", "between"])
def test_few_voxels_are_left_to_the_exact_test(place):
    """Ties as well: whole layers and rows of voxels touch a beam along a face at round numbers."""
    rng = np.random.default_rng(4)
    index = rng.integers(0, SPACE.shape, (50_000, 3))
    position = position_in_voxels(PLACES[place], SPACE.origin, SPACE.interval)
    table = SlopeCounts.of(PANDAR64.elevations, PANDAR64.azimuth_count)
    stopped = np.zeros((64, PANDAR64.azimuth_count), bool)
    upright = Upright.of(table, np.eye(3), stopped, 0.0)
    counts, unsure = upright.count([c.astype(np.float32) for c in index.T], position)
    offset = (index + 0.5 - position) * SPACE.interval
    near = np.hypot(offset[:, 0], offset[:, 1]) < 0.15 / math.radians(0.2) / MAX_AZIMUTHS
    assert unsure[~near].mean() < 0.02
    assert counts[~unsure].max() > 10
