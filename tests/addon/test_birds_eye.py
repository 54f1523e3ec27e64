"""The bird's-eye view: its squares are the engine's, its pictures lie on the ground as it is."""

from dataclasses import replace

import numpy as np
import pytest
from mathutils import Vector

from blender_addon.engine import catalog, pe, sight
from blender_addon.operators import birds_eye
from blender_addon.overlay.birds_eye import FROM_ABOVE, BirdsEye, rectangles
from blender_addon.overlay.birds_eye import birds_eye as birds_eye_of
from blender_addon.overlay.layers import WHOLE_RIG
from tests.addon import scenes

PLATE = BirdsEye(x=(-12.0, 14.0), y=(-11.0, 9.0))
GROUND = ((2.0, 1.0), (13.5, -10.0), (-11.0, 8.5), (0.4, -0.3), (6.0, 6.0))


@pytest.fixture
def seen(car):
    """The car with a LiDAR on its roof and two fisheyes, and its bird's-eye view."""
    fisheye = "WoodScape surround view"
    scenes.add_sensor("ahead", fisheye, location=(2.1, 0.0, 0.7), rotation_euler=(0.0, 0.4, 0.0))
    scenes.add_sensor("left", fisheye, location=(0.5, 1.0, 1.0), rotation_euler=(0.0, 0.8, 1.57))
    car.perception_entropy.view.show_birds_eye = True
    car.perception_entropy.view.birds_eye_within = 6.0
    return car


def test_its_squares_and_its_blind_area_are_the_engine_s(seen):
    found = scenes.drawn(seen)["birds_eye"][WHOLE_RIG]
    study = scenes.study()
    look = sight.Sight(study.space, study.prior, study.vehicle)
    expected = look.surround_view(study.rig, 6.0)
    cameras = pe.Rig([each for each in study.rig if each.kind == "camera"])
    assert found.blind_m2 == look.blind(cameras, 0.0, 6.0).area > 0.0
    assert set(found.painted) == {"ahead", "left", FROM_ABOVE}
    filled = {name: expected.camera == number for number, name in enumerate(expected.cameras)}
    filled[FROM_ABOVE] = own = expected.camera == sight.VEHICLE
    for name, squares in filled.items():
        assert (found.painted[name] == rectangles(squares)).all()
    narrow = expected.blind & (expected.y < -3.0)  # no test body would fit in there
    filled = birds_eye_of(replace(expected, blind=expected.blind & ~narrow)).painted
    assert narrow.any() and (filled[FROM_ABOVE] == rectangles(own | narrow)).all()
    assert len(found.over.thin.points) and len(found.over.lines.points)
    seen.objects["ahead"].hide_set(True)
    assert set(scenes.drawn(seen)["birds_eye"][WHOLE_RIG].painted) == {"left", FROM_ABOVE}
    seen.objects["left"].hide_set(True)
    assert "birds_eye" not in scenes.drawn(seen), "a rig without cameras"


@pytest.mark.parametrize("model", ["KITTI cam2", "WoodScape surround view"])
def test_what_lies_on_a_place_of_the_plate_the_camera_has_in_the_pixel_of_that_place(car, model):
    """The ray through each place of the picture, by the lens: within a pixel of the ground's."""
    camera = catalog.load(model)
    pose = pe.Pose((1.9, 0.4, 0.9), (0.02, 0.5, 0.3))
    look = birds_eye.look_down(pose, PLATE)
    ground_from_clip = (look.projection @ look.camera_from_ground).inverted()
    compared = 0
    for x, y in GROUND:
        across = (PLATE.y[1] - y) / (PLATE.y[1] - PLATE.y[0])
        up = (x - PLATE.x[0]) / (PLATE.x[1] - PLATE.x[0])
        there = ground_from_clip @ Vector((2.0 * across - 1.0, 2.0 * up - 1.0, 0.5, 1.0))
        ray = np.array(there.to_3d() / there.w) - pose.position
        rays = [
            each / np.linalg.norm(each) @ pose.ground_from_sensor
            for each in (ray, np.array((x, y, 0.0)) - pose.position)
        ]
        if rays[1][0] > 0.2:  # ahead of the picture's plane
            np.testing.assert_allclose(*(camera.projection.project(*r) for r in rays), atol=0.5)
            compared += 1
    assert compared >= 3
