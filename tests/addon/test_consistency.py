"""Sensors that came by duplicating, copying, appending, renaming, or from older files."""

import bpy
import pytest

from blender_addon import bridge, consistency, sensor_cache
from tests.addon import scenes


@pytest.fixture
def scored(car):
    """Return the scene with its LiDAR scored."""
    consistency.repair_scenes()
    assert bpy.ops.pe.score() == {"FINISHED"}
    return car


def results(scene):
    """Return what each sensor holds of a result, by name; None where it holds none."""
    own = {obj.name: bridge.figures_of_sensor(obj) for obj in bridge.sensor_objects(scene)}
    return {name: None if each is None else each.entropy for name, each in own.items()}


@pytest.mark.parametrize("linked", [False, True])
def test_a_duplicate_is_a_new_sensor_without_a_result(scored, linked):
    before = results(scored)
    bpy.ops.object.duplicate(linked=linked)
    consistency.repair_scenes()
    assert results(scored) == {**before, "roof.001": None}
    assert [each.name for each in sensor_cache.sensors(scored)] == ["roof", "roof.001"]
    assert before["roof"] is not None


def test_a_duplicate_of_a_duplicate_is_no_owner_of_its_original_s_result(scored):
    for _ in range(2):
        bpy.ops.object.duplicate()
        consistency.repair_scenes()
    assert [name for name, entropy in results(scored).items() if entropy is not None] == ["roof"]


def test_a_renamed_sensor_keeps_its_result_and_its_duplicate_gets_none(scored):
    entropy = results(scored)["roof"]
    scored.objects["roof"].name = "top"
    consistency.repair_scenes()
    assert results(scored) == {"top": entropy}
    bpy.ops.object.duplicate()
    consistency.repair_scenes()
    assert results(scored) == {"top": entropy, "top.001": None}


def test_an_appended_sensor_is_a_new_one(scored, tmp_path):
    """Appended under a name that is free here, it brings its result under its own name."""
    blend = str(tmp_path / "other.blend")
    bpy.ops.wm.save_as_mainfile(filepath=blend, copy=True)
    scored.objects["roof"].name = "left"
    consistency.repair_scenes()
    scored.objects["left"].location.x = 0.3
    bpy.ops.pe.score()
    before = results(scored)
    bpy.ops.wm.append(filename="roof", directory=f"{blend}/Object/")
    consistency.repair_scenes()
    assert results(scored) == {**before, "roof": None}
    assert len(sensor_cache.sensors(scored)) == 2


def test_a_score_gives_all_of_them_results(scored):
    bpy.ops.object.duplicate()
    consistency.repair_scenes()
    bpy.ops.pe.score()
    consistency.repair_scenes()
    assert None not in results(scored).values() and len(results(scored)) == 2


def collections_of(obj):
    """Names of the collections that an object is in."""
    return [each.name for each in obj.users_collection]


@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_shipped_files_link_sensors_once(name, tmp_path):
    """As they are on disk: opened without the add-on, which would mend them."""
    bpy.ops.wm.open_mainfile(filepath=str(scenes.ASSETS / f"{name}.blend"))
    assert len(bpy.data.collections["Sensors"].objects) == {"sedan": 1, "bus": 2}[name]
    for obj in bpy.data.collections["Sensors"].objects:
        assert collections_of(obj) == ["Sensors"]
