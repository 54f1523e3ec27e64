"""Own sensors, AP curves, space, clearance and bounds: from the panel to a study file."""

import math

import bpy
import pytest

from blender_addon import document
from blender_addon.engine import catalog
from tests.addon import scenes


def add_own(kind="lidar", **figures):
    """Return a new own sensor of the scene."""
    assert bpy.ops.pe.add_row(rows="own_sensors", kind=kind) == {"FINISHED"}
    row = bpy.context.scene.perception_entropy.own_sensors[-1]
    for name, value in figures.items():
        setattr(row, name, value)
    return row


def test_an_own_lidar_is_a_model_like_any_other(car):
    row = add_own(channels=5, elevations=(-20.0, 0.0), azimuths=(-60.0, 60.0), max_range=80.0)
    assert row.name == "My LiDAR" and not row.problem
    sensor = scenes.add_sensor("bumper", model="My LiDAR", location=(2.2, 0.0, 0.6))
    model = scenes.study().rig["bumper"].model
    assert [round(math.degrees(e), 6) for e in model.elevations] == [-20, -15, -10, -5, 0]
    assert math.degrees(model.azimuth_step) == pytest.approx(0.2) and model.max_range == 80.0
    assert [math.degrees(a) for a in model.horizontal_fov] == pytest.approx([-60, 60])
    assert sensor.perception_entropy.model == "My LiDAR"


def test_a_name_that_is_taken_and_figures_that_cannot_be_are_said_at_the_row(car):
    row = add_own(name="Pandar64")
    document.sync_own_sensors()
    assert "a name used once" in row.problem and catalog.load("Pandar64").max_range == 200.0
    row.name = "Mine"
    row.azimuths = (10.0, -10.0)
    assert "horizontal_fov" in row.problem and "Mine" not in catalog.entries()
    row.azimuths = (-10.0, 10.0)
    assert not row.problem and "Mine" in catalog.entries()
