"""The fast pixel areas against the exact ones."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric.fusion import VisibleRows
from pe_core.sensors.camera.grid_areas import CameraPlanes
from pe_core.sensors.camera.sample_areas import pixel_areas
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


def whole_grid(sensor, space, vehicle, block):
    """Areas (nx, ny, nz) from `CameraPlanes`, in runs of `block` planes."""
    seen = None if vehicle is None else vehicle.seen_from(sensor.pose.position, through_glass=True)
    camera = CameraPlanes(sensor.model, sensor.pose, space, seen)
    area = np.zeros(space.shape)
    for start in range(0, space.shape[0], block):
        planes = slice(start, min(start + block, space.shape[0]))
        view = camera.areas(planes)
        area[planes, view.rows] = view.m
    return area


POSES = {
    "level": ((-1.6, 0.1, 1.5), (0, 0, 0)),  # two sides of the frustum are parallel to z
    "tilted": ((-1.6, 0.1, 1.5), (3, 8, 20)),
    "on its side": ((0.0, 0.3, 2.0), (90, 0, 135)),
    "down": ((0.4, 0.2, 3.9), (10, 90, 0)),
    "up": ((3.0, 0.0, 0.1), (0, -90, 30)),
    "outside": ((-12.0, 9.0, 6.0), (0, 25, -40)),
}


@pytest.mark.parametrize("hfov", [40.0, 110.0])
@pytest.mark.parametrize("pose", POSES)
def test_planes_of_the_grid_equal_the_definition(pose, hfov):
    """All 128,000 voxels of a space with a car in it."""
    space = pe.PerceptionSpace((-8, 8), (-8, 8), (0, 4), 0.2)
    sensor, vehicle = shapes.camera(hfov, *POSES[pose]), shapes.box_car()
    index = np.stack(np.unravel_index(np.arange(space.size), space.shape), axis=1)
    exact = pe.measure(sensor, space.center_of(index), 0.2, vehicle)
    area = whole_grid(sensor, space, vehicle, 16).reshape(-1)
    assert np.count_nonzero(exact) > 300
    assert ((area > 0.0) == (exact > 0.0)).all()
    np.testing.assert_allclose(area, exact, rtol=0.004)


def test_planes_do_not_depend_on_how_many_are_asked_for():
    space, sensor = shapes.small_space(), shapes.camera(70.0, (0.2, -0.3, 1.6), (4, 5, 30))
    vehicle = shapes.box_car()
    assert (
        whole_grid(sensor, space, vehicle, 1).tolist()
        == whole_grid(sensor, space, vehicle, 7).tolist()
        == whole_grid(sensor, space, vehicle, 80).tolist()
    )


def test_views_add_up():
    some, more = (
        VisibleRows(slice(1, 3), np.ones((2, 2, 4))),
        VisibleRows(slice(2, 5), np.ones((2, 3, 4))),
    )
    none = VisibleRows(slice(0, 0), np.ones((2, 0, 4)))
    total = some + more
    assert total.rows == slice(1, 5)
    assert total.m[1, :, 3].tolist() == [1.0, 2.0, 1.0, 1.0]
    assert (none + some) is some and (some + none) is some


def test_a_face_straight_ahead():
    """A 0.1 m face at 9.95 m, focal length 1662.77 px: (16.711 px)^2."""
    sensor = shapes.camera(60.0, (0.0, 0.0, 1.0))
    area = pe.measure(sensor, [[10.0, 0.0, 1.0]], 0.1)
    assert area[0] == pytest.approx((0.1 * 1662.7688 / 9.95) ** 2, rel=1e-6)


def test_behind_and_beside_the_camera_nothing_is_seen():
    sensor = shapes.camera(60.0, (0.0, 0.0, 1.0))
    centers = [[-5.0, 0.0, 1.0], [0.0, 5.0, 1.0], [0.02, 0.0, 1.0], [5.0, 5.0, 1.0]]
    assert pe.measure(sensor, centers, 0.1).tolist() == [0.0] * 4
