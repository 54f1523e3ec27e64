"""Goals of a search in the panel: the study that they make, fronts, lines of the analysis."""

import bpy
import pytest

import pe_core as pe
from blender_addon import document
from blender_addon.queries import diagnostics
from pe_core.search import Goals
from pe_tools.advice import flatness
from pe_tools.jobs import FrontJob, front_dict
from tests.addon import scenes


@pytest.fixture
def asked(car):
    """Return a scene whose search has all goals."""
    settings = car.perception_entropy
    settings.evaluations = 60
    settings.search_samples = 1024
    settings.score_samples = 1024
    return car


def test_the_panel_finds_the_front_of_the_job(asked):
    settings = asked.perception_entropy
    settings.front_objectives = {"entropy", "height"}
    settings.front_points = 3
    # a lower sensor has more of both
    settings.keep_blind_ground = settings.keep_blind_sector = False
    job = FrontJob(scenes.study(), 1)
    list(job)
    assert bpy.ops.pe.choose_sensors() == {"FINISHED"}
    names = [design.name for design in job.trade_off.front]
    assert [row.name for row in settings.front.rows] == names
    assert {row.key for row in settings.variants} >= {row.key for row in settings.front.rows}
    figures = front_dict(job.trade_off)["designs"][0]["figures"]
    assert settings.front.rows[0].figures == ", ".join(f"{n} {v:.4g}" for n, v in figures.items())
    assert settings.front.told == f"{len(names)} on the front of entropy, height"
    [row] = [each for each in settings.variants if each.key == settings.front.rows[0].key]
    study = document.study_of_variant(asked, row, scenes.depsgraph())
    assert study.rig["roof"].pose == job.trade_off.front[0].study.rig["roof"].pose


def test_how_flat_the_optimum_is_is_told_in_the_scene(asked, monkeypatch):
    settings = asked.perception_entropy
    monkeypatch.setattr(flatness, "SHARE", 1)
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    assert "1 cm or 1 deg" in "\n".join(diagnostics.explanation(settings.id_data).search)


def test_goals_of_the_panel_are_those_of_the_study(asked):
    settings = asked.perception_entropy
    assert scenes.study().limits == pe.Limits(blind_ground=True, blind_sector=True)
    settings.keep_blind_ground = settings.keep_blind_sector = False
    assert scenes.study().limits == pe.Limits()
    assert scenes.study().search.goals == Goals()
    settings.limit_entropy = -1.25
    settings.keep_entropy = True
    assert scenes.study().limits == pe.Limits(entropy=-1.25)
    settings.stop_gain = 0.002
    bpy.data.objects["roof"].perception_entropy.stays = True
    goals = scenes.study().search.goals
    assert (goals.stop.seconds, goals.stop.gain) == (None, 0.002)
    assert goals.fixed == ("roof",)
    settings.start_variants = True
    assert scenes.study().search.goals.starts == ()
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    bpy.data.objects["roof"].location.x += 0.2
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    [start] = scenes.study().search.goals.starts
    now = scenes.study().rig["roof"].pose.position[0]
    assert start.poses["roof"].position[0] == pytest.approx(now - 0.2, abs=1e-5)
