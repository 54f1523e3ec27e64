"""The example vehicle, as it is shipped."""

import json
import re
import shlex
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from blender_addon.engine import search
from pe_core.sensors import kind_of
from tests.addon import scenes
from tests.addon.command_line import run_here

TOOLS = scenes.ASSETS.parent / "tools"
sys.path.insert(0, str(TOOLS))
import demo_scene  # noqa: E402

ROOF_M = 1.45


@pytest.fixture
def study(addon):
    """The sedan with its roof LiDAR, evaluated on few voxels."""
    return replace(scenes.shipped_study("sedan"), samples=16_384)


def test_its_size_and_parts(study):
    low, high = study.vehicle.bounds
    assert low[[0, 2]] == pytest.approx([-2.35, 0.0], abs=2e-3)
    assert high[[0, 2]] == pytest.approx([2.35, ROOF_M], abs=2e-3)
    body = study.vehicle.parts == study.vehicle.part_names.index("body")
    assert np.ptp(study.vehicle.triangles[body][..., 1]) == pytest.approx(1.85, abs=2e-3)
    assert {"hood", "roof", "windshield", "wheel_front_left"} <= set(study.vehicle.part_names)
    assert "windshield" in study.vehicle.glass


def test_pandar64_scores_better_than_hdl64e_in_its_place(study):
    (sensor,) = study.rig
    assert sensor.model.name == "Pandar64"
    other = pe.Rig([replace(sensor, model=pe.catalog.load("HDL-64E"))])
    evaluator = study.evaluator()
    assert evaluator.entropy(study.rig) < evaluator.entropy(other) - 1.0


def test_the_demo_searches_by_default_for_a_lidar_and_a_camera(addon, tmp_path):
    """And ends with what was moved, what that is worth and costs, and the page to open."""
    demo_scene.make(start := tmp_path / "start.blend")
    rig = scenes.study().rig
    assert {kind_of(sensor).name for sensor in rig} == {"camera", "lidar"}
    script = (TOOLS / "demo.sh").read_text("utf-8")
    options = shlex.split(re.search(r"OPTIONS=\((.*?)\)", script, re.DOTALL)[1])
    few = ("--evaluations", "5", "--samples", "1024", "--grid-samples", "1024", "--workers", "1")
    more = ("--no-review", "--output", tmp_path)
    answer = run_here(start, "optimize", *options, *few, *more)
    assert answer.returncode == 0, answer.stderr
    result = json.loads((tmp_path / "result.json").read_text("utf-8"))
    assert result["method"] == search.DEFAULT_METHOD
    (tmp_path / "review.html").touch()
    command = [sys.executable, TOOLS / "show_result.py", tmp_path]
    moved, better, opened = subprocess.check_output(command, text=True).splitlines()
    assert all(sensor.name in moved for sensor in rig)
    assert result["cost"] in better
    assert opened.split()[1] == str(tmp_path / "review.html")


def test_the_best_height_lies_above_the_roof_unprompted(study):
    schedule = pe.Schedule(candidates=12)
    search = replace(study.search, samples=4096, schedule=schedule, method="random")
    job = pe.OptimizeJob(replace(study, search=search, samples=4096), 1)
    for _ in job:
        pass
    outcome = job.outcome
    assert outcome.after.entropy < outcome.before.entropy
    assert outcome.study.rig.sensors[0].pose.position[2] >= ROOF_M
