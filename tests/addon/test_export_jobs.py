"""Exports as jobs: steps with progress; stopped at any step they leave nothing behind."""

import itertools

import bpy
import pytest

from blender_addon.operators import export_files, export_job, running_job
from blender_addon.operators import export_files as exports
from tests.addon import scenes


@pytest.fixture
def small(car, small_pictures):
    """Return a scene that is scored fast and drawn in few pixels."""
    car.perception_entropy.score_samples = 1024
    return car


def page_job(path):
    """Return the job of a page, as the operator makes it."""
    told = {"command": "", "versions": {}}
    steps, about = exports.PE_OT_export_review.steps, exports.page.About()
    return export_job.ExportJob(scenes.study(), lambda job: steps(job, path, told, about))


def picture_job(path):
    """Return the job of a picture."""
    steps = exports.PE_OT_render_review.steps
    return export_job.ExportJob(scenes.study(), lambda job: steps(job, path))


def scene_job(path):
    """Return the job of an output of the scene."""
    row = export_files.outputs.scene_output("gltf")
    steps = export_files.PE_OT_export_scene.steps
    return export_job.ExportJob(scenes.study(), lambda job: steps(job, row, path, 5.0, False))


JOBS = {"page.html": page_job, "picture.png": picture_job, "scene.glb": scene_job}
STAGES = {
    "page.html": ["scoring", "page"],
    "picture.png": ["scoring", "picture"],
    "scene.glb": ["exporting"],
}


@pytest.mark.parametrize("name", JOBS)
def test_a_job_tells_how_far_it_is_and_writes_at_its_end(small, tmp_path, name):
    job = JOBS[name](tmp_path / name)
    steps = []
    for step in job:
        assert not list(tmp_path.iterdir()), "written before its end"
        steps.append(step)
    shares = [step.fraction for step in steps]
    assert shares == sorted(shares) and shares[0] >= 0.0 and shares[-1] <= 1.0
    assert all(step.entropy is None for step in steps), "no search: it has no best so far"
    assert job.written.paths == (tmp_path / name,) and (tmp_path / name).stat().st_size > 1000
    stages = [stage for stage, _ in itertools.groupby(step.stage for step in steps)]
    assert [stage.split()[0] for stage in stages] == STAGES[name]


@pytest.mark.parametrize(
    ("name", "stage"),
    [(name, stage) for name, stages in STAGES.items() for stage in stages],
)
def test_stopped_at_any_stage_it_leaves_nothing(small, tmp_path, name, stage):
    job = JOBS[name](tmp_path / name)
    for step in job:
        if step.stage.startswith(stage):
            job.stop()
    assert job.stopped, "it has no such stage"
    assert job.written is None and not list(tmp_path.iterdir())


def test_a_page_that_is_stopped_is_not_worked_on(small, tmp_path):
    job = page_job(tmp_path / "page.html")
    watch = job.watch(0.4)
    watch(0.5)
    job.stop()
    with pytest.raises(export_job.ExportStopped):
        watch(0.6)


def test_what_was_written_is_kept_for_the_panel(small, tmp_path):
    path = tmp_path / "study.toml"
    assert bpy.ops.pe.export_study(filepath=str(path)) == {"FINISHED"}
    assert (export_job.last.text, export_job.last.folder) == ("Wrote study.toml", tmp_path)
    bpy.ops.pe.export_scene(filepath=str(tmp_path / "a.glb"), output="gltf")
    assert export_job.last.paths == (tmp_path / "a.glb",)
    with pytest.raises(RuntimeError):
        bpy.ops.pe.export_study(filepath=str(path / "below" / "x.toml"))
    assert export_job.last.text == "Wrote a.glb", "what failed wrote nothing"
    assert bpy.ops.pe.open_folder.poll()
    bpy.ops.pe.dismiss_written()
    assert export_job.last is None and not bpy.ops.pe.open_folder.poll()


def test_no_export_begins_while_another_job_runs(small, monkeypatch):
    monkeypatch.setattr(running_job, "current", object())
    names = ("export_review", "render_review", "export_scene")
    assert not any(getattr(bpy.ops.pe, name).poll() for name in names)
