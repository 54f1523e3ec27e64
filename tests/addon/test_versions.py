"""Files of newer versions, and vehicles that are another file's."""

import bpy
import pytest

from blender_addon import bridge, choices
from tests.addon import scenes
from tests.addon.command_line import run_here


def test_a_saved_file_has_its_version(car, tmp_path):
    assert car.perception_entropy.version == 0
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "new.blend"))
    assert car.perception_entropy.version == choices.VERSION


def test_a_newer_file_is_reported_in_one_line_and_keeps_its_version(car, tmp_path):
    path = tmp_path / "newer.blend"
    car.perception_entropy.version = choices.VERSION + 6
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    assert scene.perception_entropy.version == choices.VERSION + 6
    assert "newer version" in bridge.newer_version_message(scene)
    answer = run_here(path, "score", "--samples", "4096")
    assert answer.returncode == 0
    told = [line for line in answer.stderr.splitlines() if "newer version" in line]
    assert len(told) == 1 and answer.stdout


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
    parts = bridge.figures_of_sensor(scene.objects["roof"]).parts
    assert "cabin [library.blend]" in dict(parts)


def test_parts_of_a_linked_vehicle_are_selected_and_it_is_not_turned(car, tmp_path):
    _, scene, linked = linked_car(tmp_path)
    scene.collection.children.link(linked)
    scene.perception_entropy.vehicle = linked
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    name = scenes.study().vehicle.part_names[0]
    assert bpy.ops.pe.select_part(name=name) == {"FINISHED"}
    with pytest.raises(RuntimeError, match="expected an object of this file, found linked from"):
        bpy.ops.pe.mend(fix="turn_vehicle", amount=(90.0, 0.0, 0.0))


def test_an_instanced_vehicle_is_the_vehicle(car, tmp_path):
    expected, scene, linked = linked_car(tmp_path)
    holder = scenes.add_collection(scene.collection, "Holder")
    empty = bpy.data.objects.new("instance", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", linked
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
    assert bpy.ops.pe.mend(fix="turn_vehicle", amount=(180.0, 0.0, 0.0)) == {"FINISHED"}
    low, high = scenes.study().vehicle.bounds
    assert (low[0], high[0]) == pytest.approx((-2.0, 2.0), abs=1e-5)
    assert (scenes.study().vehicle.triangles != expected.vehicle.triangles).any()
