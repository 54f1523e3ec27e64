"""Voxels or objects: from the panel to a study, and what is found back to the panel."""

import json

import bpy
import pytest

import pe_core as pe
from blender_addon import bridge, diagnostics, engine_calls, result_staleness
from blender_addon.live import session
from pe_tools import advice
from pe_tools.jobs import ScoreJob
from tests.addon import scenes


@pytest.fixture
def settings(car):
    """Settings of a scene with a car and a LiDAR of few beams, evaluated on objects in traffic."""
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck")
    found = car.perception_entropy
    found.targets, found.traffic, found.scenes = "objects", True, 8
    return found


def test_a_scene_is_evaluated_on_voxels_until_told_otherwise(car):
    scenes.add_sensor("roof")
    own = car.perception_entropy
    own.traffic = True  # left over from objects: of voxels there is none
    assert scenes.study().targets == pe.TargetRule()
    own.targets = "objects"
    assert scenes.study().targets == pe.TargetRule("objects", traffic=True)


def test_the_panel_scores_objects_as_the_command_line_does(settings, tmp_path):
    """To the bit, and what is found of each class is there for the panel to show."""
    path = tmp_path / "study.toml"
    assert bpy.ops.pe.export_study(filepath=str(path)) == {"FINISHED"}
    job = ScoreJob(pe.load_study(path))
    for _ in job:
        pass
    assert bpy.ops.pe.score() == {"FINISHED"}
    stored = json.loads(settings.result_json)
    assert stored["after"] == bridge.result.scored_data(job.outcome.after, job.outcome.figures[1])
    objects = job.outcome.after.objects
    assert settings.result.ap.startswith(f"{objects.ap:.3f}")
    shown = {row.name: (row.ap, row.reach) for row in settings.result.parts if row.is_class}
    car = objects.per_class["car"]
    assert shown["Car"] == (f"{car.ap:.2f}", advice.lone_reach(car.reach["front"]))
    assert "expected AP" in "\n".join(diagnostics.explanation(settings.id_data).rig)
    score = bridge.result.score_from_dict(stored["after"])
    assert score.objects == objects
    settings.scenes = 9
    assert result_staleness.fingerprint(bpy.context.scene).text != settings.result_signature


def test_the_live_score_follows_on_the_same_targets(settings):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    wish = session.read_request(bpy.context.scene, depsgraph, moving=True)
    summary = engine_calls.live_score("scene", wish, None).summary
    study = scenes.study()
    assert summary.entropy == study.evaluator().entropy(study.rig) and summary.voxels == 0
