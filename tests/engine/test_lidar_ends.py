"""Beams cast when they are asked for: all that the vehicle stops are known beforehand, and no bit
of a count depends on which were cast."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.beams import FixedEnds, LazyEnds, RotatedBeams
from pe_core.sensors.lidar.definition import position_in_voxels
from pe_core.sensors.lidar.lattice import lattice_of
from pe_core.sensors.lidar.occlusion import occlusion_candidates
from pe_core.sensors.lidar.voxel_beams import PlacedLidar, VoxelPoints, count_voxel_beams
from tests.engine import shapes

CAR = shapes.box_car(3)
SPACE = shapes.small_space()
PLACES = {
    "roof": ((-0.4, 0.1, 1.7), (0.0, 0.0, 0.0)),
    "roof, turned": ((-0.4, 0.1, 1.7), (0.0, 0.0, 33.3)),
    "tilted": ((-0.43, 0.0, 1.8), (7.0, -11.0, 20.0)),
    "corner": ((2.35, 0.95, 0.7), (0.0, 2.0, 45.0)),
    "flush": ((0.2, 0.1, 1.405), (1.0, 0.0, 0.0)),
    "inside": ((0.0, 0.1, 0.6), (0.0, 5.0, 0.0)),
    "lying": ((3.5, 0.2, 0.8), (90.0, 0.0, 10.0)),
    "upside down": ((0.1, -2.0, 1.0), (180.0, 3.0, 0.0)),
    "afar": ((-15.0, 6.0, 3.0), (0.0, 8.0, -20.0)),
}
POSES = {name: pe.Pose.from_degrees(at, turn) for name, (at, turn) in PLACES.items()}


def soup(seed):
    """Triangles of all sizes and slants, everywhere."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(-2.0, 0.6, (150, 1, 1))
    places = rng.uniform((-4.0, -3.0, 0.0), (4.0, 3.0, 2.5), (150, 3))
    return pe.Vehicle(places[:, None] + size * rng.normal(size=(150, 3, 3)))


def lidar(pose, model=None):
    model = model or shapes.small_lidar(24, 360)
    return pe.Sensor("lidar", model, pose)


def lazy(sensor, vehicle):
    return LazyEnds(sensor, RotatedBeams(sensor), vehicle)


def placed(sensor, ends):
    return PlacedLidar(
        lattice_of(sensor.model),
        position_in_voxels(sensor.pose.position, SPACE.origin, SPACE.interval),
        sensor.pose.ground_from_sensor,
        RotatedBeams(sensor),
        ends=ends,
        side=SPACE.interval,
    )


def some_voxels(count=3000):
    rng = np.random.default_rng(0)
    return VoxelPoints(np.stack([rng.integers(0, n, count) for n in SPACE.shape], axis=1))


@pytest.mark.parametrize("vehicle", [CAR, soup(1), soup(2)], ids=["car", "soup", "other soup"])
@pytest.mark.parametrize("pose", POSES)
def test_every_beam_that_is_stopped_may_be(pose, vehicle):
    sensor = lidar(POSES[pose], shapes.small_lidar(40, 720))
    ends = lazy(sensor, vehicle)
    stopped = pe.beam_field(sensor, vehicle).occluded_by >= 0
    assert stopped.any() and not (stopped & ~ends.occludable).any()


def test_a_vehicle_of_no_triangle_that_is_left_stops_nothing():
    """All of it glass, to a sensor that looks through it."""
    clear = pe.Vehicle(CAR.triangles, CAR.parts, CAR.part_names, glass=("body", "cabin"))
    sensor = lidar(POSES["tilted"])
    seen = clear.seen_from(sensor.pose.position, through_glass=True).seen
    lattice = lattice_of(sensor.model)
    assert not occlusion_candidates(seen, sensor.pose.ground_from_sensor, lattice).any()


@pytest.mark.parametrize("kind", ["full circle", "part of a circle"])
@pytest.mark.parametrize("pose", POSES)
def test_counts_are_those_of_all_beams_cast(pose, kind):
    """The plain way is to cast every beam."""
    part = {"horizontal_fov": (-2.6, 2.6)} if kind == "part of a circle" else {}
    sensor = lidar(POSES[pose], shapes.small_lidar(24, 360, **part))
    field = pe.beam_field(sensor, CAR)
    voxels = some_voxels()
    plain = count_voxel_beams(voxels, placed(sensor, FixedEnds(field.ends)))
    assert np.array_equal(count_voxel_beams(voxels, placed(sensor, lazy(sensor, CAR))), plain)
    free = count_voxel_beams(voxels, placed(sensor, FixedEnds(np.full_like(field.ends, 60.0))))
    assert (free >= plain).all()
    assert kind != "full circle" or (free > plain).any()
