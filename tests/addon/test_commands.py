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
from tests.addon import scenes
from tests.addon.command_line import FAST, complaints, run_alone, run_here
from tests.limits import HANG_S

AT = ("--at", "8", "2", "--json")
DRIVE = """
import sys, bpy
from os import _exit
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
curve = bpy.data.objects["body"].driver_add("location", 2)
curve.driver.type, curve.driver.expression = "SCRIPTED", "[0.9, frame][0]"
bpy.context.preferences.filepaths.use_scripts_auto_execute = True
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
_exit(0)  # bpy 4.5 would not end by itself
"""


@pytest.fixture
def blend(car, tmp_path) -> Path:
    scenes.add_sensor("front", model="Camera 60 deg")
    car.perception_entropy.interval = 0.5  # key figures are of all voxels
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


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
        answer = run_here(blend, ["serve"])
    assert answer.returncode == 0, answer.stderr
    wrong, scored, moved, asked = map(json.loads, answer.stdout.splitlines())
    assert (wrong["status"], scored["status"], moved["status"], asked["status"]) == (1, 0, 0, 0)
    alone = json.loads(run_here(blend, ["score", "--samples", "1024", "--json"]).stdout)
    assert scored["answer"]["after"] == alone["after"]
    assert scored["answer"]["run"]["versions"] == alone["run"]["versions"]
    assert moved["answer"]["sensors"]["front"]["position"] == [1.5, 0.0, 1.6]
    typed = run_here(blend, ["explain", "--set=sensor.front.position=[1.5, 0, 1.6]", *AT])
    assert asked["answer"] == json.loads(typed.stdout)
    assert blend.read_bytes() == before


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
    answer = run_here(tmp_path / name, ["score"])
    assert answer.returncode == 1
    (line,) = complaints(answer)
    assert line.startswith(f"pe: {tmp_path / name}: ") and found in line
    assert "Traceback" not in answer.stderr and not answer.stdout


def test_usage(blend):
    assert run_here(blend, ["score", "--no-such-option"]).returncode == 2
    assert main([]) == 2


def test_the_process_ends_though_the_file_has_a_driver_in_python(blend):
    """Plain bpy 4.5 hangs at its exit after it has evaluated one."""
    made = subprocess.run(
        [sys.executable, "-c", DRIVE, str(blend)], capture_output=True, timeout=HANG_S
    )
    assert made.returncode == 0, made.stderr
    answer = run_alone(blend, ["score", *FAST[:2], "--json"])
    assert answer.returncode == 0, answer.stderr
    assert json.loads(answer.stdout)["after"]["entropy"] > 0.0
