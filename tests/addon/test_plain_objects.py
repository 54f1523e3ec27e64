"""Blender's own cameras and empties become sensors, and sensors cameras and empties."""

import math

import bpy
import numpy as np
import pytest

from blender_addon import bridge
from blender_addon.engine import catalog, exchange, pe
from tests.addon import scenes
from tests.addon.command_line import run_here

QUARTER = math.pi / 2.0


def add_camera(name, **figures):
    """A camera at (1, 2, 3) that looks along x, y to its left: a film of 36 mm, 50 mm away."""
    data = bpy.data.cameras.new(name)
    for key, value in figures.items():
        setattr(data, key, value)
    obj = bpy.data.objects.new(name, data)
    obj.location, obj.rotation_euler = (1.0, 2.0, 3.0), (QUARTER, 0.0, -QUARTER)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


def picture(scene, width, height, aspect=(1.0, 1.0)):
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.pixel_aspect_x, render.pixel_aspect_y = aspect


def the_sensor(scene):
    (found,), lines = bridge.sensors_of_objects(scene, scene.objects, {}, "Pandar64")
    return found, lines


def test_a_camera_s_place_and_lens_by_hand(scene):
    """50 mm before 36 mm over 1000 px: fx = 1000 * 50 / 36; a shift is of the film's width."""
    picture(scene, 1000, 500)
    add_camera("cam", lens=50.0, shift_x=0.1, shift_y=-0.05)
    found, lines = the_sensor(scene)
    assert found.name == "cam" and lines == []
    assert found.pose.position == (1.0, 2.0, 3.0)
    assert found.pose.rotation_deg == pytest.approx((0, 0, 0), abs=1e-4)
    lens = found.model.projection
    focal = 1000.0 * 50.0 / 36.0
    assert (lens.fx, lens.fy) == pytest.approx((focal, focal), abs=1e-3)
    assert (lens.cx, lens.cy) == pytest.approx((400.0, 200.0), abs=1e-3)
    assert (found.model.width, found.model.height) == (1000, 500)
    assert (found.model.min_range, found.model.max_range) == (0.0, math.inf)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.12, -0.07)])
@pytest.mark.parametrize(
    ("fit", "size", "aspect"),
    [
        ("AUTO", (500, 1000), (1, 1)),
        ("AUTO", (1000, 700), (1, 2)),
        ("VERTICAL", (900, 700), (2, 1)),
    ],
)
def test_pixels_are_where_blender_has_them(scene, fit, size, aspect, shift):
    """Blender's own projection of points before the camera, from 0 to 1 and from below."""
    from bpy_extras.object_utils import world_to_camera_view

    picture(scene, *size, aspect)
    cam = add_camera("cam", lens=30.0, sensor_fit=fit, shift_x=shift[0], shift_y=shift[1])
    model = the_sensor(scene)[0].model
    for depth, left, up in ((5.0, 0.7, 0.4), (5.0, -0.9, -0.3), (5.0, 0.0, 0.0)):
        theirs = world_to_camera_view(scene, cam, cam.location + _vector((depth, left, up)))
        x, y = model.projection.project(*(np.array([v]) for v in (depth, left, up)))
        assert x[0] / model.width == pytest.approx(theirs.x, abs=1e-5)
        assert 1.0 - y[0] / model.height == pytest.approx(theirs.y, abs=1e-5)


def _vector(values):
    from mathutils import Vector

    return Vector(values)


def test_clipping_is_range_and_other_lenses_are_refused(scene):
    cam = add_camera("cam", clip_start=0.5, clip_end=60.0)
    model = the_sensor(scene)[0].model
    assert (model.min_range, model.max_range) == (0.5, 60.0)
    cam.data.type = "ORTHO"
    with pytest.raises(pe.InputError, match="camera 'cam': expected a perspective lens, found"):
        the_sensor(scene)


@pytest.fixture
def rigged(car):
    place = {"location": (1.5, 0.1, 1.3), "rotation_euler": (0.05, 0.1, 0.2)}
    scenes.add_sensor("eye", "PandaSet wide", **place)
    scenes.add_sensor("plain", "KITTI cam2", location=(1.0, 0.0, 1.4))
    return car


def test_sensors_go_out_as_objects_and_come_back(rigged):
    before = {s.name: s for s in scenes.study().rig}
    assert bpy.ops.pe.sensors_to_objects() == {"FINISHED"}
    made = bpy.data.collections["Rig"].objects
    assert sorted(obj.type for obj in made) == ["CAMERA", "CAMERA", "EMPTY"]
    assert bpy.ops.pe.sensors_from_objects() == {"FINISHED"}
    settings, after = rigged.perception_entropy, {s.name: s for s in scenes.study().rig}
    assert [row.name for row in settings.variants] == ["Unsaved", "From Objects"]
    assert after.keys() == before.keys()
    for name, theirs in after.items():
        assert theirs.model is before[name].model, "its lens is the model's: so is the sensor"
        assert theirs.pose.position == pytest.approx(before[name].pose.position, abs=1e-6)
        turned = theirs.pose.ground_from_sensor - before[name].pose.ground_from_sensor
        assert np.abs(turned).max() < 1e-6


def test_a_camera_that_was_changed_is_its_own_model(rigged):
    bpy.ops.pe.sensors_to_objects()
    camera = next(o for o in bpy.data.collections["Rig"].objects if o["sensor"] == "plain")
    camera.data.lens *= 2.0
    bpy.ops.pe.sensors_from_objects()
    own = scenes.study().rig["plain"].model
    known = catalog.load("KITTI cam2")
    assert own.projection.fx == pytest.approx(2.0 * known.projection.fx, rel=1e-6)
    assert [row.name for row in rigged.perception_entropy.own_sensors] == ["plain"]


def test_only_what_is_selected_and_an_empty_without_a_model(car):
    for name in ("left", "right"):
        empty = bpy.data.objects.new(name, None)
        car.collection.objects.link(empty)
        empty.location = (0.0, 1.0 if name == "left" else -1.0, 2.0)
    bpy.context.view_layer.update()
    for obj in car.objects:
        obj.select_set(obj.name == "left")
    assert bpy.ops.pe.sensors_from_objects(selected=True, model="HDL-64E") == {"FINISHED"}
    (left,) = scenes.study().rig
    assert (left.name, left.model.name) == ("left.001", "HDL-64E"), "the empty keeps its name"
    assert "no model on the empty; HDL-64E stands in" in bridge.active_variant(car).note


def test_nothing_to_make_sensors_of_changes_nothing(car):
    with pytest.raises(RuntimeError, match="objects: expected cameras or empties, found none"):
        bpy.ops.pe.sensors_from_objects()
    assert not car.perception_entropy.variants


def test_models_that_a_file_does_not_tell_are_chosen(car, tmp_path):
    """What the dialog of an import sets: a row a sensor, and their models."""
    rig = scenes.study().rig
    path = tmp_path / "rig.launch.xml"
    exchange.export_rig(rig, "ros", path)
    assert exchange.import_rig(path).to_choose == ("roof",)
    rows = [{"name": "", "sensor": "roof", "kind": "lidar", "model": "HDL-64E"}]
    assert bpy.ops.pe.choose_models(filepath=str(path), rows=rows) == {"FINISHED"}
    assert scenes.study().rig["roof"].model.name == "HDL-64E"
    rows[0]["model"] = "No Such"
    with pytest.raises(RuntimeError, match="model: expected one of"):
        bpy.ops.pe.choose_models(filepath=str(path), rows=rows)


def test_the_command_takes_objects_in_and_puts_them_out(rigged, tmp_path, capsys):
    from blender_addon.commands import parser

    out = tmp_path / "objects.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "car.blend"))
    args = parser("pe").parse_args(["export", "--to", "blender", "-o", str(out)])
    assert args.function(args) == (f"wrote {out}", 0)
    assert "eye: Blender's camera has no distortion" in capsys.readouterr().err
    with pytest.raises(pe.InputError, match="an existing file"):
        args.function(args)
    answer = run_here(out, "import", "-o", tmp_path / "back.toml")
    assert answer.returncode == 0, answer.stderr
    back, before = pe.load_study(tmp_path / "back.toml"), scenes.study()
    assert {s.name for s in back.rig} == {s.name for s in before.rig}
    assert back.vehicle.triangles.tobytes() == before.vehicle.triangles.tobytes()
    lidar = "Velodyne VLP-16 Puck"
    assert [s.model.name for s in back.rig] == ["PandaSet wide", "KITTI cam2", lidar]
