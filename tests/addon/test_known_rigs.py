"""Known rigs in the scene: each becomes a variant, on the vehicle that is chosen."""

import bpy
import pytest

from blender_addon import bridge
from blender_addon.engine import catalog
from tests.addon import scenes


@pytest.mark.parametrize("key", catalog.known_rigs())
def test_a_rig_stands_as_it_was_published(car, key):
    rig = catalog.known_rig(key)
    assert bpy.ops.pe.add_rig(key=key, fit=False) == {"FINISHED"}
    found = {s.name: s for s in scenes.study().rig}
    assert set(found) == {sensor.name for sensor in rig.sensors}
    for sensor in rig.sensors:
        own = found[sensor.name]
        assert own.model is catalog.load(sensor.model)
        assert own.pose.position == pytest.approx(sensor.pose.position, abs=1e-5)
        assert own.pose.rotation_deg == pytest.approx(sensor.pose.rotation_deg, abs=1e-4)


def test_a_rig_is_fitted_and_says_so_and_what_was_here_is_kept(car):
    before = scenes.study().rig["roof"].pose
    bpy.ops.pe.add_rig(key="nuscenes")
    settings = car.perception_entropy
    assert [row.name for row in settings.variants] == ["Unsaved", "nuScenes"]
    active = bridge.active_variant(car)
    assert active.name == "nuScenes" and not settings.variant_changed
    assert "scaled" in active.note and "Source: nuScenes" in active.note
    top = scenes.study().vehicle.bounds[1][2]
    lidar = scenes.study().rig["LIDAR_TOP"].pose.position
    assert lidar[2] == pytest.approx(top + 1.8402 - 1.562, abs=1e-4)
    bpy.ops.pe.switch_variant(key=settings.variants["Unsaved"].key)
    assert [s.name for s in scenes.study().rig] == ["roof"]
    assert scenes.study().rig["roof"].pose == before


def test_an_unknown_rig_is_refused(car):
    with pytest.raises(RuntimeError, match="rig: expected one of"):
        bpy.ops.pe.add_rig(key="zoe")
    assert not car.perception_entropy.variants
