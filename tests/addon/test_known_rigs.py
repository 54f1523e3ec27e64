"""Known rigs in the scene: each becomes a variant, on the vehicle that is chosen."""

import bpy
import pytest

from blender_addon.engine import catalog
from tests.addon import scenes


def test_each_rig_stands_as_it_was_published(car):
    for key, rig in catalog.known_rigs().items():
        assert bpy.ops.pe.add_rig(key=key, fit=False) == {"FINISHED"}
        found = {s.name: s for s in scenes.study().rig}
        assert set(found) == {sensor.name for sensor in rig.sensors}, key
        for sensor in rig.sensors:
            own = found[sensor.name]
            assert own.model is catalog.load(sensor.model)
            assert own.pose.position == pytest.approx(sensor.pose.position, abs=1e-5)
            assert own.pose.rotation_deg == pytest.approx(sensor.pose.rotation_deg, abs=1e-4)
