"""Minimum range of a LiDAR: by hand, and grid and sample as the definition has it."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors import Voxels, kind_of
from tests.engine import shapes
from tests.thorough import THOROUGH, pairs

SPACE = pe.PerceptionSpace((-3, 4), (-3, 3), (0, 2.5), 0.25 if THOROUGH else 0.5)
INDEX = np.stack(np.unravel_index(np.arange(SPACE.size), SPACE.shape), axis=1)
PATTERN = np.random.default_rng(2).normal(size=(700, 3))


def models(nearest):
    low = nearest and nearest * 0.5
    return {
        "upright": shapes.small_lidar(min_range=nearest),
        "tilted": shapes.small_lidar(min_range=nearest),
        "sector": shapes.small_lidar(horizontal_fov=(-1.0, 2.0), min_range=nearest),
        "pattern": pe.Lidar.from_directions("pattern", PATTERN, 60.0, nearest),
        "short": shapes.small_lidar(max_range=2.0, min_range=low),
    }


@pytest.mark.parametrize(("which", "at"), pairs(models(0.0), [(0.0, 0.0, 1.75), (-3.5, 0.3, 1.6)]))
def test_grid_and_sample_equal_the_definition(which, at):
    rotation = (3, 8, 20) if which == "tilted" else (0, 0, 20)
    vehicle = shapes.box_car()
    sensor, free = (
        shapes.lidar_on_roof(models(nearest)[which], at, rotation) for nearest in (1.5, 0.0)
    )
    exact = pe.measure(sensor, SPACE.center_of(INDEX), SPACE.interval, vehicle)
    assert 0 < exact.sum() < pe.measure(free, SPACE.center_of(INDEX), SPACE.interval, vehicle).sum()
    kind = kind_of(sensor)
    grid = kind.on_grid(SPACE, vehicle, 60000)
    planes = grid.planes([[grid.prepare(sensor)]], None)[0]
    assert (planes(slice(0, SPACE.shape[0])).reshape(-1) == exact).all()
    sample = kind.on_sample(Voxels(SPACE, INDEX, SPACE.center_of(INDEX)), vehicle, 60000)
    assert (sample.measure(sensor, False).m == exact).all()
    unhidden = pe.measure(sensor, SPACE.center_of(INDEX), SPACE.interval)
    assert (sample.unoccluded(sensor) == unhidden).all()


def test_a_beam_counts_where_it_leaves_a_voxel_no_nearer():
    """One beam along x from 0.5 in a row of metre cubes: with 1.6 m the first seen ends at 2.5."""
    ahead = pe.Lidar.from_directions("one", [[1.0, 0.0, 0.0]], 100.0, 1.6)
    sensor = pe.Sensor("one", ahead, pe.Pose((0.5, 0.5, 0.5)))
    centers = [[x + 0.5, 0.5, 0.5] for x in range(5)]
    assert pe.measure(sensor, centers, 1.0).tolist() == [0, 0, 1, 1, 1]


def test_the_least_is_below_the_most():
    with pytest.raises(pe.InputError, match="small: min_range: expected a length below max_range"):
        shapes.small_lidar(max_range=5.0, min_range=5.0)
