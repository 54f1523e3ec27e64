"""``pe fit``: what it prints, writes and refuses."""

import math
import tomllib

import numpy as np
import pytest

from pe_core import catalog
from pe_tools.formats import m_by_range
from tests.engine.processes import pe

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


RADAR, RANGES = "Continental ARS408-21", (60.0, 80.0, 100.0, 120.0)


def test_a_table_by_range_gives_the_curve_of_what_the_model_measures(tmp_path):
    """AP made of a known curve at the radar's own m by range: the fit finds the curve again."""
    m = m_by_range(catalog.load(RADAR), np.array(RANGES), "car")
    assert (np.diff(m) < 0.0).all() and m[-1] > 1.0
    rows = [f"{r},{0.3 * math.log(v) + 0.1}" for r, v in zip(RANGES, m.tolist(), strict=True)]
    (tmp_path / "radar.csv").write_text("\n".join(["range_m,ap", *rows]) + "\n")
    run = pe("fit", tmp_path / "radar.csv", "--model", RADAR, "--object", "car")
    assert run.returncode == 0 and not run.stderr
    curve = tomllib.loads(run.stdout[run.stdout.index("#") :])["ap"]["radar"]["objects"]["car"]
    assert (curve["a"], curve["b"]) == pytest.approx((0.3, 0.1), abs=1e-5)
    plain = pe("fit", tmp_path / "radar.csv", "--model", RADAR)
    of_voxels = tomllib.loads(plain.stdout[plain.stdout.index("#") :])["ap"]["radar"]
    times = (4.6 + 1.9) * 1.7 / (2.0 * 0.1**2)
    assert of_voxels["b"] == pytest.approx(0.1 + 0.3 * math.log(times), abs=1e-4)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ((), "r.csv: line 1: "),
        (("--model", "no such"), "such as Pandar64"),
        (("--model", RADAR, "--kind", "camera"), "kind: expected radar, the kind of Continental"),
        (("--model", RADAR, "--object", "dog"), "object: expected one of car, pedestrian"),
    ],
)
def test_wrong_options_of_a_table_by_range_are_one_line(tmp_path, options, line):
    (tmp_path / "r.csv").write_text("range_m,ap\n10,0.5\n20,0.4\n30,0.3\n")
    run = pe("fit", tmp_path / "r.csv", *options)
    assert run.returncode == 1 and line in run.stderr and run.stderr.count("\n") == 1
