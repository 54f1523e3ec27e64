"""Adding sensors: where they are put, and what they carry."""

import bpy
import pytest

from blender_addon.engine import catalog
from tests.addon import scenes


def test_lidar_goes_above_the_middle_of_the_roof(scene):
    scenes.add_car(scene)
    bpy.ops.pe.add_sensor(model="Pandar64")
    sensor = bpy.context.object
    assert [round(v, 6) for v in sensor.location] == [-0.3, 0.0, 1.8]
    assert sensor.perception_entropy.is_sensor
    assert sensor.perception_entropy.model == "Pandar64"
    assert tuple(sensor.perception_entropy.free) == (True, True, True, False, True, False)
    assert sensor.select_get() and sensor.users_collection[0].name == "Sensors"


def test_camera_goes_to_the_front_of_the_roof(scene):
    scenes.add_car(scene)
    bpy.ops.pe.add_sensor(model="Camera 60 deg")
    assert [round(v, 6) for v in bpy.context.object.location] == [0.7, 0.0, 1.55]


def test_cursor_is_taken_when_it_was_moved(scene):
    scenes.add_car(scene)
    scene.cursor.location = (1.0, 2.0, 3.0)
    bpy.ops.pe.add_sensor()
    assert tuple(bpy.context.object.location) == (1.0, 2.0, 3.0)


def test_works_in_an_empty_scene(scene):
    assert bpy.ops.pe.add_sensor() == {"FINISHED"}
    assert bpy.context.object.location.z == pytest.approx(1.8)


def test_only_collection_with_meshes_becomes_the_vehicle(scene):
    scenes.add_car(scene)
    scene.perception_entropy.vehicle = None
    bpy.ops.pe.add_sensor()
    assert scene.perception_entropy.vehicle.name == "Car"


def test_of_two_collections_none_is_guessed(scene):
    scenes.add_car(scene)
    scenes.add_box(scenes.add_collection(scene.collection, "Trailer"), "box")
    scene.perception_entropy.vehicle = None
    bpy.ops.pe.add_sensor()
    assert scene.perception_entropy.vehicle is None


def test_every_model_can_be_added(scene):
    for name in catalog.names():
        assert bpy.ops.pe.add_sensor(model=name) == {"FINISHED"}
    assert len(bpy.data.collections["Sensors"].objects) == len(catalog.names())


def test_unknown_model_is_refused(scene):
    with pytest.raises(RuntimeError, match=r"expected a name such as .*Pandar64"):
        bpy.ops.pe.add_sensor(model="Pandar66")
    assert not scene.objects


def test_excluded_collection_of_sensors(scene):
    bpy.ops.pe.add_sensor()
    bpy.context.view_layer.layer_collection.children["Sensors"].exclude = True
    bpy.ops.pe.add_sensor()
    assert bpy.context.object.visible_get()


def test_undo_removes_it(scene):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.pe.add_sensor("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    assert not bpy.context.scene.objects
