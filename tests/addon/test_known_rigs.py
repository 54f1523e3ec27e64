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


def test_a_template_fills_the_named_places_and_an_empty_that_was_moved_leads(car):
    vehicle = scenes.study().vehicle
    assert bpy.ops.pe.add_rig(key="parking") == {"FINISHED"}
    wanted = catalog.rig_on(catalog.rig_named("parking"), vehicle)
    found = {s.name: s for s in scenes.study().rig}
    assert set(found) == {sensor.name for sensor in wanted}
    for sensor in wanted:
        assert found[sensor.name].pose.position == pytest.approx(sensor.pose.position, abs=1e-5)
        assert found[sensor.name].pose.rotation_deg == pytest.approx(
            sensor.pose.rotation_deg, abs=1e-4
        )
    tints = {name: sensor.color for name, sensor in found.items()}

    assert bpy.ops.pe.show_places() == {"FINISHED"}
    empty = bpy.data.objects["grille"]
    empty.location.z += 0.1
    bpy.context.view_layer.update()
    assert bpy.ops.pe.add_rig(key="parking") == {"FINISHED"}
    moved = {s.name: s for s in scenes.study().rig}
    for name, sensor in moved.items():
        x, y, z = found[name].pose.position
        up = 0.1 if name == "Camera grille" else 0.0
        assert sensor.pose.position == pytest.approx((x, y, z + up), abs=1.1e-3), name
        assert sensor.color == tints[name], "a place keeps its colour"
    assert bpy.ops.pe.show_places() == {"FINISHED"}
    assert "grille" not in bpy.data.objects
