"""Own sensors, AP curves, space, clearance and bounds: from the panel to a study file."""

import math

import bpy
import pytest

import pe_core as pe
from blender_addon import bridge, engine_calls
from blender_addon.engine import catalog
from blender_addon.live import session
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


@pytest.fixture
def full(car):
    """Return a scene with everything set that is seldom changed."""
    settings = car.perception_entropy
    add_own(channels=16, elevations=(-15.0, 15.0), max_range=90.0)
    scenes.add_sensor("bumper", model="My LiDAR", location=(2.2, 0.0, 0.6))
    bpy.ops.pe.add_row(rows="curves")
    settings.curves["lidar"].own = True
    settings.curves["lidar"].a = 0.2
    settings.space_x = (-20.0, 40.0)
    settings.space_interval = 0.2
    settings.clearance = 0.05
    bounds = bpy.data.objects["roof"].perception_entropy
    bounds.bounded[2] = True
    bounds.bounds_low[2] = 1.7
    bounds.bounds_high[2] = 1.9
    bounds.bounded[4] = True
    bounds.bounds_low[4] = -5.0
    bounds.bounds_high[4] = 5.1
    return car


def test_an_exported_study_scores_and_searches_the_same(full, tmp_path):
    """Elsewhere nobody knows the own sensor: the file says what it is."""
    path = tmp_path / "study.toml"
    assert bpy.ops.pe.export_study(filepath=str(path)) == {"FINISHED"}
    study = scenes.study()
    bridge.remove_own_sensors()
    read = pe.load_study(path)
    assert "elevations_deg" in path.read_text() and "clearance = 0.05" in path.read_text()
    assert (read.space, read.model, read.search) == (study.space, study.model, study.search)
    assert read.evaluator().entropy(read.rig) == study.evaluator().entropy(study.rig)


def test_a_name_that_is_taken_and_figures_that_cannot_be_are_said_at_the_row(car):
    row = add_own(name="Pandar64")
    bridge.sync_own_sensors()
    assert "a name used once" in row.problem and catalog.load("Pandar64").max_range == 200.0
    row.name = "Mine"
    row.azimuths = (10.0, -10.0)
    assert "horizontal_fov" in row.problem and "Mine" not in catalog.entries()
    row.azimuths = (-10.0, 10.0)
    assert not row.problem and "Mine" in catalog.entries()


def test_the_live_score_is_of_the_same_study(full):
    """What follows the hand is of the scene's own space and curves, as the score is."""
    study = scenes.study()
    wish = session.read_request(full, scenes.depsgraph())
    problem = wish.problem
    assert (problem.space, problem.model) == (study.space, study.model)
    assert problem.vehicle.clearance == 0.05
    own = study.evaluator(samples=engine_calls.SAMPLES)
    assert engine_calls.live_score("it", wish, None).summary.entropy == own.entropy(study.rig)
    full.perception_entropy.space_x = (-20.0, 30.0)
    changed = session.read_request(full, scenes.depsgraph())
    assert changed.problem.key != problem.key
