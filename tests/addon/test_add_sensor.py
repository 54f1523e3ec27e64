"""Adding sensors: where they are put, and what they carry."""

import bpy
import numpy as np
import pytest

from blender_addon import sensor_kinds
from blender_addon.engine import catalog
from tests.addon import scenes


def test_lidar_goes_above_the_middle_of_the_roof(scene):
    scenes.add_car(scene)
    bpy.ops.pe.add_sensor(model="Pandar64")
    sensor = bpy.context.object
    assert [round(v, 6) for v in sensor.location] == [-0.3, 0.0, 1.65]
    assert sensor.perception_entropy.is_sensor
    assert sensor.perception_entropy.model == "Pandar64"
    assert tuple(sensor.perception_entropy.free) == (True, True, True, False, True, False)
    assert sensor.select_get() and sensor.users_collection[0].name == "Sensors"


def test_camera_goes_to_the_front_of_the_roof(scene):
    scenes.add_car(scene)
    bpy.ops.pe.add_sensor(model="Camera 60 deg")
    assert [round(v, 6) for v in bpy.context.object.location] == [0.65, 0.0, 1.55]


def test_cursor_is_taken_when_it_was_moved(scene):
    scenes.add_car(scene)
    scene.cursor.location = (1.0, 2.0, 3.0)
    bpy.ops.pe.add_sensor()
    assert tuple(bpy.context.object.location) == (1.0, 2.0, 3.0)


def test_only_collection_with_meshes_becomes_the_vehicle(scene):
    scenes.add_car(scene)
    scene.perception_entropy.vehicle = None
    bpy.ops.pe.add_sensor()
    assert scene.perception_entropy.vehicle.name == "Car"


def test_every_model_can_be_added(scene):
    for name in catalog.names():
        assert bpy.ops.pe.add_sensor(model=name) == {"FINISHED"}
    assert len(bpy.data.collections["Sensors"].objects) == len(catalog.names())


def collections_of(obj):
    """Names of the collections that an object is in."""
    return [each.name for each in obj.users_collection]


def test_linked_once_so_that_excluding_the_collection_hides_it(scene):
    for _ in range(2):  # the first one makes the collection
        bpy.ops.pe.add_sensor()
        assert collections_of(bpy.context.object) == ["Sensors"]
    bpy.context.view_layer.layer_collection.children["Sensors"].exclude = True
    assert not any(obj.visible_get() for obj in scene.objects)


def test_excluded_collection_of_sensors(scene):
    bpy.ops.pe.add_sensor()
    bpy.context.view_layer.layer_collection.children["Sensors"].exclude = True
    bpy.ops.pe.add_sensor()
    assert bpy.context.object.visible_get()
    assert collections_of(bpy.context.object) == [scene.collection.name]


@pytest.mark.parametrize("model", ["Pandar64", "Camera 60 deg"])
@pytest.mark.parametrize("vehicle", ["sedan", "bus"])
def test_stands_on_the_roof_of_the_example_vehicles(addon, vehicle, model):
    """Clear of the body by its stand-off: neither in the surface nor in the air before it."""
    body = scenes.shipped_study(vehicle).vehicle
    bpy.ops.pe.add_sensor(model=model)
    place = bpy.context.object.location
    mount = sensor_kinds.mount_of(catalog.load(model).kind)
    below = body.first_hit(place, [(0.0, 0.0, -1.0)]).distance[0]
    assert below == pytest.approx(mount.stand_off_m, abs=0.006)  # rounded to a centimetre
    assert not np.isfinite(body.first_hit(place, [(1.0, 0.0, 0.0)]).distance).any()
