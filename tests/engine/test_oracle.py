"""The definition against an oracle that shares no code with it."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.verify import oracle
from tests.engine import shapes

SIDE = 0.1
LIDARS = {
    "regular": {},
    "offsets": {"azimuth_offsets": np.radians(np.linspace(-5, 5, 16))},
    "limited": {"horizontal_fov": (math.radians(-60), math.radians(45))},
    "short": {"max_range": 7.3},
}


def azimuths_of(lidar):
    steps = np.arange(lidar.azimuth_count) * 2 * math.pi / lidar.azimuth_count
    low, high = lidar.horizontal_fov
    if high - low < 2 * math.pi - 1e-6:
        wrapped = (steps + math.pi) % (2 * math.pi) - math.pi
        steps = np.sort(wrapped[(wrapped >= low - 1e-9) & (wrapped <= high + 1e-9)])
    return steps[None, :] + lidar.azimuth_offsets[:, None]


def oracle_beams(sensor, centers, vehicle):
    origin = np.array(sensor.pose.position)
    lidar = sensor.model
    directions = oracle.beam_directions(lidar.elevations, azimuths_of(lidar), sensor.pose.rpy)
    ends = np.full(len(directions), lidar.max_range)
    if vehicle is not None:
        ends = np.minimum(ends, oracle.first_hits(origin, directions, vehicle.triangles)[0])
    return [oracle.count_beams(origin, directions, ends, c, side=SIDE) for c in centers]


def random_pose(rng, steep=True):
    reach = (180, 90, 180) if steep else (10, 10, 180)
    position = rng.uniform((-2.5, -1.2, 1.6), (2.5, 1.2, 2.3))
    return pe.Pose.from_degrees(position, rng.uniform(-1, 1, 3) * reach)


@pytest.mark.parametrize("kind", LIDARS)
@pytest.mark.parametrize("with_vehicle", [False, True], ids=["free", "on car"])
def test_beam_counts_equal_brute_force(kind, with_vehicle):
    rng = np.random.default_rng(sorted(LIDARS).index(kind))
    vehicle = shapes.box_car() if with_vehicle else None
    lidar = shapes.small_lidar(**LIDARS[kind])
    for trial in range(6):
        sensor = pe.Sensor("s", lidar, random_pose(rng, steep=trial % 2 == 0))
        origin = np.array(sensor.pose.position)
        near = origin + rng.normal(0, 0.4, (30, 3))
        far = rng.uniform((-20, -20, 0), (20, 20, 5), (60, 3))
        aimed = (
            origin
            + rng.uniform(1, 15, (60, 1))
            * (pe.beam_field(sensor, None).directions[rng.integers(0, lidar.beam_count, 60)])
        )
        centers = np.concatenate([near, far, aimed])
        counted = pe.measure(sensor, centers, SIDE, vehicle)
        assert counted.tolist() == oracle_beams(sensor, centers, vehicle)
        assert counted.any()


@pytest.mark.parametrize("hfov", [30.0, 60.0, 120.0])
def test_pixel_areas_equal_the_clipped_hull(hfov):
    rng = np.random.default_rng(int(hfov))
    for _ in range(4):
        sensor = shapes.camera(hfov, rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3) * (180, 80, 180))
        forward = sensor.pose.ground_from_sensor[:, 0]
        spread = rng.normal(0, 1, (200, 3)) * 0.8
        centers = np.array(sensor.pose.position) + rng.uniform(0.3, 30, (200, 1)) * (
            forward + spread * math.tan(math.radians(hfov / 2))
        )
        area = pe.measure(sensor, centers, SIDE)
        expected = [
            oracle.pixel_area(
                (1920, 1080),
                math.radians(hfov),
                sensor.pose.position,
                sensor.pose.rpy,
                center=c,
                side=SIDE,
            )
            for c in centers
        ]
        np.testing.assert_allclose(area, expected, rtol=1e-9, atol=1e-7)
        assert 20 < np.count_nonzero(area) < 200


def test_the_vehicle_hides_voxels_from_a_camera():
    sensor = shapes.camera(60.0, (-3.5, 0.0, 1.2))
    centers = np.array([[5.0, 0.0, 0.5], [5.0, 3.0, 0.5], [-2.8, 0.0, 1.2], [8.0, 0.0, 4.5]])
    free = pe.measure(sensor, centers, SIDE)
    seen = pe.measure(sensor, centers, SIDE, shapes.box_car())
    assert (free > 0).all()
    assert (seen > 0).tolist() == [False, True, True, True]
    assert seen[seen > 0].tolist() == free[seen > 0].tolist()


def test_a_hand_computed_voxel():
    """Straight ahead at 10 m a 0.1 m cube spans +-0.288 deg: three azimuths by three rows."""
    sensor = pe.Sensor("s", pe.catalog.load("Pandar64"), pe.Pose((0.0, 0.0, 2.0)))
    # nearest face at 9.95 m: |azimuth| < atan(0.05 / 9.95) = 0.2879 deg; rows at 0, +-1/6 deg
    assert pe.measure(sensor, [[10.0, 0.0, 2.0]], SIDE).tolist() == [9.0]


def test_a_sensor_inside_the_voxel_counts_every_beam():
    sensor = shapes.lidar_on_roof()
    assert pe.measure(sensor, [sensor.pose.position], SIDE).tolist() == [115_200.0]


@pytest.mark.parametrize("centers", [[1.0, 2.0, 3.0], [[0.0, 0.0, math.nan]]])
def test_bad_centres_are_refused(centers):
    with pytest.raises(pe.InputError, match="centers"):
        pe.measure(shapes.lidar_on_roof(), centers, SIDE)
