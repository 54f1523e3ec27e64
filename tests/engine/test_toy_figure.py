"""A figure is one row: a toy one is found wherever figures are read."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from tests.engine import shapes

ROOT = Path(__file__).parents[2]
ROW = """    Figure(
        "droop",
        "Droop",
        "deg",
        "How far the first sensor looks down",
        of=lambda view: (abs(view.rig.sensors[0].pose.rotation_deg[1]),),
        rule=Number(0.0, unit="deg"),
    ),
"""
PITCH_DEG = 4.0
FRONT = 'optimize.front.objectives=["droop","entropy"]'


@pytest.fixture(scope="module")
def toys(tmp_path_factory):
    """A copy of the program with one more row, and a study with a limit on its figure."""
    folder = tmp_path_factory.mktemp("toys")
    for name in ("pe_core", "pe_tools"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    rows = folder / "pe_core" / "search" / "figures.py"
    rows.write_text(rows.read_text("utf-8").replace("_SIGHT = (\n", f"_SIGHT = (\n{ROW}"), "utf-8")
    pose = pe.Pose.from_degrees((0.0, 0.0, 1.6), (0.0, PITCH_DEG, 0.0))
    rig = pe.Rig([pe.Sensor("roof", shapes.small_lidar(4, 90), pose)])
    search = pe.Search({"roof": ("z", "pitch")}, samples=1024, evaluations=20)
    given = {"search": search, "samples": 1024}
    study = shapes.car_study(rig, **given)
    pt.export_study(study, folder / "study.toml")
    text = (folder / "study.toml").read_text("utf-8")
    limit = "[limits]\ndroop = { value = 3, kept = false }\n\n[optimize]\n"
    (folder / "study.toml").write_text(text.replace("[optimize]\n", limit, 1), "utf-8")
    return folder


def run(folder, arguments):
    """Run `pe` of the copy; return what it prints."""
    command = [sys.executable, "-m", "pe_tools", *arguments.split()]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    return done.stdout


def test_a_score_has_it_with_its_limit(toys):
    data = json.loads(run(toys, "score study.toml --json"))
    assert data["figures"]["after"]["values"]["droop"] == pytest.approx(PITCH_DEG)
    (row,) = (row for row in data["dashboard"] if row["figure"] == "droop")
    assert (row["wanted"], row["met"], row["kept"]) == (3.0, False, False)


def test_it_is_compared(toys):
    table = run(toys, "compare study.toml study.toml")
    assert "Droop [deg], lower is better" in table


def test_a_search_keeps_it_and_a_front_has_it(toys):
    kept = run(toys, "optimize study.toml --set limits.droop=4 --workers 1 --json")
    data = json.loads(kept)
    assert data["figures"]["after"]["values"]["droop"] <= PITCH_DEG + 1e-6
    run(toys, f"optimize study.toml --set {FRONT} --workers 1 -o out")
    front = json.loads((toys / "out" / "front.json").read_text("utf-8"))
    assert all("droop" in design["figures"] for design in front["designs"])
    assert "Droop" in (toys / "out" / "front.html").read_text("utf-8")
