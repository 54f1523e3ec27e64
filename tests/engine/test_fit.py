"""Fits of the AP curve: a and b, what is left out, bad tables."""

import math
import tomllib
from functools import partial

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_tools.formats import ApTable, fit_ap_curve, m_by_range, read_ap_table, study_snippet
from tests.engine.refusals import wrongly_refused

BAD = [
    ("file", ""),
    ("file", "# nothing\n"),
    ("file", b"\x89PNG\0\0"),
    ("line 1", "a,b\n1,2\n"),
    ("line 1", "m,m,ap\n1,2,0.5\n"),
    ("line 2", "m,ap\n1,0.5,3\n"),
    ("line 3", "m,ap\n1,0.5\n2,77.3\n"),
    ("line 2", "m,ap\n1,-0.1\n"),
    ("line 4", "m,ap\n\n# x\n1,nan\n"),
    ("line 2", "m,ap\n-1,0.5\n"),
    ("line 2", "m,ap\none,0.5\n"),
    ("line 2", "m,ap,n\n1,0.5,0\n"),
]
NO_CURVE = [
    ("points", ([], [])),
    ("points", ([1, 2], [0.5, 0.6])),
    ("points", ([0, 1, 2, 3], [0, 0.3, 0.5, 1.0])),
    ("m", ([1, 1, 1], [0.5, 0.6, 0.7])),
    ("ap", ([1, 2, 4], [0.7, 0.5, 0.2])),
]
RADAR = "Continental ARS408-21"
RANGES = (60.0, 80.0, 100.0, 120.0)


def table(m, ap, n=None):
    m = np.array(m, dtype=float)
    weights = np.ones(len(m)) if n is None else np.array(n, dtype=float)
    return ApTable(m, np.array(ap, dtype=float), weights)


def written(tmp_path, text):
    path = tmp_path / "ap.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_a_line_by_hand():
    """AP 0.2, 0.3, 0.5 at ln m = 0, 1, 2: slope 0.15 and 0.3333 in the middle, so 0.1833 at 0.

    Residuals 1/60, -2/60, 1/60: their squares sum to 1/600, over 3 - 2 points a variance of 1/600.
    Slope: its root over the root of 2, the spread of ln m; intercept: over that of 1/3 + 1/2.
    """
    fit = fit_ap_curve(table([1.0, math.e, math.e**2], [0.2, 0.3, 0.5]))
    assert fit.curve.a == pytest.approx(0.15, abs=1e-12)
    assert fit.curve.b == pytest.approx(0.55 / 3, abs=1e-12)
    assert fit.rms == pytest.approx(math.sqrt(1 / 1800), abs=1e-12)
    assert fit.a_error == pytest.approx(math.sqrt(1 / 1200), abs=1e-12)
    assert fit.b_error == pytest.approx(math.sqrt(1 / 720), abs=1e-12)
    assert fit.used.all() and fit.left_out == {}


def test_what_is_left_out_does_not_bend_the_line():
    """The same three points, and beside them one without a measurement and three at the clip."""
    m = [0.0, 0.01, 1.0, math.e, math.e**2, 100.0, 200.0]
    ap = [0.4, 0.001, 0.2, 0.3, 0.5, 0.999, 1.0]
    fit = fit_ap_curve(table(m, ap))
    assert fit.why == ("no measurement", "at the clip", "", "", "", "at the clip", "at the clip")
    assert fit.left_out == {"no measurement": 1, "at the clip": 3}
    assert (fit.curve.a, fit.curve.b) == pytest.approx((0.15, 0.55 / 3), abs=1e-12)


def test_errors_are_those_of_least_squares():
    """Against NumPy's own fit and its covariance."""
    rng = np.random.default_rng(3)
    m = np.geomspace(0.05, 5.0, 12)
    ap = 0.15 * np.log(m) + 0.6 + rng.normal(0.0, 0.02, len(m))
    fit = fit_ap_curve(table(m, ap), saturation=0.0)
    (a, b), covariance = np.polyfit(np.log(m), ap, 1, cov=True)
    assert (fit.curve.a, fit.curve.b) == pytest.approx((a, b))
    assert (fit.a_error, fit.b_error) == pytest.approx(np.sqrt(np.diag(covariance)))


def test_points_weigh_what_stands_behind_them():
    m = [0.1, 0.2, 0.4, 0.8]
    ap = [0.3, 0.4, 0.5, 0.9]
    twice = fit_ap_curve(table([*m, m[0]], [*ap, ap[0]]), saturation=0.0)
    weighed = fit_ap_curve(table(m, ap, [2, 1, 1, 1]), saturation=0.0)
    assert (weighed.curve.a, weighed.curve.b) == pytest.approx((twice.curve.a, twice.curve.b))
    assert weighed.rms == pytest.approx(twice.rms)


def test_what_is_saturated_is_left_out():
    m = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4]
    ap = [0.3, 0.45, 0.6, 0.75, 0.90, 0.91, 0.85]  # it levels out, then falls
    fit = fit_ap_curve(table(m, ap))
    assert list(fit.used) == [True] * 4 + [False] * 3
    assert fit.left_out == {"saturated": 3}
    assert fit.curve.a == pytest.approx(0.15 / math.log(2.0))


def test_the_snippet_is_part_of_a_study(tmp_path):
    fit = fit_ap_curve(table([1.0, math.e, math.e**2, math.e**3], [0.21, 0.33, 0.48, 0.62]))
    text = study_snippet(fit, "camera")
    sensor = '[[sensor]]\nname = "a"\nmodel = "Pandar64"\nposition = [0, 0, 2]\n'
    study = pe.load_study(written(tmp_path, text + sensor))
    # slope: (3 (0.62 - 0.21) + 0.48 - 0.33) / 10; intercept: 1.64 / 4 less 1.5 slopes
    assert (study.model.camera.a, study.model.camera.b) == (0.138, 0.203)
    assert text.startswith("# AP = a ln m + b, fitted to 4 of 4 points of table\n[ap.camera]\n")
    assert study.model.lidar == pe.PerceptionModel().lidar


def test_a_table_is_read_with_comments_columns_in_any_order_and_any_line_ends(tmp_path):
    text = "# AP of a detector\r\nclass, AP ,m\rcar,0.5,1\n\ncar,0.25,0.5\r\n"
    spreadsheet = f"sep=;\n{text.replace(',', ';')}".encode("utf-16")
    for each in (text, spreadsheet):
        read = read_ap_table(written(tmp_path, each))
        assert read.m.tolist() == [1.0, 0.5] and read.ap.tolist() == [0.5, 0.25]
        assert read.n.tolist() == [1.0, 1.0]


def test_a_wrong_table_is_refused_by_its_line(tmp_path):
    assert wrongly_refused(lambda text: read_ap_table(written(tmp_path, text)), BAD) == []


def test_tables_without_a_curve_are_refused():
    assert wrongly_refused(lambda v: fit_ap_curve(table(*v)), NO_CURVE) == []


def test_a_table_by_range_gives_the_curve_of_what_the_model_measures(tmp_path):
    """AP made of a known curve at the radar's own m by range: the fit finds the curve again."""
    m = m_by_range(catalog.load(RADAR), np.array(RANGES), "car")
    assert (np.diff(m) < 0.0).all() and m[-1] > 1.0
    rows = [f"{r},{0.3 * math.log(v) + 0.1}" for r, v in zip(RANGES, m.tolist(), strict=True)]
    (tmp_path / "radar.csv").write_text("\n".join(["range_m,ap", *rows]) + "\n")

    def fitted(name):
        of_model = partial(m_by_range, catalog.load(RADAR), class_name=name)
        found = fit_ap_curve(read_ap_table(tmp_path / "radar.csv", of_model))
        return tomllib.loads(study_snippet(found, "radar", name))["ap"]

    curve = fitted("car")["objects"]["radar"]["car"]
    assert (curve["a"], curve["b"]) == pytest.approx((0.3, 0.1), abs=1e-5)
    times = (4.6 + 1.9) * 1.7 / (2.0 * 0.1**2)
    assert fitted(None)["radar"]["b"] == pytest.approx(0.1 + 0.3 * math.log(times), abs=1e-4)
