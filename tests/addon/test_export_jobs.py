"""Exports as jobs: steps with progress; stopped at any step they leave nothing behind."""

import itertools

import bpy
import pytest

from blender_addon.operators import exports, running_job

OPTIONS = {"page.html": {}, "picture.svg": {}, "scene.glb": {"range_m": 5.0}}
STAGES = {
    "page.html": ["scoring", "page"],
    "picture.svg": ["scoring", "picture"],
    "scene.glb": ["exporting"],
}


@pytest.fixture
def small(car, small_pictures):
    """Return a scene that is scored fast and drawn in few pixels."""
    car.perception_entropy.score_samples = 1024
    return car


@pytest.fixture
def job_of(small, monkeypatch):
    """Return what makes the job of an export to a file, as its operator does."""
    made = []
    monkeypatch.setattr(exports, "run", lambda job, _asked: made.append(job))

    def make(path):
        assert bpy.ops.pe.export_file(filepath=str(path), **OPTIONS[path.name]) == {"FINISHED"}
        return made.pop()

    return make


@pytest.mark.parametrize("name", OPTIONS)
def test_a_job_tells_how_far_it_is_and_writes_at_its_end(job_of, tmp_path, name):
    job = job_of(tmp_path / name)
    steps = []
    for step in job:
        assert not list(tmp_path.iterdir()), "written before its end"
        steps.append(step)
    shares = [step.fraction for step in steps]
    assert shares == sorted(shares) and shares[0] >= 0.0 and shares[-1] <= 1.0
    assert all(step.value is None for step in steps), "no search: it has no best so far"
    assert job.written.paths == (tmp_path / name,) and (tmp_path / name).stat().st_size > 1000
    stages = [stage for stage, _ in itertools.groupby(step.stage for step in steps)]
    assert [stage.split()[0] for stage in stages] == STAGES[name]


@pytest.mark.parametrize(
    ("name", "stage"), [(name, stage) for name, stages in STAGES.items() for stage in stages]
)
def test_stopped_at_any_stage_it_leaves_nothing(job_of, tmp_path, name, stage):
    job = job_of(tmp_path / name)
    for step in job:
        if step.stage.startswith(stage):
            job.stop()
    assert job.stopped, "it has no such stage"
    assert job.written is None and not list(tmp_path.iterdir())


def test_no_export_that_takes_long_begins_while_another_job_runs(small, monkeypatch, tmp_path):
    monkeypatch.setattr(running_job, "current", object())
    for name in OPTIONS:
        assert bpy.ops.pe.export_file(filepath=str(tmp_path / name)) == {"CANCELLED"}
    assert not list(tmp_path.iterdir())
    assert bpy.ops.pe.export_file(filepath=str(tmp_path / "study.toml")) == {"FINISHED"}
