"""What a sensor is, as fields and in one colour; focus and no-go areas where they are meant."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.caches import consistency
from blender_addon.engine import graphics
from tests.addon import scenes

TURNED = (0.3, -0.2, 1.0)


def pose(obj):
    bpy.context.view_layer.update()
    return document.pose_of(obj, scenes.depsgraph())


@pytest.mark.parametrize("parented", [False, True])
def test_the_fields_are_the_transform_of_the_object(car, parented):
    roof = car.objects["roof"]
    if parented:
        parent = bpy.data.objects.new("parent", None)
        car.collection.objects.link(parent)
        parent.location = (3.0, -2.0, 0.5)
        parent.rotation_euler = TURNED
        roof.parent = parent
        bpy.context.view_layer.update()
    fields = roof.perception_entropy
    fields.ground_position[0] = 0.25
    bpy.context.view_layer.update()
    fields.ground_position = (0.25, -0.5, 1.75)
    bpy.context.view_layer.update()
    fields.ground_rotation = [math.radians(v) for v in (10.0, 90.0, -120.0)]
    read = pose(roof)
    assert read.position == (0.25, -0.5, 1.75)
    assert read.rotation_deg == pytest.approx((10.0, 90.0, -120.0), abs=1e-9)
    roof.matrix_world = roof.matrix_world @ roof.matrix_world.Translation((0.5, 0.0, 0.0))
    assert pose(roof).position != read.position  # moved by hand: the fields follow
    assert tuple(fields.ground_position) == pytest.approx(pose(roof).position, abs=1e-6)


def colors_of(scene):
    """Return the stored colours by name, once the add-on had its turn."""
    bpy.context.view_layer.update()
    consistency.repair_scenes()
    return {obj.name: document.color_of(obj) for obj in document.sensor_objects(scene)}


def test_a_sensor_has_one_colour_in_every_layer_the_list_and_the_study(car):
    for number in range(3):
        scenes.add_sensor(f"eye {number}", "Camera 60 deg", location=(2.0, number - 1.0, 1.0))
    car.perception_entropy.view.beams_of = "ALL"
    stored = colors_of(car)
    assert len(set(stored.values())) == 4
    wanted = {name: np.float32(graphics.rgb_of(color)) for name, color in stored.items()}
    drawn = scenes.drawn(car)
    study = scenes.study()
    assert {sensor.name: sensor.color for sensor in study.rig} == stored
    for name, color in graphics.sensor_colors(study.rig).items():
        (label,) = drawn["labels"][name].labels
        assert np.float32(label.color[:3]) == pytest.approx(wanted[name])
        assert color == pytest.approx(wanted[name])
        assert tuple(car.objects[name].perception_entropy.color) == pytest.approx(wanted[name])
    for name, shape in drawn["frustums"].items():
        for part in (shape.lines, shape.faces):
            assert len(part.colors) and (part.colors[:, :3] == wanted[name]).all()
    beams = drawn["beams"]["roof"].lines.colors[:, :3]
    stopped = np.float32(graphics.VIEWPORT.occluded[:3])
    own, hit = ((beams == color).all(axis=1) for color in (wanted["roof"], stopped))
    assert own.any() and hit.any() and (own | hit).all()


def test_a_sensor_keeps_its_colour_whatever_becomes_of_others(car):
    for name in ("b", "c"):
        scenes.add_sensor(name, "Camera 60 deg", location=(2.0, 0.5, 1.0))
    before = colors_of(car)
    scenes.add_sensor("a first of all", "Camera 60 deg", location=(2.0, -0.5, 1.0))
    assert colors_of(car) | before == colors_of(car), "one was added"
    car.objects["c"].name = "0 renamed"
    assert colors_of(car)["0 renamed"] == before["c"]
    bpy.data.objects.remove(car.objects["b"])
    left = colors_of(car)
    assert left["0 renamed"] == before["c"] and left["roof"] == before["roof"]
    copied = car.objects["0 renamed"].copy()
    car.collection.objects.link(copied)
    found = colors_of(car)
    assert found["0 renamed"] == before["c"] and len(set(found.values())) == len(found)
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(bpy.app.tempdir) / "kept.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(Path(bpy.app.tempdir) / "kept.blend"))
    assert colors_of(bpy.context.scene) == found
