"""Placing by pointing, as scripts do it: where a sensor stands, and how it is turned."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_addon import engine_calls
from blender_addon.engine import pe
from blender_addon.operators import surface_pose
from tests.addon import scenes


@pytest.fixture
def bare(scene):
    """Return a scene with a car and no sensors."""
    scenes.add_car(scene)
    bpy.context.view_layer.update()
    return scene


def place(model, **chosen):
    """Return the sensor that was placed."""
    assert bpy.ops.pe.place_sensor(model=model, **chosen) == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.object


def axes(obj):
    """Return where a sensor looks, and its up, each (3,)."""
    turned = np.array(obj.matrix_world)[:3, :3]
    return turned[:, 0], turned[:, 2]


def test_a_lidar_stands_upright_and_looks_ahead_wherever_it_is(bare):
    sensor = place("Pandar64", location=(0.0, 0.9, 0.5), normal=(0.0, 1.0, 0.0))
    assert tuple(sensor.location) == pytest.approx((0.0, 1.05, 0.5), abs=1e-6)
    ahead, up = axes(sensor)
    assert ahead == pytest.approx([1, 0, 0], abs=1e-6) and up == pytest.approx([0, 0, 1], abs=1e-6)


@pytest.mark.parametrize(
    ("place_xy", "yaw"),
    [((2.0, 0.0), 0), ((-2.0, 0.0), 180), ((0.0, 0.9), 90), ((-2.0, -2.0), -135)],
)
def test_an_upright_camera_looks_away_from_the_middle_of_the_vehicle(bare, place_xy, yaw):
    ahead, up = axes(place("Camera 60 deg", location=(*place_xy, 0.5), normal=(0.0, 0.0, 1.0)))
    expected = [math.cos(math.radians(yaw)), math.sin(math.radians(yaw)), 0.0]
    assert ahead == pytest.approx(expected, abs=1e-6) and up == pytest.approx([0, 0, 1], abs=1e-6)


def spot_below(scene, x, y):
    """Where a ray from high above meets the vehicle."""
    depsgraph = scenes.depsgraph()
    parts = surface_pose.parts_of(scene.perception_entropy.vehicle, depsgraph)
    start, down = Vector((x, y, 9.0)), Vector((0.0, 0.0, -1.0))
    return surface_pose.spot_on_ray(scene, depsgraph, parts, start, down)


def test_the_mouse_finds_the_vehicle_through_all_else(bare):
    """A tree above the car and the ground below it are no places for a sensor."""
    scenes.add_box(bare.collection, "tree", (1.0, 1.0, 1.0), location=(0.0, 0.0, 5.0))
    scenes.add_box(bare.collection, "ground", (50.0, 50.0, 0.1), location=(0.0, 0.0, -0.1))
    spot = spot_below(bare, -0.3, 0.0)
    assert (spot.part, round(spot.point.z, 5)) == ("cabin", 1.5)
    assert tuple(spot.normal) == pytest.approx((0.0, 0.0, 1.0))
    assert spot_below(bare, 10.0, 0.0) is None


def test_its_preview_is_the_score_with_it_beside_that_without(bare):
    scenes.add_sensor("roof", location=(-0.43, 0.0, 1.8))
    scenes.add_sensor("front", model="Camera 60 deg", location=(0.65, 0.0, 1.55))
    study = scenes.study()
    evaluator = study.evaluator(samples=engine_calls.HELD_SAMPLES)
    before = evaluator.entropy(pe.Rig([study.rig["roof"]]))
    after = evaluator.score(study.rig)
    gain = engine_calls.gain(1, study, "front", study.rig["front"].pose)
    assert gain == (before, after.entropy, after.coverage)
    assert gain.after < gain.before and f"({after.entropy - before:+.3f})" in str(gain)
