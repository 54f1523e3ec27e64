"""Expected beam counts are the mean of whole counts."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_report.expected import expected_beams

SIDE = 0.1


@pytest.mark.parametrize("name", ["Pandar64", "HDL-64E"])
@pytest.mark.parametrize("distance", [8.0, 25.0])
def test_expected_counts_are_the_mean_of_whole_ones(name, distance):
    """Voxels all over a piece of the scene, where channels are evenly spread."""
    rng = np.random.default_rng(1)
    sensor = pe.Sensor("lidar", pe.catalog.load(name), pe.Pose((0.0, 0.0, 0.0)))
    azimuth = rng.uniform(-math.pi, math.pi, 4000)
    slope = np.tan(np.radians(rng.uniform(-5.0, 1.0, 4000)))
    centers = distance * np.stack([np.cos(azimuth), np.sin(azimuth), slope], axis=1)
    whole = pe.measure(sensor, centers, SIDE)
    assert expected_beams(sensor.model, centers, SIDE).mean() == pytest.approx(
        whole.mean(), rel=0.04
    )


def test_nothing_is_expected_beyond_the_range_or_far_from_every_channel():
    lidar = pe.catalog.load("Pandar64")
    far = np.array([[lidar.max_range + 1.0, 0.0, 0.0], [1.0, 0.0, 5.0]])
    assert (expected_beams(lidar, far, SIDE) == 0.0).all()
