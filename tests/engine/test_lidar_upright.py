"""The upright kernel gives the definition's integer, or says that it is unsure."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.tie_rules import position_in_voxels
from pe_core.sensors.lidar.upright import MAX_AZIMUTHS, SlopeCounts, Upright
from tests.engine import shapes
from tests.thorough import pairs, tries

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


def voxels_round(position, rng, count):
    """Indices of voxels near and far, and many along the axes through the sensor."""
    shape = np.array(SPACE.shape)
    here = np.floor((np.array(position) - SPACE.origin) / SPACE.interval).astype(int)
    anywhere = rng.integers(0, shape, (count, 3))
    near = here + rng.integers(-30, 31, (count, 3))
    on_axes = rng.integers(0, shape, (count, 3))
    on_axes[::2, 0] = here[0] + rng.integers(-1, 2, len(on_axes[::2]))
    on_axes[1::2, 1] = here[1] + rng.integers(-1, 2, len(on_axes[1::2]))
    level = rng.integers(0, shape, (count, 3))
    level[:, 2] = here[2] + rng.integers(-1, 2, count)
    return np.clip(np.concatenate([anywhere, near, on_axes, level]), 0, shape - 1)


def counted(sensor, index, vehicle=None, enough=None):
    return shapes.counted(sensor, SPACE, index, vehicle, enough)


@pytest.mark.parametrize(("place", "yaw"), pairs(PLACES, [0.0, 90.0, -180.0, 33.3, 0.2]))
def test_it_equals_the_definition(place, yaw):
    rng = np.random.default_rng([list(PLACES).index(place), int(yaw * 10) % 3600])
    sensor = pe.Sensor("s", PANDAR64, pe.Pose.from_degrees(PLACES[place], (0.0, 0.0, yaw)))
    index = voxels_round(PLACES[place], rng, tries(60, 150))
    defined = pe.measure(sensor, SPACE.center_of(index), SPACE.interval)
    assert counted(sensor, index).tolist() == defined.tolist()
    few = np.minimum(counted(sensor, index, enough=10), 10)
    assert few.tolist() == np.minimum(defined, 10).tolist()


@pytest.mark.parametrize("seed", range(tries(2, 6)))
def test_it_equals_the_definition_on_a_vehicle(seed):
    rng = np.random.default_rng(seed)
    place = rng.uniform((-2.5, -1.0, 0.5), (2.5, 1.0, 2.2)).round(2)
    yaw = float(rng.choice([0.0, rng.uniform(-180, 180)]))
    sensor = pe.Sensor("s", PANDAR64, pe.Pose.from_degrees(place, (0.0, 0.0, yaw)))
    index = voxels_round(place, rng, tries(60, 150))
    defined = pe.measure(sensor, SPACE.center_of(index), SPACE.interval, shapes.box_car())
    assert counted(sensor, index, shapes.box_car()).tolist() == defined.tolist()


@pytest.mark.parametrize(
    "model",
    [
        shapes.small_lidar(3, 7),  # an odd number of azimuths is not for this kernel
        shapes.small_lidar(3, 8),
        shapes.small_lidar(1, 360),
        shapes.small_lidar(24, 3600, max_range=9.0),
        pe.Lidar("up and down", np.radians([-89.0, 0.0, 90.0]), 36, 60.0),
        pe.Lidar("twice the same", np.radians([-5.0, -5.0, 0.0, 0.0]), 720, 60.0),
    ],
    ids=lambda m: f"{m.name} {len(m.elevations)}x{m.azimuth_count}",
)
def test_every_kind_of_lidar(model):
    rng = np.random.default_rng(3)
    place = (0.5, -0.3, 1.7)
    sensor = pe.Sensor("s", model, pe.Pose.from_degrees(place, (0.0, 0.0, 45.0)))
    index = voxels_round(place, rng, tries(120, 300))
    defined = pe.measure(sensor, SPACE.center_of(index), SPACE.interval)
    assert counted(sensor, index).tolist() == defined.tolist()


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


def test_no_voxels_have_no_counts():
    assert counted(shapes.lidar_on_roof(), np.zeros((0, 3), int)).tolist() == []
