"""``blender -b CAR.blend --command pe VERB``: files, exit status, and the engine's own numbers."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.blender.runner import output_of
from tests.limits import HANG_S

FAST = ("--samples", 4096)  # to be quick: all else is the same as on the whole grid
NUSCENES_IN_THE_WEATHER = """
import sys, bpy
start, saved, folder = sys.argv[-3:]
bpy.ops.wm.open_mainfile(filepath=start)
scene = bpy.context.scene
assert bpy.ops.pe.add_rig(key="nuscenes") == {"FINISHED"}
hood = bpy.data.objects["hood"]
for frame, angle in ((1, 0.0), (20, -0.3)):
    hood.rotation_euler.y = angle
    hood.keyframe_insert("rotation_euler", frame=frame)
for frame in (1, 20):
    scene.frame_set(frame)
    assert bpy.ops.pe.add_row(rows="states") == {"FINISHED"}
assert bpy.ops.pe.add_row(rows="weathers", kind="FOG") == {"FINISHED"}
bpy.ops.wm.save_as_mainfile(filepath=saved)  # with the hood open
assert bpy.ops.pe.export_file(filepath=folder + "/study.toml") == {"FINISHED"}
"""
SHORT_SCENARIO = """
[[scenario]]
name = "crossing_child"
speed_kmh = 30.0
[[scenario.body]]
name = "child"
body = "child"
path = [[-0.3, 0.0, -0.5], [0.0, 0.0, 0.0]]
"""


def document_in(stdout: str) -> dict:
    """Return the JSON document among the lines that Blender prints; numbers stay text."""
    start = re.search(r"^\{", stdout, re.MULTILINE)
    assert start, stdout
    return json.JSONDecoder(parse_float=str).raw_decode(stdout[start.start() :])[0]


def read(path: Path) -> dict:
    return json.loads(path.read_text("utf-8"))


def complaints_in(answer: subprocess.CompletedProcess[str]) -> list[str]:
    """Return the lines on stderr that are ours: Blender 5 begins its own with the time."""
    blenders = re.compile(r"\d\d:\d\d\.\d+ ")
    lines = answer.stderr.splitlines()
    return [line for line in lines if line.strip() and not blenders.match(line)]


def test_missing_file_is_one_line_and_status_1(installed, tmp_path):
    missing = tmp_path / "nowhere.blend"
    answer = installed.pe(missing, ["score", "--output", tmp_path])
    assert answer.returncode == 1, output_of(answer)
    assert len(complaints_in(answer)) == 1, output_of(answer)
    assert "Traceback" not in answer.stderr


def test_blender_and_engine_agree_to_the_last_bit(installed, sedan, tmp_path):
    inside = installed.pe(sedan, ["score", *FAST, "--json", "--output", tmp_path / "inside"])
    assert inside.returncode == 0, output_of(inside)
    exported = installed.pe(sedan, ["export", "--output", tmp_path / "study"])
    assert exported.returncode == 0, output_of(exported)
    (study,) = (tmp_path / "study").glob("*.toml")
    outside = alone("score", study, *FAST, "--json")
    assert document_in(inside.stdout)["entropy"] == outside["entropy"]
    assert isinstance(read(tmp_path / "inside" / "result.json")["entropy"], float)


def test_the_engine_in_blender_is_held_to_the_golden_cases_with_the_same_bits(installed, tmp_path):
    """Another Python, another NumPy and rewritten imports: the values are the same ones."""
    inside = installed.blender.run(
        [*installed.START, "-b", "--command", "pe", "verify", "-o", tmp_path]
    )
    assert inside.returncode == 0, output_of(inside)
    found = read(tmp_path / "verify.json")
    assert found["failed"] == 0 and found["passed"] >= 50 and "blender" in found["versions"]
    assert (tmp_path / "verify.html").is_file() and found["machine"]["system"]
    assert found["digests"]["results"] == alone("verify", "--json")["digests"]["results"]


def both_scores(installed, code, sedan, folder) -> tuple[dict, dict]:
    """What Blender and the engine alone say of a scene that a script saves and exports."""
    script = folder / "make.py"
    saved = folder / "made.blend"
    script.write_text(code, "utf-8")
    answer = installed.script(script, sedan, saved, folder)
    assert answer.returncode == 0, output_of(answer)
    inside = installed.pe(saved, ["score", *FAST, "--json"])
    assert inside.returncode == 0, output_of(inside)
    return document_in(inside.stdout), alone("score", folder / "study.toml", *FAST, "--json")


@pytest.mark.thorough
def test_radars_weathers_and_states_of_nuscenes_have_the_same_bits(installed, sedan, tmp_path):
    scored, outside = both_scores(installed, NUSCENES_IN_THE_WEATHER, sedan, tmp_path)
    assert scored["conditions"] == outside["conditions"] and scored["after"] == outside["after"]
    rows = scored["conditions"]["rows"]
    assert len(rows) == 2 and len({row["entropy"] for row in rows}) == 2
    assert sum(name.startswith("RADAR_") for name in scored["after"]["per_sensor"]) == 5


def alone(*arguments) -> dict:
    """What the engine alone prints, numbers as text."""
    command = [sys.executable, "-m", "pe_core", *map(str, arguments)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    assert answer.returncode == 0, output_of(answer)
    return document_in(answer.stdout)


@pytest.mark.thorough
def test_a_film_without_a_window_is_that_of_its_drive_by(installed, sedan, tmp_path):
    scenario = tmp_path / "scenario.toml"
    film = tmp_path / "film.webm"
    scenario.write_text(SHORT_SCENARIO)
    answer = installed.pe(sedan, ["check", "--scenarios", scenario, "-o", film, "--json"])
    assert answer.returncode in (0, 3), output_of(answer)
    data = film.read_bytes()
    assert data.startswith(b"\x1a\x45\xdf\xa3") and b"webm" in data[:64]
    (of,) = document_in(answer.stdout)["scenarios"]
    assert of["name"] == "crossing_child"
    assert b"perception-entropy " in data
    again = installed.pe(sedan, ["check", "--scenarios", scenario, "-o", film])
    assert again.returncode == 1 and film.read_bytes() == data, output_of(again)


@pytest.mark.thorough
def test_a_film_is_of_the_kind_that_its_name_says(installed, sedan, tmp_path):
    scenario = tmp_path / "scenario.toml"
    film = tmp_path / "film.mp4"
    scenario.write_text(SHORT_SCENARIO)
    answer = installed.pe(sedan, ["check", "--scenarios", scenario, "-o", film])
    assert answer.returncode in (0, 3), output_of(answer)
    assert b"ftyp" in film.read_bytes()[:16]
