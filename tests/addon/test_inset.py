"""The selected sensor's picture in a corner of the view: whose, how large, and true to the lens."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_addon import bridge
from blender_addon.engine import catalog, pe
from blender_addon.operators import camera_pictures, camera_strip, inset, sensor_pictures
from tests.addon import scenes


@pytest.mark.parametrize("model", ["KITTI cam2", "Camera 120 deg"])
def test_points_fall_where_the_camera_has_them(car, model):
    """The pinhole of eq. 3: as the page's and the score's."""
    camera = catalog.load(model)
    clip = camera_pictures.projection(camera)
    for ahead, left, up in ((5.0, 0.0, 0.0), (5.0, 1.0, 0.4), (9.0, -2.0, -0.7)):
        seen = bridge.CAMERA_FROM_SENSOR.inverted() @ Vector((ahead, left, up, 1.0))
        x, y, _, w = clip @ seen
        across, height = (x / w + 1.0) / 2.0 * camera.width, (1.0 - y / w) / 2.0 * camera.height
        assert across == pytest.approx(camera.width / 2 - camera.focal_px * left / ahead, abs=0.02)
        assert height == pytest.approx(camera.height / 2 - camera.focal_px * up / ahead, abs=0.02)


@pytest.mark.parametrize("region", [(1600, 900), (300, 900), (1600, 200), (10, 10)])
@pytest.mark.parametrize("picture", [(1920, 1080), (640, 480), (1080, 120)])
@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_a_picture_keeps_its_proportions_and_leaves_the_view_room(region, picture, scale):
    width, height = sensor_pictures.size_of(region, picture, scale)
    assert (
        width <= max(sensor_pictures.WIDTH_SHARE * region[0], 2)
        and width <= sensor_pictures.MAX_WIDTH_PX * scale
    )
    assert height <= max(sensor_pictures.MAX_HEIGHT_SHARE * region[1], 2)
    assert height == pytest.approx(width * picture[1] / picture[0], abs=2)


@pytest.mark.parametrize("width", [1200.0, 300.0])
def test_the_strip_has_all_cameras_beside_each_other(width):
    pictures = [(1920, 1080), (640, 480), (1280, 320)]
    sizes = camera_strip.strip_sizes(width, pictures, 1.0)
    assert sum(size.width for size in sizes) + 2 * camera_strip.GAP_PX <= width
    assert len({size.height for size in sizes}) == 1 and sizes[0].height <= camera_strip.STRIP_PX
    for (across, up), size in zip(pictures, sizes, strict=True):
        assert size.width == pytest.approx(size.height * across / up, abs=4)


def context(scene, obj, perspective="PERSP"):
    """Return what a 3D view is drawn in."""
    look = SimpleNamespace(view_perspective=perspective)
    space = SimpleNamespace(type="VIEW_3D", region_3d=look)
    return SimpleNamespace(scene=scene, active_object=obj, space_data=space, region_data=look)


def test_the_active_sensor_is_shown_where_it_is_wanted_and_as_it_stands(car):
    eye = scenes.add_sensor(
        "eye", model="KITTI cam2", location=(0.7, 0.1, 1.6), rotation_euler=(0.1, 0.2, 0.7)
    )
    assert inset.shown_sensor(context(car, eye)) is None, "nobody asked for it"
    car.perception_entropy.view.show_inset = True
    shown = inset.shown_sensor(context(car, eye))
    expected = bridge.sensor_from_object(eye, scenes.depsgraph())
    assert (shown.name, shown.model) == (expected.name, expected.model)
    assert np.allclose(shown.pose.position, expected.pose.position, atol=1e-5)
    assert isinstance(inset.shown_sensor(context(car, car.objects["roof"])).model, pe.Lidar)
    assert inset.shown_sensor(context(car, car.objects["body"])) is None
    assert inset.shown_sensor(context(car, None)) is None
    assert inset.shown_sensor(context(car, eye, "CAMERA")) is None, "the view shows it already"


def test_a_lidar_s_ranges_are_asked_for_beside_the_window(car, monkeypatch):
    car.perception_entropy.view.show_inset = True
    bpy.context.view_layer.objects.active = car.objects["roof"]
    monkeypatch.setattr(inset, "_ranges", None)
    inset.request_ranges()
    whose, image = inset._ranges
    assert whose == ("roof", "Velodyne VLP-16 Puck")
    assert (image.width, image.height) == (round(359.8 * 3), 30 * 3)
