"""``python -m blender_addon FILE VERB`` as a user runs it, against ``python -m pe_core``."""

import io
import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

from blender_addon.__main__ import main
from blender_addon.engine import jobs
from tests.addon import scenes
from tests.addon.command_line import FAST, complaints, pe_here, run_alone, run_here
from tests.limits import HANG_S

AT = ("--at", "8", "2", "--json")
DRIVE = """
import os, sys, bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
curve = bpy.data.objects["body"].driver_add("location", 2)
curve.driver.type, curve.driver.expression = "SCRIPTED", "[0.9, frame][0]"
bpy.context.preferences.filepaths.use_scripts_auto_execute = True
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
os._exit(0)  # bpy 4.5 would not end by itself
"""


def without_run(path: Path) -> dict:
    data = json.loads(path.read_text("utf-8"))
    del data["run"]
    return data


@pytest.fixture
def blend(car, tmp_path) -> Path:
    scenes.add_sensor("front", model="Camera 60 deg")
    car.perception_entropy.interval = 0.5  # key figures are of all voxels
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def test_explain_says_what_it_says_without_blender(blend, tmp_path):
    assert run_here(blend, "export", "-o", tmp_path / "study").returncode == 0
    study = tmp_path / "study" / "study.toml"
    for asked in (("--samples", "4096"), ("--at", "8", "2"), ("--at", "8", "2", "1", "--json")):
        inside = run_here(blend, "explain", *asked)
        outside = pe_here("explain", study, *asked)
        assert inside.stdout == outside.stdout and inside.stdout, inside.stderr
        assert inside.returncode == outside.returncode == 0


def test_a_session_begins_with_the_scene_and_has_the_command_s_bits(blend, monkeypatch):
    """Replies go to stdout alone; what is wrong ends nothing, and the file stays as it is."""
    requests = [
        {"id": 1, "do": "fly"},
        {"id": 2, "do": "score", "samples": 1024},
        {"id": 3, "do": "move", "sensor": "front", "position": [1.5, 0, 1.6]},
        {"id": 4, "do": "explain", "at": [8, 2]},
    ]
    before = blend.read_bytes()
    stdin = SimpleNamespace(buffer=io.BytesIO("\n".join(map(json.dumps, requests)).encode()))
    with monkeypatch.context() as patched:
        patched.setattr(sys, "stdin", stdin)
        answer = run_here(blend, "serve")
    assert answer.returncode == 0, answer.stderr
    wrong, scored, moved, asked = map(json.loads, answer.stdout.splitlines())
    assert (wrong["status"], scored["status"], moved["status"], asked["status"]) == (1, 0, 0, 0)
    alone = json.loads(run_here(blend, "score", "--samples", "1024", "--json").stdout)
    assert scored["answer"]["after"] == alone["after"]
    assert scored["answer"]["run"]["versions"] == alone["run"]["versions"]
    assert moved["answer"]["sensors"]["front"]["position"] == [1.5, 0.0, 1.6]
    typed = run_here(blend, "explain", "--set=sensor.front.position=[1.5, 0, 1.6]", *AT)
    assert asked["answer"] == json.loads(typed.stdout)
    assert blend.read_bytes() == before


def test_optimize_and_export_agree_with_the_engine(blend, tmp_path, all_errors):
    inside, study, outside = (tmp_path / name for name in ("inside", "study", "outside"))
    before = blend.read_bytes()
    answer = run_alone(blend, "optimize", "--no-review", *FAST, "-o", inside, "--json")
    assert answer.returncode == 0, answer.stderr
    assert json.loads(answer.stdout)["run"]["versions"]["blender"] == bpy.app.version_string
    assert blend.read_bytes() == before
    assert run_here(blend, "export", "-o", study).returncode == 0
    answer = pe_here("optimize", "--no-review", study / "study.toml", *FAST, "-o", outside)
    assert answer.returncode == 0, answer.stderr
    assert without_run(inside / "result.json") == without_run(outside / "result.json")
    for name in ("history.csv", "study.toml"):
        assert (inside / name).read_bytes() == (outside / name).read_bytes(), name
    check_optimized_scene(inside)
    check_resumed(blend, inside)


def check_resumed(blend: Path, folder: Path) -> None:
    """The search goes on from a state that a kill would leave, to the same result."""
    whole = without_run(folder / "result.json")
    begun = jobs.read_search(folder)
    state = jobs.SearchState(begun.study, begun.inputs)
    state.save(folder, begun.study, {"": begun.evaluated[:5]})
    answer = run_here(blend, "optimize", "--no-review", *FAST, "--resume", folder)
    assert answer.returncode == 0, answer.stderr
    assert complaints(answer) == ["pe: going on after 5 placements"]
    assert without_run(folder / "result.json") == whole


def check_optimized_scene(folder: Path) -> None:
    """The scene that was left holds the placements that were found."""
    bpy.ops.wm.open_mainfile(filepath=str(folder / "optimized.blend"))
    result = without_run(folder / "result.json")
    for name, placed in result["placements"]["after"].items():
        pose = scenes.study().rig[name].pose
        assert [list(pose.position), list(pose.rotation_deg)] == list(placed.values())
    assert [p.name for p in folder.glob(".*")] == [".perception-entropy.json"]


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("missing.blend", "no such file"),
        ("text.blend", "expected a .blend file"),
        ("plain.blend", "neither"),
    ],
)
def test_bad_file_is_one_line_and_status_1(addon, tmp_path, name, found):
    (tmp_path / "text.blend").write_text("no blend file")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "plain.blend"))
    answer = run_here(tmp_path / name, "score")
    assert answer.returncode == 1
    (line,) = complaints(answer)
    assert line.startswith(f"pe: {tmp_path / name}: ") and found in line
    assert "Traceback" not in answer.stderr and not answer.stdout


def test_usage(blend):
    assert run_here(blend, "score", "--no-such-option").returncode == 2
    assert main([]) == 2


def test_the_process_ends_though_the_file_has_a_driver_in_python(blend):
    """Plain bpy 4.5 hangs at its exit after it has evaluated one."""
    made = subprocess.run(
        [sys.executable, "-c", DRIVE, str(blend)], capture_output=True, timeout=HANG_S
    )
    assert made.returncode == 0, made.stderr
    answer = run_alone(blend, "score", *FAST[:2], "--json")
    assert answer.returncode == 0, answer.stderr
    assert json.loads(answer.stdout)["after"]["entropy"] > 0.0
