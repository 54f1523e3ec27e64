"""The LiDAR kernels give the definition's integer for every voxel."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.grid_sweep import MAX_COUNT, BeamGrid
from tests.engine import shapes
from tests.thorough import THOROUGH, pairs, tries

SPACE = pe.PerceptionSpace((-12, 12), (-8, 8), (0, 4), 0.2)

POSES = {
    "roof": ((-0.43, 0.0, 1.8), (0.0, 0.0, 0.0)),
    "on grid planes": ((0.0, 0.0, 2.0), (0.0, 0.0, 0.0)),
    "turned a quarter": ((0.2, -0.4, 2.0), (0.0, 0.0, 90.0)),
    "rolled, pitched, yawed": ((0.33, 0.21, 1.77), (10.0, 25.0, 77.0)),
    "looking down": ((0.33, 0.21, 2.77), (0.0, 90.0, 0.0)),
    "on the border": ((12.0, 0.1, 1.1), (0.0, 3.0, 180.0)),
    "behind the space": ((-14.0, 1.0, 1.5), (0.0, 2.0, 0.0)),
    "above the space": ((0.0, 0.0, 6.2), (0.0, 32.0, 0.0)),
    "below the space": ((1.0, 0.5, -0.7), (0.0, -10.0, 20.0)),
}

LIDARS = {
    "regular": {},
    "offsets": {"azimuth_offsets": np.radians(np.linspace(-5, 5, 24))},
    "limited": {"horizontal_fov": tuple(np.radians((-60, 45)))},
    "short": {"max_range": 5.1},
}


def rosette():
    """5,000 beams in no order, some straight up, down and back."""
    rng = np.random.default_rng(8)
    beams = rng.normal(size=(5000, 3)) * [1.0, 1.0, 0.5]
    beams[:6] = [[0, 0, 1], [0, 0, -1], [-1, 0, 0], [-1, -1e-17, 0], [1, 0, 0], [0, 1, 0]]
    return pe.Lidar.from_directions("rosette", beams, 40.0)


def lidar(kind):
    if kind == "pattern":
        return rosette()
    return shapes.small_lidar(24, 360, **LIDARS[kind])


def grid_counts(sensor, vehicle):
    return counts_of(sensor, vehicle, SPACE)


def counts_of(sensor, vehicle, space, times=1):
    grid = BeamGrid(space)
    field = pe.beam_field(sensor, vehicle)
    for _ in range(times):
        grid.add(sensor.pose.position, field.directions, field.ends)
    return grid.counts


def point_counts(sensor, vehicle, index):
    return shapes.counted(sensor, SPACE, index, vehicle)


def some_voxels(sensor, counts, rng):
    """Indices of voxels that are seen, of any voxels, and of voxels round the sensor."""
    seen = np.flatnonzero(counts)
    flat = np.concatenate([rng.choice(seen, 600), rng.integers(0, SPACE.size, 600)])
    index = np.stack(np.unravel_index(flat, SPACE.shape), axis=1)
    here = ((np.array(sensor.pose.position) - SPACE.origin) / SPACE.interval).astype(int)
    near = np.clip(here + rng.integers(-4, 5, (200, 3)), 0, np.array(SPACE.shape) - 1)
    return np.concatenate([index, near])


@pytest.mark.parametrize(("pose", "with_vehicle"), pairs(POSES, [False, True]))
def test_grid_and_points_equal_the_definition(pose, with_vehicle):
    rng = np.random.default_rng(list(POSES).index(pose))
    vehicle = shapes.box_car() if with_vehicle else None
    sensor = pe.Sensor("s", lidar("regular"), pe.Pose.from_degrees(*POSES[pose]))
    counts = grid_counts(sensor, vehicle)
    index = some_voxels(sensor, counts, rng)
    centers = SPACE.center_of(index)
    defined = pe.measure(sensor, centers, SPACE.interval, vehicle)
    assert np.count_nonzero(defined) > 100
    assert counts[tuple(index.T)].tolist() == np.minimum(defined, MAX_COUNT).tolist()
    assert point_counts(sensor, vehicle, index).tolist() == defined.tolist()


@pytest.mark.parametrize(
    ("kind", "rotation"),
    pairs([*LIDARS, "pattern"], [(4.0, -7.0, 33.0), (0.0, 0.0, 0.0), (90.0, 0.0, 0.0)]),
)
def test_every_kind_of_lidar(kind, rotation):
    rng = np.random.default_rng(5)
    sensor = pe.Sensor("s", lidar(kind), pe.Pose.from_degrees((0.1, 0.2, 1.9), rotation))
    counts = grid_counts(sensor, shapes.box_car())
    index = some_voxels(sensor, counts, rng)
    centers = SPACE.center_of(index)
    defined = pe.measure(sensor, centers, SPACE.interval, shapes.box_car())
    assert counts[tuple(index.T)].tolist() == defined.tolist()
    assert point_counts(sensor, shapes.box_car(), index).tolist() == defined.tolist()


def test_every_voxel_of_the_grid_equals_the_points_kernel():
    """Two kernels that share no method, over all 384,000 voxels."""
    sensor = pe.Sensor("s", lidar("offsets"), pe.Pose.from_degrees((0.0, 0.0, 1.8), (0, 1.5, 45.0)))
    counts = grid_counts(sensor, shapes.box_car())
    index = np.stack(np.unravel_index(np.arange(SPACE.size), SPACE.shape), axis=1)
    points = point_counts(sensor, shapes.box_car(), index)
    differing = np.count_nonzero(points != counts.reshape(-1))
    assert differing <= SPACE.size // 10_000  # voxels grazed within rounding
    assert differing == 0  # and on this pose there are none


def test_the_grid_holds_the_beams_of_the_definition_on_the_full_space():
    """Pandar64 at the paper's placement: 3,000 of 64 million voxels looked up.

    By default 800 of half a million, five times as long.
    """
    rng = np.random.default_rng(0)
    space, some = pe.PerceptionSpace(interval=0.1 if THOROUGH else 0.5), tries(400, 1500)
    sensor = shapes.lidar_on_roof()
    counts = counts_of(sensor, shapes.box_car(), space)
    flat = np.concatenate(
        [rng.choice(np.flatnonzero(counts), some), rng.integers(0, space.size, some)]
    )
    index = np.stack(np.unravel_index(flat, space.shape), axis=1)
    defined = pe.measure(sensor, space.center_of(index), space.interval, shapes.box_car())
    assert counts.reshape(-1)[flat].tolist() == defined.tolist()


def test_counts_hold_at_their_maximum():
    """The voxel that holds a Pandar64 is met by 115,200 beams; the grid says 65,535."""
    sensor = shapes.lidar_on_roof(position=(0.1, 0.1, 2.1))
    counts = counts_of(sensor, None, SPACE, times=2)
    assert counts[60, 40, 10] == MAX_COUNT
    defined = pe.measure(sensor, SPACE.center_of(np.array([[60, 40, 10], [61, 40, 10]])), 0.2)
    assert defined[0] == 115_200
    assert counts[61, 40, 10] == 2 * defined[1] < MAX_COUNT


def test_a_pattern_of_a_lidar_s_own_beams_is_that_lidar():
    regular = lidar("regular")
    pattern = pe.Lidar.from_directions("pattern", regular.directions, regular.max_range)
    pose = pe.Pose.from_degrees((0.13, 0.27, 1.91), (1.0, 2.0, 3.0))
    a, b = (counts_of(pe.Sensor("s", m, pose), shapes.box_car(), SPACE) for m in (regular, pattern))
    assert np.count_nonzero(a != b) <= a.size // 10_000  # beams differ in their last bit


@pytest.mark.parametrize("beams", [[], [[1, 0]], [[0, 0, 0]], [[1, 0, np.nan]]])
def test_impossible_patterns_are_refused(beams):
    with pytest.raises(pe.InputError, match="mine: directions"):
        pe.Lidar.from_directions("mine", beams, 10.0)
