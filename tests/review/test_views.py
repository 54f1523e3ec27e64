"""Sensor views: left is left, the camera's own lens, and figures of the true size."""

import dataclasses
import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import pe_core as pe
from pe_core.catalog import load
from pe_core.sensors import Camera, KannalaBrandt
from pe_tools.page.pictures import sensor_views
from pe_tools.page.pictures.reference_figures import reference_figures
from pe_tools.page.pictures.sensor_views import camera_picture, lidar_picture, ray_camera
from pe_tools.page.sections.visibility import sensor_details
from pe_tools.wording import percent
from tests.engine.test_masks import decoded
from tests.review.conftest import box, html_of

SMALL = Camera("small", 128, 72, math.radians(60.0))
FISHEYE = Camera("fish", 96, 96, lens=KannalaBrandt(30.0, 30.0, 48.0, 48.0, fov=math.radians(170)))


def mounted(model, yaw_deg=0.0, at=(0.0, 0.0, 1.4), pitch_deg=0.0):
    return pe.Sensor("eye", model, pe.Pose.from_degrees(at, (0.0, pitch_deg, yaw_deg)))


@pytest.mark.parametrize("yaw", [0.0, 90.0, 200.0])
def test_they_stand_where_it_looks_people_left_cars_right(yaw):
    sensor = mounted(SMALL, yaw)
    found = reference_figures(sensor, math.radians(60.0), None)
    assert [(c.name, c.distance) for c in found if c.name == "person"] == [
        ("person", d) for d in (40.0, 20.0, 10.0, 5.0)
    ]
    for each in found:
        way = sensor.pose.ground_from_sensor.T @ (np.array(each.top) - sensor.pose.position)
        assert way[0] > 0 and (way[1] > 0) == (each.name == "person")
        corners = each.painted.mesh.triangles.reshape(-1, 3)[:, :2]
        nearest = np.hypot(*corners.T).min()
        assert nearest == pytest.approx(each.distance, abs=0.3)


@pytest.mark.parametrize("model", [SMALL, FISHEYE])
def test_a_camera_s_picture_has_people_left_and_cars_right(model):
    """Coats are amber, cars are blue; what is left of ahead is in the left half."""
    found = camera_picture(mounted(model), None)
    pixels = decoded(found.png).astype(int)
    assert pixels.shape == (model.height, model.width, 3)
    amber = (pixels[..., 0] > pixels[..., 2] + 90) & (pixels[..., 1] > 80)
    blue = (pixels[..., 2] > pixels[..., 0] + 80) & (pixels[..., 2] > pixels[..., 1] + 40)
    middle = model.width / 2
    assert amber.any() and np.nonzero(amber)[1].max() < middle + 1
    assert blue.any() and np.nonzero(blue)[1].min() > middle - 2
    assert len(found.png) < 150_000 and found == camera_picture(mounted(model), None)


def test_each_pixel_looks_where_the_lens_says(monkeypatch):
    """A picture that is made smaller has the lens of the large one."""
    monkeypatch.setattr(sensor_views, "MAX_WIDTH", 640)
    large = dataclasses.replace(SMALL, width=1920, height=1080)
    sensor = mounted(large, 30.0, pitch_deg=5.0)
    shot, scale = ray_camera(sensor)
    assert (shot.width, shot.height) == (640, 360) and scale == pytest.approx(1 / 3)
    found = shot.rays_through(np.array([100.0, 320.0]), np.array([50.0, 180.0]))
    turned = sensor.pose.ground_from_sensor
    rays = large.projection.unproject(np.array([300.0, 960.0]), np.array([150.0, 540.0]))
    np.testing.assert_allclose(found, rays @ turned.T, atol=1e-12)


def test_a_lidar_s_picture_has_left_on_the_left():
    """A wall on the left is orange in the left half; marks of people are left of the cars'."""
    model = load("Velodyne VLP-16 Puck")
    wall = pe.Vehicle(box((-1.0, 1.0, 0.0), (1.0, 1.2, 3.0)))
    found = lidar_picture(mounted(model), wall)
    pixels = decoded(found.png).astype(int)
    assert pixels.shape == (found.height, found.width, 3) and found.width == 720
    orange = (pixels[..., 0] > 170) & (pixels[..., 2] < 80) & (pixels[..., 1] < 170)
    assert orange[:, 150:210].all() and not orange[:, 300:].any()
    places = {words: x for x, words in found.bottom_labels}
    assert places["left"] == pytest.approx(180, abs=2) and places["ahead"] == pytest.approx(
        360, abs=2
    )
    for distance in ("5 m", "10 m"):
        x = sorted(x for x, _, words in found.labels if words == distance)
        assert len(x) == 2 and x[0] < 360 < x[1]


def test_the_section_tells_where_and_how_much(scored):
    html = html_of(sensor_details, scored)
    ET.fromstring(f"<div>{html}</div>")
    assert html.count("<svg") == 3  # a LiDAR with its key, and a camera
    for name, score in scored.after.per_sensor.items():
        assert f"<td>{percent(score.coverage, 1)}</td>" in html, name
    assert html.count("<table") == 2, "none from the rear axle"
