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
    assert bpy.ops.pe.add_own_sensor(kind=kind) == {"FINISHED"}
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


def test_an_own_camera_is_a_model_like_any_other(car):
    add_own("camera", width=640, height=480, hfov=70.3)
    scenes.add_sensor("eye", model="My Camera", location=(0.7, 0.0, 1.6))
    model = scenes.study().rig["eye"].model
    assert (model.width, model.height) == (640, 480)
    assert math.degrees(model.hfov) == pytest.approx(70.3, abs=1e-12)  # as typed, not float32


def test_a_model_of_one_channel(car):
    add_own(channels=1, elevations=(-3.0, 5.0))
    assert [round(math.degrees(e), 6) for e in catalog.load("My LiDAR").elevations] == [-3.0]


@pytest.fixture
def full(car):
    """Return a scene with everything set that is seldom changed."""
    settings = car.perception_entropy
    add_own(channels=16, elevations=(-15.0, 15.0), max_range=90.0)
    scenes.add_sensor("bumper", model="My LiDAR", location=(2.2, 0.0, 0.6))
    bpy.ops.pe.own_curves()
    settings.curves["lidar"].own, settings.curves["lidar"].a = True, 0.2
    settings.space_x, settings.space_interval, settings.clearance = (-20.0, 40.0), 0.2, 0.05
    bounds = bpy.data.objects["roof"].perception_entropy
    bounds.bounded[2], bounds.bounds_low[2], bounds.bounds_high[2] = True, 1.7, 1.9
    bounds.bounded[4], bounds.bounds_low[4], bounds.bounds_high[4] = True, -5.0, 5.1
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


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [("space_x", (10.0, -10.0), "space"), ("space_interval", 0.3, "a length that divides")],
)
def test_an_impossible_space_is_one_line(car, name, value, said):
    setattr(car.perception_entropy, name, value)
    with pytest.raises(pe.InputError, match=said) as raised:
        scenes.study()
    assert "scene" in str(raised.value) and "\n" not in str(raised.value)


def test_bounds_that_do_not_hold_the_start_are_one_line(full):
    bpy.data.objects["roof"].perception_entropy.bounds_high[2] = 1.75
    with pytest.raises(RuntimeError, match=r"bounds of z.*bounds around the start, 1.8 m"):
        bpy.ops.pe.optimize()


def test_the_search_keeps_within_its_bounds(full):
    bpy.ops.pe.optimize()
    place = bpy.data.objects["roof"].matrix_world
    assert 1.7 - 1e-5 <= place.translation.z <= 1.9 + 1e-5
    assert -5.0 - 1e-3 <= math.degrees(place.to_euler().y) <= 5.1 + 1e-3


def test_the_button_bounds_an_axis_round_where_the_sensor_is(car):
    bpy.context.view_layer.objects.active = bpy.data.objects["roof"]
    settings = bpy.data.objects["roof"].perception_entropy
    bpy.ops.pe.bound_axis(axis=2)
    assert settings.bounded[2]
    assert (settings.bounds_low[2], settings.bounds_high[2]) == pytest.approx((1.3, 2.3))
    bpy.ops.pe.bound_axis(axis=2)
    assert not settings.bounded[2]


@pytest.mark.parametrize(
    "change",
    [
        lambda s: setattr(s.own_sensors[0], "channels", 17),
        lambda s: setattr(s, "space_x", (-20.0, 30.0)),
        lambda s: setattr(s, "clearance", 0.06),
        lambda s: setattr(s.curves["lidar"], "a", 0.21),
    ],
)
def test_a_change_of_any_makes_another_fingerprint(full, change):
    before = bridge.signature(full)
    assert bridge.signature(full) == before
    change(full.perception_entropy)
    assert bridge.signature(full) != before


def test_what_is_not_used_makes_none(car):
    before = bridge.signature(car)
    add_own()
    bpy.ops.pe.own_curves()
    assert bridge.signature(car) == before


def test_sensors_go_with_a_model_that_is_renamed(full):
    full.perception_entropy.own_sensors[0].name = "Bumper LiDAR"
    bridge.sync_own_sensors()
    assert bpy.data.objects["bumper"].perception_entropy.model == "Bumper LiDAR"
    assert "My LiDAR" not in catalog.entries() and "Bumper LiDAR" in catalog.entries()


def test_a_name_that_is_taken_and_figures_that_cannot_be_are_said_at_the_row(car):
    row = add_own(name="Pandar64")
    bridge.sync_own_sensors()
    assert "a name used once" in row.problem and catalog.load("Pandar64").max_range == 200.0
    row.name, row.azimuths = "Mine", (10.0, -10.0)
    assert "horizontal_fov" in row.problem and "Mine" not in catalog.entries()
    row.azimuths = (-10.0, 10.0)
    assert not row.problem and "Mine" in catalog.entries()


def test_a_removed_one_is_refused_in_one_line(full):
    bpy.ops.pe.remove_own_sensor()
    with pytest.raises(RuntimeError, match=r"bumper.*model"):
        bpy.ops.pe.score()


def test_the_live_score_is_of_the_same_study(full):
    """What follows the hand is of the scene's own space and curves, as the score is."""
    study, wish = scenes.study(), session.read_request(full, scenes.depsgraph(), moving=False)
    problem = wish.problem
    assert (problem.space, problem.model) == (study.space, study.model)
    assert problem.vehicle.clearance == 0.05
    own = study.evaluator(samples=engine_calls.SAMPLES)
    assert engine_calls.live_score("it", wish, None).summary.entropy == own.entropy(study.rig)
    full.perception_entropy.space_x = (-20.0, 30.0)
    changed = session.read_request(full, scenes.depsgraph(), moving=False)
    assert changed.problem.key != problem.key
