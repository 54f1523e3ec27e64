"""States of a scene's frames, and weathers: the panel, the study file and the engine agree."""

import json
import math

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.caches import result_staleness, vehicle_cache
from tests.addon import scenes
from tests.engine import shapes

OPEN_FRAME = 20


def box_object(name, low, high, origin=(0.0, 0.0, 0.0)):
    """Return an object of a box, whose origin is a hinge."""
    mesh = bpy.data.meshes.new(name)
    triangles = shapes.box(low, high) - origin
    mesh.from_pydata(
        triangles.reshape(-1, 3).tolist(),
        [],
        [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(len(triangles))],
    )
    obj = bpy.data.objects.new(name, mesh)
    obj.location = origin
    return obj


@pytest.fixture
def car(scene):
    """Return a scene with a car whose door turns by an action, with a LiDAR on it and one above."""
    collection = bpy.data.collections.new("Car")
    scene.collection.children.link(collection)
    body = box_object("body", (-2.0, -0.9, 0.3), (2.0, 0.88, 1.5))
    door = box_object("door", (-0.2, 0.88, 0.35), (0.8, 0.92, 1.3), (0.8, 0.9, 0.6))
    collection.objects.link(body)
    collection.objects.link(door)
    scene.perception_entropy.vehicle = collection
    for frame, angle in ((1, 0.0), (OPEN_FRAME, math.radians(-66.0))):
        door.rotation_euler.z = angle
        door.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_set(1)
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(0.0, 0.0, 1.7))
    mirror = scenes.add_sensor("mirror", "Velodyne VLP-16 Puck", location=(0.6, 0.97, 1.1))
    bpy.context.view_layer.update()
    mirror.parent = door
    mirror.matrix_parent_inverse = door.matrix_world.inverted()
    bpy.context.view_layer.update()
    return scene


def add_open_state(scene):
    scene.frame_set(OPEN_FRAME)
    assert bpy.ops.pe.add_row(rows="states") == {"FINISHED"}
    scene.perception_entropy.states[-1].name = "door open"
    scene.frame_set(1)


def test_a_frame_is_a_state_and_its_motions_are_those_of_the_hinge(car):
    bpy.ops.pe.add_row(rows="states")
    add_open_state(car)
    drawn, opened = car.perception_entropy.states
    assert (drawn.name, drawn.frame, json.loads(drawn.table)) == ("As Drawn", 1, {"frame": 1})
    assert opened.frame == OPEN_FRAME
    move = json.loads(opened.table)["move"]
    assert [m["parts"] for m in move] == [["door"]] and move[0]["sensors"] == ["mirror"]
    assert move[0]["rotation"] == pytest.approx([0.0, 0.0, -66.0], abs=2e-4)
    car.frame_set(OPEN_FRAME)
    bpy.context.view_layer.update()
    shown = bpy.data.objects["mirror"].matrix_world.translation
    study = document.study_as_drawn(car)
    pose = study.conditions.one("door open").rig(study.rig, study.vehicle)["mirror"].pose
    assert pose.position == pytest.approx(tuple(shown), abs=5e-5)
    assert car.frame_current == OPEN_FRAME  # reading shows the frame again that was shown


def test_a_shown_state_moves_nothing_that_stands_on_the_ground(car):
    """Zones, blind ground and scenarios are placed round the vehicle as drawn, at any frame."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    drawn = vehicle_cache.shared.read(car, depsgraph).vehicle
    add_open_state(car)
    car.frame_set(OPEN_FRAME)
    bpy.context.view_layer.update()
    shown = vehicle_cache.shared.read(car, bpy.context.evaluated_depsgraph_get()).vehicle
    assert shown.bounds[1][1] > drawn.bounds[1][1] + 0.5  # the door is open
    assert np.abs(shown.as_drawn.triangles - drawn.triangles).max() < 1e-4
    car.frame_set(1)
    assert (
        vehicle_cache.shared.read(car, bpy.context.evaluated_depsgraph_get()).vehicle.drawn is None
    )


def idle():
    bpy.context.view_layer.update()
    result_staleness.update_result()
    result_staleness.update_variants()


def scored_with_a_state(scene):
    """A scored scene with a variant and a state; what is stored of it."""
    settings = scene.perception_entropy
    settings.score_samples = 4096
    add_open_state(scene)
    assert bpy.ops.pe.score() == {"FINISHED"}
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    idle()
    return settings


def marks(settings):
    return settings.result_stale, settings.variants[0].stale, settings.variant_changed


def test_showing_another_state_makes_no_score_stale_and_a_change_there_does(car):
    settings = scored_with_a_state(car)
    for frame in (1, OPEN_FRAME, 1, OPEN_FRAME):
        car.frame_set(frame)
        idle()
        assert marks(settings) == (False, False, False), frame
    bpy.data.objects["roof"].location.z += 0.1
    idle()
    assert settings.result_stale and settings.variant_changed
    idle()
    assert settings.result_stale
    bpy.data.objects["roof"].location.z -= 0.1
    idle()
    car.frame_set(1)
    idle()
    assert marks(settings) == (False, False, False)
    car.frame_set(OPEN_FRAME)
    idle()
    settings.states[0].weight = 0.5
    idle()
    assert settings.result_stale
    car.frame_set(1)
    idle()
    assert settings.result_stale


def test_a_search_places_sensors_as_drawn_in_whatever_state_is_shown(car):
    settings = scored_with_a_state(car)
    mirror = bpy.data.objects["mirror"]
    mirror.perception_entropy.free = (False, False, True, False, False, False)
    bpy.data.objects["roof"].perception_entropy.free = (False,) * 6
    car.frame_set(OPEN_FRAME)
    settings.candidates = 4
    settings.samples = 2048
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    idle()
    assert car.frame_current == OPEN_FRAME and not settings.result_stale
    car.frame_set(1)
    idle()
    assert not settings.result_stale
    assert mirror.matrix_world.translation[:2] == pytest.approx((0.6, 0.97), abs=1e-4)
