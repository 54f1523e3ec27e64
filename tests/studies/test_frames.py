"""One frame and five: scenes in motion, voxels of frames, verdicts from runs."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from studies.detectors.analysis import UNDECIDED
from studies.detectors.batches import voxel_inputs
from studies.detectors.casting import LAYERS, FramesCaster, MovingScenes
from studies.detectors.frames import (
    ALIKE,
    BETTER,
    MORE,
    WORSE,
    difference_verdict,
    every_q,
    frame_scorer,
    frames_analysis,
    key_of,
    page,
)
from studies.detectors.placements import frames_placements, vehicle
from studies.detectors.plan import full_frames_plan, quick_frames_plan, shape_of
from studies.detectors.runs import frames_runs
from studies.detectors.scenes import CLASSES
from studies.detectors.scores import SPACE
from tests.studies.conftest import study
from tests.studies.test_detectors import COARSE, in_a_process

FOLDER = Path(__file__).parents[2] / "docs/validity/own/frames"
DIGEST = "013db2ab2a2f4774"
"""Of the plan as it was before its first run."""


def test_the_plan_is_the_one_before_the_first_run():
    plan = full_frames_plan()
    assert plan.digest == DIGEST
    names = [run.name for run in frames_runs(plan)]
    assert len(set(names)) == 48 and names[0] == "frames-sedan-01-s1"
    assert all(name.endswith("-s1") for name in names[:24])


def test_bodies_move_at_the_speed_of_their_class_and_the_vehicle_drives_on():
    plan = full_frames_plan()
    scenes = MovingScenes(plan)
    first, last = (scenes(plan, "sedan", "test", "", 5 * 3 + k) for k in (0, 4))
    moving = scenes.moving("sedan", "test", 3)
    assert last.centers == pytest.approx(moving.objects.feet[:, :2])
    own = moving.own_speed * np.array([0.4, 0.0])
    assert first.centers == pytest.approx(last.centers - 0.4 * moving.velocities + own)
    speeds = np.hypot(*moving.velocities.T)
    names = np.array(moving.objects.names)
    assert (speeds[names == "cone"] == 0.0).all() and 1.0 < speeds.max() <= 20.0
    coming = (moving.objects.yaws == 0.0) & (speeds > 0.0)
    left = moving.objects.feet[coming, 1] > plan.frames.motion.oncoming_y_m
    assert ((moving.velocities[coming, 0] < 0.0) == left).all()


def test_points_of_what_stands_fall_on_it_in_all_frames():
    """Own motion is taken out: at rest in the world, the wall is where it is in each frame."""
    plan = full_frames_plan()
    still = plan.but(frames={"motion": {"moving": dict.fromkeys(plan.frames.motion.moving, 0)}})
    caster = FramesCaster(still, frames_placements(plan)[1])
    one, five = caster.voxels("train", 2)
    nx, ny = shape_of(plan.region)
    both = voxel_inputs([five], plan.region, [(False, False)])[0]
    alone = voxel_inputs([one], plan.region, [(False, False)])[0]
    assert both.shape == (nx, ny, 2 * LAYERS) and (both[..., :LAYERS] == alone).all()
    assert (five.beams >= one.beams).all() and five.beams.sum() > 3 * one.beams.sum()
    # above the ground, what the last frame saw the earlier ones saw near by
    now = both[..., 4:LAYERS].any(axis=2)
    before = both[..., LAYERS + 4 :].any(axis=2)
    near = np.zeros_like(before)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            near |= np.roll(before, (i, j), (0, 1))
    assert near[now].mean() > 0.9


def test_verdicts_are_by_the_plan():
    assert difference_verdict(0.01, 0.02, 0.05) == BETTER
    assert difference_verdict(-0.2, -0.01, 0.05) == WORSE
    assert difference_verdict(-0.02, 0.04, 0.05) == ALIKE
    assert difference_verdict(0.0, 0.0, 0.05) == ALIKE
    assert difference_verdict(-0.02, 0.1, 0.05) == UNDECIDED


def made_up_results(plan, score_of):
    """Results whose AP with five frames follows a figure, and with one another one."""
    results = {}
    scores = {}
    for k, placement in enumerate(frames_placements(plan)):
        scores[placement.name] = score_of(k)
    for run in frames_runs(plan):
        k = int(run.placement.name[-2:])
        seed = run.seed

        def found(ap):
            by_class = dict.fromkeys(CLASSES, ap)
            ended = {"converged": ap < 0.5}
            return {"ap": ap, "by_class": by_class, "training": ended}

        results[run.name] = {**found(0.5 + 0.02 * k + 0.001 * seed), "one_frame": found(0.4)}
    return results, scores


def test_figures_come_when_all_runs_are_there():
    plan = full_frames_plan().but(statistics={"permutations": 199, "resamples": 200})
    keys = [key_of(q) for q in every_q(plan)]
    rng = np.random.default_rng(1)

    def score_of(k):
        return {key: rng.normal() if key == keys[0] else -0.1 * (k // 2) for key in keys}

    results, scores = made_up_results(plan, score_of)
    some = dict(list(results.items())[:-1])
    assert frames_analysis(plan, some, {}) == {"runs": {"done": 47, "planned": 48}, "ranks": None}
    found = frames_analysis(plan, results, scores)
    assert found["ranks"][key_of(1.0)]["five"]["rho"] == pytest.approx(1.0)
    assert found["ranks"][key_of(1.0)]["five"]["verdict"] == "holds"
    assert found["minus_one"][key_of(1.0)]["verdict"] == BETTER
    assert found["gain"]["verdict"] == MORE
    assert found["converged"] == [48, 0]
    text = page(plan, found)
    assert "ranks better than that of one frame" in text and "nan" not in text


@pytest.mark.thorough
def test_one_frame_and_infinite_noise_are_the_papers_entropy():
    plan = quick_frames_plan()
    placement = frames_placements(plan)[0]
    scored = frame_scorer(plan)(plan, "sedan", placement.rig())
    assert scored[key_of(10.0)] < scored[key_of(np.inf)]
    assert scored[key_of(0.1)] < scored[key_of(1.0)] < scored[key_of(10.0)]
    paper = pe.Evaluator(SPACE, pe.Prior.road(), vehicle("sedan")).entropy(placement.rig())
    assert scored[key_of(np.inf)] == paper


def test_the_page_of_the_docs_is_that_of_its_runs(tmp_path):
    shutil.copytree(FOLDER, tmp_path / "frames")
    run = study("detectors.frames", "--page-only", "-o", tmp_path / "frames")
    assert run.returncode == 0, run.stderr
    for name in ("README.md", "results.json"):
        assert (tmp_path / "frames" / name).read_bytes() == (FOLDER / name).read_bytes()


@pytest.mark.trains_detectors
def test_the_quick_study_runs_whole(tmp_path):
    script = "import runpy; runpy.run_module('studies.detectors.frames', run_name='__main__')"
    said = in_a_process(COARSE + script, "--quick", "--output", tmp_path / "out")
    assert "told without a verdict" in said.lower()
    kept = json.loads((tmp_path / "out/runs/frames-sedan-01-s1.json").read_text("utf-8"))
    assert 0.0 <= kept["one_frame"]["ap"] <= 1.0 and kept["one_frame"]["training"]["epochs"] == 2
