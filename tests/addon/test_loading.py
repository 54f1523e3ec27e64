"""A study put into a scene: the scene is that study again, to the bit, or says what it is not."""

import math

import bpy
import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import document
from blender_addon.engine import studies
from tests.addon import scenes

CORNERS = scenes.ASSETS / "examples" / "four_corners" / "study.toml"
ROWS = {
    "weather": "weathers",
    "state": "states",
    "prior.focus": "focus",
    "ap.NAME": "curves",
    "optimize.mount": "mounts",
}
"""Lists of a scene with the settings of a table."""
IN_SCENE = [
    (row.key.rpartition(".")[0], row)
    for row in studies.setting_keys()
    if row.setting.panel is not None
    if row.key.rpartition(".")[0] in ROWS or not row.rows
]


def load(study):
    return document.load_into(bpy.context.scene, study)


def history(study):
    job = pt.OptimizeJob(study, 1)
    list(job)
    rows = [(row.value, [s.pose for s in row.rig]) for row in job.history]
    return rows, job.outcome.after.entropy


def test_the_four_corners_come_into_an_empty_scene_to_the_bit(scene):
    study = pe.load_study(CORNERS)
    assert load(study) == []
    again = scenes.study()
    assert np.array_equal(again.vehicle.triangles, study.vehicle.triangles)
    assert again.search == study.search
    assert again.requirements == study.requirements and study.requirements
    left = bpy.data.objects["front_left"].perception_entropy
    assert (left.mirror_of, left.mount) == ("front_right", "roof corners")
    settings = scene.perception_entropy
    settings.score_samples = settings.search_samples = 1024
    settings.method = "random"
    settings.candidates = 1
    for row in settings.requirements:  # equal above, and this search does not keep them
        row.enabled = False
    here = scenes.study()
    kept = {"search": here.search, "samples": 1024, "requirements": ()}
    there = pe.Study(**{**vars(study), **kept})
    assert history(here) == history(there)


def other_value(setting):
    """Return a value of a setting that is not its default."""
    rule = setting.rule
    match rule:
        case studies.Toggle():
            return not setting.default
        case studies.OneOf():
            return next(text for text in reversed(rule.among) if text != setting.default)
        case studies.Several():
            return tuple(rule.among)[:2]
        case studies.Pair():
            return (-30.0, 31.5)
        case studies.Texts():
            return ("door open", "loaded")
        case studies.Name():
            return "EUR"
        case studies.Whole():
            return 4096 if (rule.maximum or 4096) >= 4096 else rule.minimum + 3
        case studies.Angle():
            return math.radians(0.7)
    least = max(rule.minimum, -10.0 if setting.panel.min is None else setting.panel.min)
    return least + 0.37 * (min(rule.maximum, least + 1.0) - least)


def test_each_declared_setting_is_held_by_the_scene_as_it_was(scene):
    settings = scene.perception_entropy
    for table, row in IN_SCENE:
        group = getattr(settings, ROWS[table]).add() if row.rows else settings
        setting = row.setting
        name = setting.panel.property
        value = other_value(setting)
        value = setting.rule.checked("test", setting.name, value)
        value = studies.value_in_file(setting.rule, value)
        setattr(group, name, document.property_value(setting, value))
        found = document.value_of_property(setting, getattr(group, name))
        assert found == value or found == pytest.approx(value, rel=1e-6), (table, name)
        if setting.is_optional:
            setattr(group, name, document.property_value(setting, None))
            assert document.value_of_property(setting, getattr(group, name)) is None, name


def test_coordinates_in_double_precision_come_back_to_the_bit(scene):
    turn = np.array(bpy.data.objects.new("any", None).matrix_world)[:3, :3]
    rng = np.random.default_rng(0)
    triangles = rng.uniform(-1.0, 1.0, (50, 3, 3)) @ turn + [0.1, 0.2, 1.0]
    triangles = np.float32(triangles).astype(float) + np.float32(1e-9 * rng.normal(size=(50, 3, 3)))
    scene.perception_entropy.vehicle = document.vehicle.make_body(scene, pe.Vehicle(triangles))
    bpy.context.view_layer.update()
    found = scenes.vehicle(scene.perception_entropy.vehicle)
    assert np.array_equal(found.triangles, triangles)


def test_what_a_scene_cannot_hold_is_reported(car, monkeypatch):
    study = scenes.study()
    prior = pe.Prior("road", pe.Prior.road().classes[:2])
    assert load(pe.Study(study.rig, study.vehicle, prior=prior)) == ["prior"]
    few_draws = pe.Search(tolerance=pe.Tolerance(0.01, draws=6))
    assert load(pe.Study(study.rig, study.vehicle, search=few_draws)) == []


def test_a_model_of_the_study_s_own_is_refused_and_nothing_is_changed(car):
    own = pe.catalog.from_table(
        "mine", {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 60}
    )
    study = scenes.study()
    rig = pe.Rig([pe.Sensor("eye", own, pe.Pose((0.0, 0.0, 2.0)))])
    with pytest.raises(pe.InputError, match=r"study: sensor 'eye': model: expected one of"):
        load(pe.Study(rig, study.vehicle))
    assert scenes.study().rig["roof"]
