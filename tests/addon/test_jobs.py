"""Score and optimize from the scene: the engine's own numbers, to the bit."""

import json
from types import SimpleNamespace

import bpy
import pytest

from blender_addon import bridge, stale
from blender_addon.engine import pe, text
from blender_addon.operators import job, running
from tests.addon import scenes


def finished(work):
    for _ in work:
        pass
    return work.outcome


def stored(scene) -> dict:
    """Return the stored result without what differs from run to run."""
    data = json.loads(scene.perception_entropy.result_json)
    del data["run"]
    return data


def data_of(outcome) -> dict:
    data = json.loads(text.dump_json(pe.result_dict(outcome)))
    del data["run"]
    return data


def test_score_is_the_engines(car):
    expected = finished(pe.ScoreJob(scenes.study()))
    assert bpy.ops.pe.score() == {"FINISHED"}
    assert stored(car) == data_of(expected)


def test_score_of_the_whole_grid_is_the_engines(car):
    car.perception_entropy.score_samples = 0
    study = scenes.study()
    assert bpy.ops.pe.score() == {"FINISHED"}
    assert stored(car)["entropy"] == study.evaluator().score(study.rig).entropy


def test_result_is_shown(car):
    scenes.add_sensor("front", model="Camera 60 deg")
    bpy.ops.pe.score()
    settings, data = car.perception_entropy, stored(car)
    assert settings.has_result and not settings.result_stale
    assert settings.result_entropy == pytest.approx(data["entropy"], abs=1e-6)
    roof = car.objects["roof"].perception_entropy
    assert roof.has_result and roof.beams == 64 * 1800
    assert roof.stopped == data["after"]["per_sensor"]["roof"]["stopped"] > 0
    assert "cabin" in roof.stopped_text
    assert car.objects["front"].perception_entropy.beams == 0


def test_warnings_are_stored_as_the_result_has_them(car):
    """A sensor in the body, and the vehicle turned; what is mended is gone with the next score."""
    settings, roof = car.perception_entropy, car.objects["roof"]
    before = roof.location.copy()
    roof.location = (1.5, 0.0, 0.1)
    body = car.objects["body"]
    body.location.z -= 0.5
    bpy.ops.pe.score()
    told = stored(car)["warnings"]
    rows = settings.result_warnings
    assert [(each["subject"], each["code"]) for each in told] == [
        *((None, "height"), ("roof", "inside"))
    ]
    assert [(row.subject, row.code, row.text) for row in rows] == [
        (each["subject"] or "", each["code"], each["text"]) for each in told
    ]
    assert rows[0].fix == "move_vehicle" and rows[0].amounts == 3
    assert list(rows[0].amount) == pytest.approx(told[0]["amount"])
    roof.location, body.location.z = before, body.location.z + 0.5
    bpy.ops.pe.score()
    assert not rows and stored(car)["warnings"] == []


def test_optimize_is_the_engines_and_stays_so(car):
    """Placements written to the scene and read again are those that were scored."""
    expected = finished(pe.OptimizeJob(scenes.study()))
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    assert stored(car) == data_of(expected)
    study = scenes.study()
    assert [s.pose for s in study.rig] == [s.pose for s in expected.study.rig]
    assert expected.study.rig["roof"].pose != expected.start.rig["roof"].pose
    assert finished(pe.ScoreJob(study)).after == expected.after


def test_exported_study_scores_the_same(car, tmp_path):
    path = tmp_path / "car.toml"
    assert bpy.ops.pe.export_study(filepath=str(path)) == {"FINISHED"}
    loaded, study = pe.load_study(path), scenes.study()
    assert path.with_suffix(".npz").exists()
    assert (loaded.vehicle.triangles == study.vehicle.triangles).all()
    assert finished(pe.ScoreJob(loaded)).after == finished(pe.ScoreJob(study)).after


def test_fixed_sensor_stays(car):
    sensor = car.objects["roof"]
    sensor.perception_entropy.free = (False,) * 6
    before = scenes.study().rig["roof"].pose
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    assert scenes.study().rig["roof"].pose == before


def test_undo_brings_placement_and_result_back(car):
    bpy.ops.ed.undo_push(message="before")
    before = scenes.study().rig["roof"].pose
    assert bpy.ops.pe.optimize("EXEC_DEFAULT", True) == {"FINISHED"}
    assert scenes.study().rig["roof"].pose != before
    bpy.ops.ed.undo()
    assert scenes.study().rig["roof"].pose == before
    assert not bpy.context.scene.perception_entropy.has_result


def test_stopped_search_keeps_the_best(car):
    job = pe.OptimizeJob(scenes.study())
    for progress in job:
        if progress.evaluations >= 8:
            job.stop()
    assert job.outcome.stopped
    bridge.place_rig(car, job.outcome.study.rig)
    bridge.store_outcome(car, job.outcome)
    assert job.outcome.after.entropy <= job.outcome.before.entropy
    assert scenes.study().rig["roof"].pose == job.outcome.study.rig["roof"].pose


def test_stopped_before_a_score_is_complete_changes_nothing(car):
    told = []
    operator = SimpleNamespace(report=lambda *words: told.append(words))
    assert job.PE_OT_optimize._apply(operator, car, None) == {"CANCELLED"}
    assert told == [({"INFO"}, "Stopped before a score was complete: nothing was changed")]
    assert not car.perception_entropy.has_result


def test_bad_input_is_an_error_and_changes_nothing(car):
    car.perception_entropy.vehicle = None
    for operator in (bpy.ops.pe.score, bpy.ops.pe.optimize):
        with pytest.raises(RuntimeError, match="vehicle collection: expected a collection"):
            operator()
    assert not car.perception_entropy.has_result


def test_sensor_deleted_meanwhile(car):
    outcome = finished(pe.OptimizeJob(scenes.study()))
    bpy.data.objects.remove(car.objects["roof"])
    assert bridge.place_rig(car, outcome.study.rig) == ["roof"]
    bridge.store_outcome(car, outcome)


def test_one_job_at_a_time(car, monkeypatch):
    monkeypatch.setattr(running, "current", object())
    assert not bpy.ops.pe.score.poll()
    with pytest.raises(RuntimeError, match="Another score or search is running"):
        bpy.ops.pe.optimize()
    assert bpy.ops.pe.cancel.poll()


def test_nothing_to_cancel(car):
    assert not bpy.ops.pe.cancel.poll()


def test_result_goes_stale_and_comes_back(car):
    settings, sensor = car.perception_entropy, car.objects["roof"]
    bpy.ops.pe.score()
    stale.check()
    assert not settings.result_stale
    changes = ((sensor, "location", (0.0, 0.0, 2.0)), (settings, "prior", "uniform"))
    changes += ((sensor.perception_entropy, "model", "HDL-64E"),)
    changes += ((car.objects["body"], "location", (0.0, 0.0, 1.0)),)
    changes += ((car.objects["body"], "hide_render", True),)
    for owner, name, value in changes:
        before = getattr(owner, name)
        before = before.copy() if name == "location" else before
        for new, expected in ((value, True), (before, False)):
            setattr(owner, name, new)
            bpy.context.view_layer.update()
            stale.check()
            assert settings.result_stale == expected, (name, new)
