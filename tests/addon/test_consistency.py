"""Sensors that came by duplicating, copying, appending, renaming, or from older files."""

import bpy
import pytest

from blender_addon import document
from blender_addon.caches import consistency, sensor_cache


@pytest.fixture
def scored(car):
    """Return the scene with its LiDAR scored."""
    consistency.repair_scenes()
    assert bpy.ops.pe.score() == {"FINISHED"}
    return car


def results(scene):
    """Return what each sensor holds of a result, by name; None where it holds none."""
    own = {obj.name: document.figures_of_sensor(obj) for obj in document.sensor_objects(scene)}
    return {name: None if each is None else each.entropy for name, each in own.items()}


@pytest.mark.parametrize("linked", [False, True])
def test_a_duplicate_is_a_new_sensor_without_a_result(scored, linked):
    before = results(scored)
    bpy.ops.object.duplicate(linked=linked)
    consistency.repair_scenes()
    assert results(scored) == {**before, "roof.001": None}
    assert [each.name for each in sensor_cache.sensors(scored)] == ["roof", "roof.001"]
    assert before["roof"] is not None


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
