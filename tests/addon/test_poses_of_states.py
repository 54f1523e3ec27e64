"""Radars, weather and states in Blender: the panel, headless Blender and `pe` have the same bits.

States come from an armature's pose, a driver, and an action's frames, and are undone.
"""

import json
import math

import bpy
import pytest

from blender_addon import document
from tests.addon import scenes
from tests.addon.command_line import pe_here, run_here
from tests.addon.test_conditions import OPEN_FRAME, add_open_state, car
from tests.addon.test_radar import ARS

__all__ = ["car"]
ANGLE = math.radians(-66.0)
"""A door with its hinge ahead opens outwards, on the left, clockwise from above."""


@pytest.fixture
def parked(car):
    """The car with its door, a LiDAR above and one on the door, and a radar at the rear corner."""
    radar = scenes.add_sensor("rear corner", ARS, location=(-1.0, 0.95, 0.85))
    radar.rotation_euler.z = math.radians(165.0)
    wing = scenes.add_sensor("rear wing", "Camera 60 deg", location=(1.2, 0.97, 0.9))
    wing.rotation_euler.z = math.radians(170.0)
    car.perception_entropy.score_samples = 4096
    bpy.context.view_layer.update()
    return car


def by_armature(scene, door):
    """Pose the door by a bone at its hinge: parent it, and key the bone's pose."""
    door.animation_data_clear()
    door.rotation_euler.z = 0.0
    data = bpy.data.armatures.new("rig")
    armature = bpy.data.objects.new("rig", data)
    scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("hinge")
    bone.head = (0.8, 0.9, 0.6)
    bone.tail = (0.8, 0.9, 1.6)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    before = door.matrix_world.copy()
    door.parent = armature
    door.parent_type = "BONE"
    door.parent_bone = "hinge"
    bpy.context.view_layer.update()
    door.matrix_world = before
    pose = armature.pose.bones["hinge"]
    pose.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (OPEN_FRAME, ANGLE)):
        pose.rotation_euler.y = angle  # a bone points along its y
        pose.keyframe_insert("rotation_euler", frame=frame)


def by_driver(scene, door):
    """Turn the door by a driver on the frame."""
    door.animation_data_clear()
    curve = door.driver_add("rotation_euler", 2)
    curve.driver.type = "SCRIPTED"
    curve.driver.expression = f"{ANGLE} * (frame >= {OPEN_FRAME})"


def by_action(scene, door):
    """The fixture's: keys of the door's own rotation."""


@pytest.mark.parametrize("pose", [by_armature, by_driver, by_action])
def test_a_state_is_read_from_however_the_designer_poses(parked, pose):
    door = bpy.data.objects["door"]
    pose(parked, door)
    parked.frame_set(1)
    bpy.context.view_layer.update()
    add_open_state(parked)
    (state,) = document.conditions_of(parked.perception_entropy).states
    (motion,) = state.motions
    assert motion.parts == ("door",) and motion.sensors == ("mirror",)
    turned = [math.degrees(angle) for angle in motion.rotation]
    assert turned == pytest.approx([0.0, 0.0, -66.0], abs=2e-3)
    study = scenes.study()
    moved = study.conditions.one("door open").vehicle(study.vehicle)
    outwards = moved.bounds[1][1]
    assert outwards > 1.7
    parked.frame_set(OPEN_FRAME)
    bpy.context.view_layer.update()
    corners = [door.matrix_world @ vertex.co for vertex in door.data.vertices]
    assert max(c.y for c in corners) == pytest.approx(outwards, abs=1e-3)


def told(scene):
    """The lines of the panel below the lists of conditions."""
    return list(scene.perception_entropy.result.conditions)


def test_panel_headless_and_pe_agree_to_the_bit(parked, tmp_path):
    bpy.ops.pe.add_row(rows="states")
    add_open_state(parked)
    bpy.ops.pe.add_row(rows="weathers", kind="CLEAR")
    bpy.ops.pe.add_row(rows="weathers", kind="RAIN")
    parked.perception_entropy.weathers[1].weight = 0.1
    parked.frame_set(OPEN_FRAME)  # what is shown does not matter: all score the vehicle as drawn
    assert bpy.ops.pe.score() == {"FINISHED"}
    panel = json.loads(parked.perception_entropy.result_json)["conditions"]
    wing = "in state 'door open', 'door' covers"
    assert any(line.startswith(f"rear wing: {wing}") for line in told(parked)), told(parked)
    assert [r["state"] for r in panel["rows"]] == 2 * ["As Drawn"] + 2 * ["door open"]
    assert panel["rows"][1]["weight"] == 0.1
    assert len({row["entropy"] for row in panel["rows"]}) == 4
    assert bpy.ops.pe.export_file(filepath=str(tmp_path / "study.toml")) == {"FINISHED"}
    blend = tmp_path / "parked.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    headless = run_here(blend, ["score", "--json"])
    alone = pe_here(["score", tmp_path / "study.toml", "--json"])
    assert headless.returncode == alone.returncode == 0, headless.stderr + alone.stderr
    assert json.loads(headless.stdout)["conditions"] == panel
    assert json.loads(alone.stdout)["conditions"] == panel
