"""Placing by pointing, as scripts do it: where a sensor stands, and how it is turned."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Vector

from blender_addon.engine import pe
from blender_addon.operators import placement, surface_pose
from blender_addon.processes import engine_calls
from blender_addon.sensor_kinds import mount_for
from pe_core.scoring import paired_error
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
    start = Vector((x, y, 9.0))
    down = Vector((0.0, 0.0, -1.0))
    return surface_pose.spot_on_ray(scene, depsgraph, parts, start, direction=down)


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
    alone = evaluator.score(pe.Rig([study.rig["roof"]]))
    after = evaluator.score(study.rig)
    error = paired_error(alone.scatter, after.scatter, ("rig", "", "entropy"))
    gain = engine_calls.gain(1, study, "front", study.rig["front"].pose)
    assert gain == (alone.entropy, after.entropy, after.coverage, error)
    assert gain.after < gain.before and f"({after.entropy - alone.entropy:+.3f})" in str(gain)


def test_the_magnet_holds_the_centre_line_and_quarter_turns(bare):
    """Near the middle of the front a camera looks ahead and stands on y = 0; else by its place."""
    depsgraph = scenes.depsgraph()
    spot = spot_below(bare, 1.9, 0.04)
    mount = mount_for(pe.catalog.load("Camera 60 deg"))
    middle = surface_pose.vehicle_center(bare.perception_entropy.vehicle)
    parts = surface_pose.parts_of(bare.perception_entropy.vehicle, depsgraph)
    near = surface_pose.spot_beside(bare, depsgraph, parts, spot, wanted={1: 0.0})
    assert tuple(near.point) == pytest.approx((1.9, 0.0, spot.point.z), abs=1e-5)
    beyond = surface_pose.spot_beside(bare, depsgraph, parts, spot, wanted={0: 30.0})
    assert beyond.point.x == 30.0, "no body there"
    for x, y, magnet, yaw in ((1.9, 0.3, True, 0), (1.9, 0.3, False, 9), (1.0, 0.8, True, 39)):
        at = surface_pose.SurfaceSpot(Vector((x, y, 0.5)), Vector((0.0, 0.0, 1.0)), "")
        stance = surface_pose.Stance(0.1, magnet=magnet)
        turned = stance.placed(at, mount, middle).to_euler().z
        assert math.degrees(turned) == pytest.approx(yaw, abs=1e-3)


def test_a_sensor_is_placed_on_both_sides_and_dragged_along_the_surface(bare):
    """The partner is linked and follows; a sensor that is moved keeps its model."""
    first = place("Camera 60 deg", location=(0.0, 0.9, 0.5), normal=(0.0, 1.0, 0.0), mirrored=True)
    other = bpy.data.objects[first.perception_entropy.mirror_of]
    assert other.location.y == pytest.approx(-first.location.y)
    near = spot_below(bare, 1.9, 0.04)
    stance = surface_pose.Stance(0.1, magnet=True)
    for moved in (None, first):  # the magnet needs a view, which is not here
        held = placement.HeldSensor(bpy.context, pe.catalog.load("Pandar64"), stance, moved)
        held.put(near)
        assert held.matrix.translation.y == pytest.approx(near.point.y, abs=1e-6)
    count = len(scenes.study().rig)
    again = place("Pandar64", sensor=first.name, location=(1.0, 0.9, 0.5), normal=(0.0, 1.0, 0.0))
    assert again == first and len(scenes.study().rig) == count == 2
    assert first.perception_entropy.model == "Camera 60 deg" and first.location.x == 1.0
