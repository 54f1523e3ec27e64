"""The fast pixel areas against the exact ones."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.kernels.camera_grid import CameraPlanes
from pe_core.kernels.camera_points import pixel_areas
from tests.engine import shapes


@pytest.mark.parametrize("hfov", [30.0, 60.0, 120.0])
@pytest.mark.parametrize("rotation", [(0, 0, 0), (0, 10, 0), (15, 40, 120), (90, -30, -60)])
def test_areas_are_within_one_percent_beyond_a_metre(hfov, rotation):
    rng = np.random.default_rng(1)
    sensor = shapes.camera(hfov, (0.3, -0.2, 1.4), rotation)
    centers = np.array(sensor.pose.position) + rng.uniform(-8, 8, (20_000, 3))
    exact = pe.measure(sensor, centers, 0.1)
    fast = pixel_areas(sensor.model, sensor.pose, centers, 0.1, None)
    seen = exact > 1e-6
    assert (fast[~seen] <= 1e-6).all()
    error = np.abs(fast[seen] / exact[seen] - 1.0)
    assert seen.sum() > 100
    assert error.max() < 0.01


def test_planes_of_the_grid_equal_the_points():
    space = pe.PerceptionSpace((-8, 8), (-8, 8), (0, 4), 0.2)
    sensor = shapes.camera(90.0, (-1.0, 0.1, 1.3), (3.0, 8.0, 20.0))
    vehicle = shapes.box_car()
    seen = vehicle.seen_from(sensor.pose.position, "camera")
    planes = slice(30, 60)
    block = CameraPlanes(sensor.model, sensor.pose, space, seen).areas(planes)
    index = np.stack(np.unravel_index(np.arange(block.size), block.shape), axis=1)
    index[:, 0] += planes.start
    exact = pe.measure(sensor, space.center_of(index), 0.2, vehicle)
    assert ((block.reshape(-1) > 0) == (exact > 0)).all()
    np.testing.assert_allclose(block.reshape(-1), exact, rtol=0.01, atol=1e-3)


def test_a_face_straight_ahead():
    """A 0.1 m face at 9.95 m, focal length 1662.77 px: (16.711 px)^2."""
    sensor = shapes.camera(60.0, (0.0, 0.0, 1.0))
    area = pe.measure(sensor, [[10.0, 0.0, 1.0]], 0.1)
    assert area[0] == pytest.approx((0.1 * 1662.7688 / 9.95) ** 2, rel=1e-6)


def test_behind_and_beside_the_camera_nothing_is_seen():
    sensor = shapes.camera(60.0, (0.0, 0.0, 1.0))
    centers = [[-5.0, 0.0, 1.0], [0.0, 5.0, 1.0], [0.02, 0.0, 1.0], [5.0, 5.0, 1.0]]
    assert pe.measure(sensor, centers, 0.1).tolist() == [0.0] * 4
