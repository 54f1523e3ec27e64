"""Pictures over the view: how large, and true to the lens."""

import pytest
from mathutils import Vector

from blender_addon import document
from blender_addon.engine import catalog
from blender_addon.operators import camera_pictures, camera_strip, sensor_pictures


@pytest.mark.parametrize("model", ["KITTI cam2", "Camera 120 deg"])
def test_points_fall_where_the_camera_has_them(car, model):
    """The pinhole of eq. 3: as the page's and the score's."""
    camera = catalog.load(model)
    clip = camera_pictures.projection(camera)
    for ahead, left, up in ((5.0, 0.0, 0.0), (5.0, 1.0, 0.4), (9.0, -2.0, -0.7)):
        seen = document.CAMERA_FROM_SENSOR.inverted() @ Vector((ahead, left, up, 1.0))
        x, y, _, w = clip @ seen
        across = (x / w + 1.0) / 2.0 * camera.width
        height = (1.0 - y / w) / 2.0 * camera.height
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


@pytest.mark.parametrize("highest", [camera_strip.STRIP_PX, 40.0])
@pytest.mark.parametrize("width", [1200.0, 300.0])
def test_the_strip_has_all_cameras_beside_each_other(width, highest):
    pictures = [(1920, 1080), (640, 480), (1280, 320)]
    sizes = camera_strip.strip_sizes(width, highest, pictures, 1.0)
    assert sum(size.width for size in sizes) + 2 * camera_strip.GAP_PX <= width
    assert len({size.height for size in sizes}) == 1 and sizes[0].height <= highest
    for (across, up), size in zip(pictures, sizes, strict=True):
        assert size.width == pytest.approx(size.height * across / up, abs=4)
