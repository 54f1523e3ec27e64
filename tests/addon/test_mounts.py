"""Mounts in Blender: painted areas, slots, ties, locks, bounds, constraints."""

import bpy
import numpy as np
import pytest

import pe_core as pe
from blender_addon import document
from tests.addon import scenes

CAN = "Velodyne VLP-16 Puck"
BASE_M = 0.04
"""Of the base plate."""
TOP_M = 1.5
"""Of the car's cabin."""


@pytest.fixture(autouse=True)
def few_voxels(car):
    """Score and search on few voxels."""
    settings = car.perception_entropy
    settings.score_samples = 1024
    settings.search_samples = 1024
    settings.candidates = 1
    settings.method = "random"


@pytest.fixture
def roof(car):
    """Return the scene with the cabin's top painted, and a can on it."""
    scenes.paint(bpy.data.objects["cabin"], "roof", lambda co: 1.0 if co.z > 0 else 0.0)
    scenes.add_mount(car, "roof area", faces="GROUP", group="roof", standoff=BASE_M)
    sensor = bpy.data.objects["roof"]
    sensor.perception_entropy.model = CAN
    put(sensor, "roof area")
    return car


def put(sensor, mount):
    assert bpy.ops.pe.mount_sensor(name=sensor.name, mount=mount) == {"FINISHED"}
    bpy.context.view_layer.update()


def faces(name="roof area"):
    return scenes.study().search.mounting.mounts[name].area.triangles


def among(triangles, vehicle):
    """Whether all are triangles of the vehicle, to the bit."""
    known = {each.tobytes() for each in vehicle.triangles}
    return all(each.tobytes() in known for each in np.ascontiguousarray(triangles))


def place_of(name):
    return document.pose_of(bpy.data.objects[name], scenes.depsgraph()).position


def test_painted_faces_are_those_whose_corners_all_weigh_more_than_a_half(roof):
    assert np.all(np.abs(faces()[:, :, 2] - TOP_M) < 1e-6) and len(faces()) == 2
    assert among(faces(), scenes.study().vehicle)
    cabin = bpy.data.objects["cabin"]
    scenes.paint(cabin, "roof", lambda co: 0.5 if co.x > 0 and co.z > 0 else float(co.z > 0))
    bpy.context.view_layer.update()
    with pytest.raises(pe.InputError, match=r"mount 'roof area': vertex group 'roof': expected .*"):
        scenes.study()


def test_painted_faces_come_with_modifiers_and_instances_and_places(roof):
    cabin = bpy.data.objects["cabin"]
    cabin.modifiers.new("finer", "SUBSURF").levels = 2
    cabin.modifiers["finer"].subdivision_type = "SIMPLE"
    cabin.rotation_euler = (0.0, 0.1, 0.0)
    bpy.context.view_layer.update()
    area = document.mount_of_row(
        roof, scenes.depsgraph(), roof.perception_entropy.mounts["roof area"]
    ).area
    assert len(area.triangles) == 2 * (16 + 4 * 4)  # the top, and the sides' upper quarters
    vehicle = scenes.vehicle(roof.perception_entropy.vehicle)
    assert among(area.triangles, vehicle)


def test_slots_are_the_empties_of_a_collection(car):
    rack = scenes.add_collection(car.collection, "Rack")
    for name, x in (("front", 0.2), ("rear", -0.9)):
        slot = bpy.data.objects.new(name, None)
        slot.location = (x, 0.0, 1.9)
        rack.objects.link(slot)
    scenes.add_mount(car, "rack", kind="SLOTS", slots=rack)
    bpy.context.view_layer.update()
    put(bpy.data.objects["roof"], "rack")
    assert place_of("roof") == (-0.9, 0.0, 1.9)
    mount = scenes.study().search.mounting.mounts["rack"]
    assert [slot.name for slot in mount.slots] == ["front", "rear"]
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    assert place_of("roof") in ((-0.9, 0.0, 1.9), (0.2, 0.0, 1.9))


def test_sensors_on_a_rack_move_as_one(car):
    for name, y in (("left", 0.4), ("eye", 0.5)):
        obj = scenes.add_sensor(name, CAN, location=(0.0, y, 2.2))
        obj.perception_entropy.rack = "arm"
    assert scenes.study().search.mounting.groups == (("eye", "left"),)
    before = np.subtract(place_of("left"), place_of("eye"))
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    assert np.subtract(place_of("left"), place_of("eye")) == pytest.approx(before, abs=2e-5)


def test_a_mount_is_added_of_what_is_selected_or_painted(car):
    cabin = bpy.data.objects["cabin"]
    bpy.ops.object.select_all(action="DESELECT")
    cabin.select_set(True)
    bpy.context.view_layer.objects.active = cabin
    assert bpy.ops.pe.add_row(rows="mounts") == {"FINISHED"}
    row = car.perception_entropy.mounts[0]
    assert row.name == "cabin" and [each.part for each in row.parts] == [cabin]
    cabin.vertex_groups.new(name="painted")
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    assert bpy.ops.pe.add_row(rows="mounts") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    row = car.perception_entropy.mounts[1]
    assert (row.name, row.faces, row.group) == ("painted", "GROUP", "painted")
