"""A LiDAR exactly over the middle of the vehicle: a sample counts as the definition does."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors import Voxels, kind_of
from tests.engine import shapes


@pytest.mark.parametrize("at", [(0.0, 0.0, 1.75), (0.0, 0.0, 1.85), (-0.35, 0.0, 1.6)])
def test_beams_down_from_the_middle_are_stopped(at):
    space = pe.PerceptionSpace((-3, 3), (-3, 3), (0, 2), 0.5)
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    sensor = shapes.lidar_on_roof(shapes.small_lidar(), at, (0, 0, 20))
    vehicle, centers = shapes.box_car(), space.center_of(index)
    exact = pe.measure(sensor, centers, space.interval, vehicle)
    assert exact.sum() < pe.measure(sensor, centers, space.interval).sum()
    sample = kind_of(sensor).on_sample(Voxels(space, index, centers), vehicle, 60000)
    assert (sample.measure(sensor, False).m == exact).all()
