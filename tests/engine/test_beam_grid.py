"""Beams of several LiDARs in one grid of counts."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.grid_sweep import MAX_COUNT, BeamGrid
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-6, 6), (-4, 4), (0, 4), 0.2)


def pandar(position, rotation=(0.0, 0.0, 0.0)):
    return shapes.lidar_on_roof(None, position, rotation)


def dense(position):
    """A LiDAR of which more than 65,535 beams go the same way."""
    elevations = np.radians(np.linspace(-25.0, 15.0, 80))
    return shapes.lidar_on_roof(pe.Lidar("dense", elevations, 3600, 40.0), position)


def add_to(grid, sensor):
    field = pe.beam_field(sensor, None)
    grid.add(sensor.pose.position, field.directions, field.ends)


def counts_of(*sensors):
    grid = BeamGrid(SPACE)
    for sensor in sensors:
        add_to(grid, sensor)
    return grid.counts


@pytest.mark.parametrize(
    "positions",
    [
        ((0.1, 0.1, 2.1), (3.1, -1.3, 1.1)),
        ((0.1, 0.1, 2.1), (0.5, 0.1, 2.1), (0.1, 0.3, 1.9)),  # each in the others' thick
        ((-5.99, -3.99, 0.01), (5.99, 3.99, 3.99)),
        ((-7.0, 0.1, 1.0), (0.1, 0.1, 1.1)),  # the first stands outside
    ],
)
def test_several_lidars_add_up_and_hold(positions):
    sensors = [pandar(p, (0.0, 5.0 * k, 10.0)) for k, p in enumerate(positions)]
    alone = [counts_of(s).astype(int) for s in sensors]
    assert counts_of(*sensors).tolist() == np.minimum(sum(alone), MAX_COUNT).tolist()
    assert max(counts.max() for counts in alone) == MAX_COUNT


def test_more_beams_one_way_than_a_count_holds():
    """Equal to the same beams added in small portions, and summed without a limit."""
    sensor = dense((0.1, 0.1, 2.1))
    field = pe.beam_field(sensor, None)
    total = np.zeros(SPACE.shape, int)
    for some in np.array_split(np.arange(len(field.ends)), 5):
        grid = BeamGrid(SPACE)
        grid.add(sensor.pose.position, field.directions[some], field.ends[some])
        total += grid.counts
    assert total.max() == 288_000
    assert counts_of(sensor).tolist() == np.minimum(total, MAX_COUNT).tolist()


def test_a_cleared_grid_is_as_new():
    grid = BeamGrid(SPACE)
    add_to(grid, pandar((0.1, 0.1, 2.1)))
    grid.clear()
    assert not grid.counts.any()
    add_to(grid, pandar((3.0, 1.0, 1.0)))
    assert grid.counts.tolist() == counts_of(pandar((3.0, 1.0, 1.0))).tolist()
