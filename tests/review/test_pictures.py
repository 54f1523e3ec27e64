"""Rendered pictures: positions of objects in them, shadows, and reproducible bytes."""

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import scene
from pe_core.catalog import load
from pe_tools.page import ReportContext
from pe_tools.page.pictures import vehicle_picture as picture_module
from pe_tools.page.pictures.brackets import painted_post, post_of
from pe_tools.page.pictures.painted_mesh import painted_vehicle
from pe_tools.page.pictures.ray_scene import RayCamera, RayScene, Viewpoint
from pe_tools.page.pictures.vehicle_picture import vehicle_picture
from tests.engine.test_masks import decoded
from tests.review.conftest import box

WIDTH = 96
HEIGHT = 54
SIZE = (WIDTH, HEIGHT)


@pytest.fixture(scope="module")
def car():
    """A box 4 m long, and sensors of two kinds at its roof, left and right."""
    vehicle = pe.Vehicle(box((-2.0, -0.9, 0.2), (2.0, 0.9, 1.5)))
    rig = pe.Rig(
        [
            pe.Sensor("left", load("Velodyne VLP-16 Puck"), pe.Pose((0.0, 0.8, 1.6))),
            pe.Sensor("right", load("Camera 60 deg"), pe.Pose((0.0, -0.8, 1.6))),
        ]
    )
    return vehicle, rig


def test_a_view_projects_where_it_looks():
    """Its rays and its projection are each other's inverse; left of the eye is left."""
    view = Viewpoint((-10.0, 0.0, 2.0), (0.0, 0.0, 1.0), 40.0)
    camera = view.camera(SIZE)
    right = np.array([3.5, 48.0, 90.0])
    down = np.array([5.0, 27.0, 50.5])
    points = np.array(view.eye) + 7.0 * camera.rays_through(right, down)
    found = view.project(points, SIZE)
    np.testing.assert_allclose(found, (right, down), atol=1e-9)
    (x,), (y,) = view.project(np.array([[5.0, 2.0, 3.0]]), SIZE)
    assert x < SIZE[0] / 2 and y < SIZE[1] / 2  # what is left and higher


def test_a_still_shows_the_vehicle_and_is_the_same_each_time(car):
    vehicle, rig = car
    png = vehicle_picture(vehicle, rig, SIZE)
    assert png == vehicle_picture(vehicle, rig, SIZE)
    pixels = decoded(png).astype(int)
    assert pixels.shape == (54, 96, 3)
    assert abs(pixels[0, 0] - pixels[0, -1]).max() <= 1  # paper in the corners
    middle = pixels[20:34, 40:56].reshape(-1, 3)
    assert (pixels[0, 0] - middle).max(axis=1).mean() > 15  # the body is darker
    assert decoded(vehicle_picture(None, car[1], SIZE)).shape == (54, 96, 3)


def test_glass_is_looked_through_by_a_camera_alone():
    """A camera behind a pane sees the wall; a viewer sees the pane."""
    pane, wall = (box((x, -2, 0), (x + 0.1, 2, 3)) for x in (1.0, 4.0))
    parts = np.repeat([0, 1], [len(pane), len(wall)])
    vehicle = pe.Vehicle(np.concatenate([pane, wall]), parts, ["window", "wall"], ["window"])
    solids = RayScene([painted_vehicle(vehicle)])
    ahead = np.array([[1.0, 0.0, 0.0]])
    eye = np.array([0.0, 0.0, 1.0])
    for from_sensor, part in ((False, 0), (True, 1)):
        camera = RayCamera(
            eye,
            width=1,
            height=1,
            rays_through=lambda *_: ahead,
            pixel_rad=0.1,
            from_sensor=from_sensor,
        )
        assert solids.first_hits(camera, ahead).part.tolist() == [part]


def test_a_sensor_behind_the_body_is_reported_apart(car):
    """From ahead on the right: the one behind the box is dashed."""
    vehicle, rig = car
    behind = pe.Sensor("a <b>", rig["right"].model, pe.Pose((-2.3, 0.5, 0.6)))
    study = pe.Study(pe.Rig([rig["right"], behind]), vehicle)
    shown = ReportContext("car", pt.Outcome("score", study, study, before=None, after=None))
    drawing, key = picture_module.labelled_picture(shown, "alt")
    assert drawing.count('stroke-dasharray="4 4"') == 1 and drawing.count("<circle") == 3
    assert [row[:2] for row in key] == [(1, "right"), (2, "a <b>")]


@pytest.mark.parametrize("away", [0.0, 0.02, 0.1, 0.4])
@pytest.mark.parametrize("yaw", [0.0, 40.0])
def test_a_sensor_off_the_body_has_a_post_to_its_nearest_point(away, yaw):
    body = pe.Vehicle(box((-2.0, -0.9, 0.2), (2.0, 0.9, 1.5)))
    housing = scene.Housing("box", (0.1, 0.1, 0.1), optical_center=(0.0, 0.0, 0.05))
    side = 0.9
    pose = pe.Pose.from_degrees((0.0, side + 0.05 + away, 1.0), (0.0, 0.0, yaw))
    post = post_of(body, housing, pose)
    if away < 0.03:
        assert post is None, "its housing stands on the body"
        return
    low, high = painted_post(post).mesh.bounds
    assert low[1] == pytest.approx(side) and high[1] == pytest.approx(pose.position[1])
    assert np.abs((low + high)[[0, 2]] / 2.0 - [0.0, 1.0]).max() < 0.01
