"""``pe fit``: what it prints, writes and refuses."""

import json
import subprocess
import sys
import tomllib

import pytest

from tests.report.conftest import ROOT, pe

TABLE = ROOT / "pe_report" / "data" / "paper_lidar.csv"
LINE = """m,ap
0.01,0.001
1,0.2
2.718281828459045,0.3
7.38905609893065,0.5
"""
"""AP 0.2, 0.3, 0.5 at ln m = 0, 1, 2, and a point at the clip: the line has a slope of 0.15 and is
0.55 / 3 at 0. Residuals 1/60, -2/60, 1/60: errors sqrt(1 / 1200) and sqrt(1 / 720)."""


def test_it_prints_the_curve_what_was_left_out_and_the_snippet(tmp_path):
    (tmp_path / "line.csv").write_text(LINE)
    run = pe("fit", tmp_path / "line.csv")
    assert run.returncode == 0 and not run.stderr
    assert "a  0.1500 +- 0.0289" in run.stdout and "b  0.1833 +- 0.0373" in run.stdout
    assert "points  3 of 4; left out: 1 at the clip" in run.stdout
    assert "[ap.lidar]" in run.stdout


def test_it_writes_a_snippet_and_a_plot(tmp_path):
    (tmp_path / "line.csv").write_text(LINE)
    run = pe("fit", tmp_path / "line.csv", "--kind", "camera", "--output", tmp_path / "new")
    assert run.returncode == 0
    curve = tomllib.loads((tmp_path / "new" / "ap.toml").read_text("utf-8"))["ap"]["camera"]
    assert curve == {"a": 0.15, "b": 0.183333}
    assert (tmp_path / "new" / "ap.png").read_bytes().startswith(b"\x89PNG")


def test_json_is_all_there_is_on_stdout():
    data = json.loads(pe("fit", TABLE, "--json").stdout)
    assert data["a"] > 0.0 and len(data["left_out"]) == len(data["m"]) == 12


@pytest.mark.parametrize("name", ["car", "pedestrian", "cyclist"])
def test_public_detections_have_a_curve(name):
    data = json.loads(pe("fit", TABLE.with_name(f"kitti_{name}.csv"), "--json").stdout)
    assert 0.1 < data["a"] < 0.3 and data["a_error"] < data["a"] / 2


def test_a_wrong_table_is_one_line_and_status_1(tmp_path):
    table = tmp_path / "ap.csv"
    table.write_text("m,ap\n1,0.5\n2,60\n")
    run = pe("fit", table)
    assert run.returncode == 1 and not run.stdout
    assert run.stderr == f"pe: {table}: line 3: expected ap between 0 and 1, found 60.0\n"


def test_without_matplotlib_the_line_says_what_to_install(tmp_path):
    code = (
        "import sys; sys.modules['matplotlib'] = None; from pe_core.app.cli import main; "
        f"sys.exit(main(['fit', {str(TABLE)!r}, '-o', {str(tmp_path)!r}]))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 1
    assert "matplotlib" in run.stderr and "[report]" in run.stderr and run.stderr.count("\n") == 1
