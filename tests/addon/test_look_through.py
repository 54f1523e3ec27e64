"""Looking through a sensor: the right lens in the right place, and everything as before after."""

import bpy
import pytest
from mathutils import Vector

from blender_addon import document
from blender_addon.caches import consistency
from blender_addon.operators import look_through
from tests.addon import scenes


@pytest.fixture
def eye(car):
    """Return a camera on the car, turned and tilted."""
    return scenes.add_sensor(
        "eye", model="KITTI cam2", location=(0.7, 0.1, 1.6), rotation_euler=(0.1, 0.2, 0.7)
    )


def look(obj):
    assert bpy.ops.pe.look_through(name=obj.name) == {"FINISHED"}
    bpy.context.view_layer.update()
    return document.view_camera(obj)


def rendered_at(scene, point):
    """Where a point of the scene falls in the rendered picture [px], counted from its top left."""
    from bpy_extras.object_utils import world_to_camera_view

    across, up, _ = world_to_camera_view(scene, scene.camera, Vector(point))
    return across * scene.render.resolution_x, (1.0 - up) * scene.render.resolution_y


@pytest.mark.parametrize("model", ["KITTI cam2", "Camera 120 deg", "Argoverse 2 ring front centre"])
def test_blender_s_picture_is_the_sensor_s(car, eye, model):
    """Points fall on the pixels where the pinhole of eq. 3 has them."""
    eye.perception_entropy.model = model
    look(eye)
    sensor = document.sensor_from_object(eye, scenes.depsgraph())
    camera = sensor.model
    turned = sensor.pose.ground_from_sensor
    assert (car.render.resolution_x, car.render.resolution_y) == (camera.width, camera.height)
    for ahead, left, up in ((5.0, 0.0, 0.0), (5.0, 1.0, 0.4), (9.0, -2.0, -0.7)):
        point = turned @ [ahead, left, up] + sensor.pose.position
        u = camera.width / 2 - camera.focal_px * left / ahead
        v = camera.height / 2 - camera.focal_px * up / ahead
        assert rendered_at(car, point) == pytest.approx((u, v), abs=0.02)


def view_area():
    """Return a 3D view of Blender's own layout."""
    return next(area for area in bpy.data.screens["Layout"].areas if area.type == "VIEW_3D")


def seen_in(area):
    """Return all that says what a view shows, as plain numbers."""
    space = area.spaces.active
    look = area.spaces.active.region_3d
    return {
        "perspective": look.view_perspective,
        "along an axis": look.is_orthographic_side_view,
        "rotation": tuple(look.view_rotation),
        "location": tuple(look.view_location),
        "distance": look.view_distance,
        "zoom": (look.view_camera_zoom, *look.view_camera_offset),
        "lens": (space.lens, space.clip_start, space.clip_end),
        "lock": space.lock_camera,
        "own camera": (space.use_local_camera, space.camera and space.camera.name),
    }


def looking(area, obj):
    """Look through a sensor from a view; Blender then turns the view as the camera is."""
    with bpy.context.temp_override(area=area):
        bpy.ops.pe.look_through(name=obj.name)
    look = area.spaces.active.region_3d
    assert look.view_perspective == "CAMERA"
    look.view_rotation = bpy.context.scene.camera.matrix_world.to_quaternion()
    look.view_location = (9.0, 9.0, 9.0)
    look.view_distance = 3.0


def leave_by_operator(_scene, area):
    with bpy.context.temp_override(area=area):
        bpy.ops.pe.look_back()


def leave_by_undo(scene, _area):
    """As undo does it: the scene is as before, views are as they are."""
    document.look_back(scene)
    look_through.restore_lost()


def leave_by_losing_the_sensor(scene, _area):
    bpy.data.objects.remove(scene.camera.parent)
    consistency.repair_scenes()
    look_through.restore_lost()


WAYS_BACK = (leave_by_operator, leave_by_undo, leave_by_losing_the_sensor)


@pytest.mark.parametrize("leave", WAYS_BACK)
@pytest.mark.parametrize("orthographic", [False, True])
def test_the_view_is_what_it_was_whatever_way_back(car, eye, leave, orthographic):
    area = view_area()
    space = area.spaces.active
    look = area.spaces.active.region_3d
    own = bpy.data.objects.new("own", bpy.data.cameras.new("own"))
    car.collection.objects.link(own)
    turned = (0.5, 0.5, 0.5, 0.5) if orthographic else (0.8, 0.2, 0.4, 0.4)
    look.view_perspective = "ORTHO" if orthographic else "PERSP"
    look.view_rotation = turned
    look.view_location = (0.1, 0.2, 0.3)
    look.view_distance = 7.5
    look.is_orthographic_side_view = orthographic
    space.lens = 35.0
    space.clip_end = 321.0
    space.lock_camera = True
    space.use_local_camera = True
    space.camera = own
    for distance in (7.5, 9.0):  # what it was the first time is forgotten
        look.view_distance = distance
        before = seen_in(area)
        looking(area, eye)
        assert not space.lock_camera, "turning the view would turn the camera"
        other = scenes.add_sensor("other", model="Camera 60 deg", location=(0.0, 0.0, 1.6))
        looking(area, other)
        leave(car, area)
        after = seen_in(area)
        assert after.pop("rotation") == pytest.approx(before.pop("rotation"), abs=1e-6)
        assert after == before


def test_a_lidar_is_not_looked_through(car):
    assert bpy.ops.pe.look_through(name="roof") == {"CANCELLED"}
    assert document.view_camera(car.objects["roof"]) is None
