"""Jobs: any driver, stop keeps the best, and what lands on disk."""

import csv
import json
import threading

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.jobs import HistoryRow, optimize_job
from tests.engine import shapes

pytestmark = pytest.mark.usefixtures("few_errors", "no_key_figures")


def study(candidates=6, position=(-0.43, 0.0, 1.8)):
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180), position)])
    search = pe.Search(
        free={"roof": ("x", "z", "pitch")},
        samples=2048,
        seed=4,
        schedule=pe.Schedule(candidates=candidates),
        method="random",
    )
    return shapes.car_study(rig, search=search)


def finished(job):
    progress = list(job)
    return progress, job.outcome


def test_a_score_job_scores_what_the_evaluator_scores():
    progress, outcome = finished(pt.ScoreJob(study()))
    assert outcome.after.to_dict() == study().evaluator().score(study().rig).to_dict()
    assert progress[-1].fraction == 1.0
    assert outcome.before is outcome.after and outcome.history == ()


def test_an_optimize_job_improves_and_tells_its_history():
    progress, outcome = finished(pt.OptimizeJob(study()))
    assert outcome.after.entropy < outcome.before.entropy
    assert outcome.after.to_dict() == outcome.study.evaluator().score(outcome.study.rig).to_dict()
    assert outcome.evaluations == 1 + 7 * 6
    entropies = [row.value.objective for row in outcome.history]
    assert entropies == sorted(entropies, reverse=True) and len(entropies) > 1
    assert outcome.history[0].rig is outcome.start.rig
    stages = [p.stage for p in progress]
    assert stages[-1] == "done" and "optimizing" in stages


@pytest.mark.parametrize("job_class", [pt.ScoreJob, pt.OptimizeJob])
def test_stop_before_a_score_is_complete_leaves_no_outcome(job_class, monkeypatch):
    goes_on = threading.Event()
    monkeypatch.setattr(pe.Evaluator, "score", lambda *_, **__: goes_on.wait())
    job = job_class(study())
    for progress in job:
        if progress.stage.startswith("scoring"):
            job.stop()
    assert job.outcome is None
    goes_on.set()


def test_stop_while_the_result_is_scored_cuts_nothing_short():
    job = pt.OptimizeJob(study())
    for progress in job:
        if progress.stage == "scoring the result":
            job.stop()
    assert job.outcome.evaluations == 1 + 7 * 6 and not job.outcome.stopped
    assert job.outcome.after.entropy < job.outcome.before.entropy


@pytest.mark.parametrize("when", [("optimizing",) * 2, ("optimizing", "analysing"), ("analysing",)])
def test_a_stop_ends_the_analysis_and_the_result_does_not_wait_for_it(when, monkeypatch):
    """Before it begins, or while it runs for as long as it likes; the search was stopped or not."""
    goes_on = threading.Event()
    left = list(when)
    monkeypatch.setattr(optimize_job, "robustness", lambda *_, **_named: goes_on.wait(60.0))
    job = pt.OptimizeJob(study())
    for progress in job:
        while left and progress.stage == left[0] and progress.evaluations >= 20:
            left.pop(0)
            assert job.stop()
    assert not left and not job.stop(), "there is nothing more to stop"
    assert not goes_on.is_set() and job.outcome.robustness is None
    assert job.outcome.stopped is ("optimizing" in when)
    assert job.outcome.after.entropy <= job.outcome.before.entropy
    assert pt.result_dict(job.outcome)["entropy"] == job.outcome.after.entropy
    goes_on.set()


def test_stop_keeps_the_best_so_far_at_once_and_analyses_it(monkeypatch):
    given = study()
    goes_on = threading.Event()
    asked = []
    ended = []
    job = pt.OptimizeJob(given)
    entropy = pe.Evaluator.entropy

    def slow(self, *args, **kwargs):
        if job.evaluations >= 20 and not asked:
            ended.append(goes_on.wait(60.0))  # a candidate that takes a minute
        return entropy(self, *args, **kwargs)

    monkeypatch.setattr(pe.Evaluator, "entropy", slow)
    for _ in job:
        if job.evaluations >= 20 and not asked:
            asked.append(job.stop())
        elif len(asked) == 1:
            asked.append(job.best)
            assert not ended, "it waited for the candidate"
    outcome = job.outcome
    assert outcome.stopped and 20 <= outcome.evaluations <= 22
    assert outcome.after.entropy <= outcome.before.entropy and outcome.study.rig is asked[1].rig
    assert outcome.robustness is not None
    goes_on.set()


def test_a_placement_that_only_flatters_the_sample_is_not_taken(monkeypatch):
    job = pt.OptimizeJob(study())
    worse = pe.Rig([job.study.rig.sensors[0].moved(pe.Pose((0.0, 0.0, 0.5)))])

    def flattering():
        job.history += [
            HistoryRow(1, 0, pe.Value(0.0, 9.0), job.study.rig),
            HistoryRow(2, 0, pe.Value(0.0, 1.0), worse),
        ]
        yield pt.Progress("optimizing", 1.0, pe.Value(0.0, 1.0), 2)

    monkeypatch.setattr(job, "_search", flattering)
    _, outcome = finished(job)
    assert outcome.after is outcome.before
    assert outcome.study.rig is job.study.rig


def test_result_files_hold_the_run(tmp_path):
    _, outcome = finished(pt.OptimizeJob(study()))
    data = pt.write_outcome(outcome, tmp_path)
    assert json.loads((tmp_path / "result.json").read_text("utf-8")) == data
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        ".perception-entropy.json",
        "history.csv",
        "result.json",
        "search.json",
        "study.toml",
        "vehicle.npz",
    ]
    rows = list(csv.DictReader((tmp_path / "history.csv").read_text().splitlines()))
    assert len(rows) == len(outcome.history)
    assert float(rows[-1]["roof.z_m"]) == outcome.history[-1].rig.sensors[0].pose.position[2]
    again = pe.load_study(tmp_path / "study.toml")
    assert again.evaluator().score(again.rig).to_dict() == data["after"]
