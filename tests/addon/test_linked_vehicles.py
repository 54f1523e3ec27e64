"""Vehicles that are another file's."""

import bpy
import pytest

from blender_addon import document
from tests.addon import scenes


def linked_car(tmp_path):
    """Put the car into a library; return its study, and a new scene that links it."""
    expected = scenes.study()
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {bpy.data.collections["Car"]})
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.collections = ["Car"]
    settings = bpy.context.scene.perception_entropy
    settings.score_samples = settings.search_samples = 4096
    settings.candidates = 2
    settings.method = "random"
    return expected, bpy.context.scene, bpy.data.collections["Car"]


def assert_same(study, expected):
    assert (study.vehicle.triangles == expected.vehicle.triangles).all()
    first, second = (s.evaluator().score(s.rig).entropy for s in (study, expected))
    assert first == second


def test_a_linked_vehicle_is_the_vehicle(car, tmp_path):
    expected, scene, linked = linked_car(tmp_path)
    scene.collection.children.link(linked)
    scene.perception_entropy.vehicle = linked
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    assert_same(scenes.study(), expected)
    bpy.ops.pe.score()
    parts = document.figures_of_sensor(scene.objects["roof"]).occluded_by
    assert "cabin [library.blend]" in parts


def test_an_instanced_vehicle_is_the_vehicle(car, tmp_path):
    expected, scene, linked = linked_car(tmp_path)
    holder = scenes.add_collection(scene.collection, "Holder")
    empty = bpy.data.objects.new("instance", None)
    empty.instance_type = "COLLECTION"
    empty.instance_collection = linked
    holder.objects.link(empty)
    scene.perception_entropy.vehicle = holder
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    assert_same(scenes.study(), expected)


def test_an_overridden_vehicle_is_the_vehicle_and_can_be_turned(car, tmp_path):
    expected, scene, linked = linked_car(tmp_path)
    scene.collection.children.link(linked)
    own = linked.override_hierarchy_create(scene, bpy.context.view_layer)
    scene.perception_entropy.vehicle = own
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    assert_same(scenes.study(), expected)
    assert bpy.ops.pe.fix_warning(fix="turn_vehicle", amount=(180.0, 0.0, 0.0)) == {"FINISHED"}
    low, high = scenes.study().vehicle.bounds
    assert (low[0], high[0]) == pytest.approx((-2.0, 2.0), abs=1e-5)
    assert (scenes.study().vehicle.triangles != expected.vehicle.triangles).any()
