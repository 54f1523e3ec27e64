"""`pe verify`: all golden cases are right, a changed kernel is noticed, and what it writes."""

import html
import json
from collections import Counter
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from pe_core import metric
from pe_core.geometry import poses
from pe_core.metric import entropy, fusion
from pe_core.scene import Vehicle
from pe_core.search.methods import portfolio_steps
from pe_core.sensors.camera import definition as camera
from pe_core.sensors.lidar import definition as lidar
from pe_core.sensors.radar import definition as radar
from pe_core.sensors.ultrasonic import kind as ultrasonic
from pe_tools import known_defects
from pe_tools.cli.verbs import main
from pe_tools.verify import verification, verifying
from pe_tools.verify.golden import golden_cases
from pe_tools.verify.golden_case import BASES, BY_HAND, GoldenCase

OURS = "0.0.1"
DOCS = Path(known_defects.__file__).parent.parent / "docs"
MADE_UP = """
[[defect]]
id = "made-up"
first = "0.0.1"
fixed = "0.1.0"
touches = ["requirements"]
what = "a made-up defect"
link = "results.md"
"""

KERNELS = (
    "AP",
    "late fusion",
    "entropy of a plane",
    "rotation",
    "beams through cubes",
    "pixel area",
    "first hits",
    "radar cells",
    "ultrasonic cone",
    "steps of a search",
)


def scaled(by):
    """What changes a function so that it returns so many times its value."""
    return lambda kernel: lambda *args, **kwargs: kernel(*args, **kwargs) * by


def farther(first_hit):
    def changed(*args, **kwargs):
        hits = first_hit(*args, **kwargs)
        hits.distance[:] *= 1.001
        return hits

    return changed


def turned(rotation_matrix):
    return lambda roll, pitch, yaw: rotation_matrix(roll, -pitch, yaw)


def negated(found):
    return lambda *args, **kwargs: ~np.asarray(found(*args, **kwargs))


def changes():
    """Ten kernels: where each is looked up, and how it is changed."""
    return {
        "AP": (entropy, "average_precision", scaled(1.0 + 1e-6)),
        "late fusion": (metric, "late_fusion", scaled(1.0 + 1e-6)),
        "entropy of a plane": (fusion, "entropy_of", scaled(1.0 + 1e-5)),
        "rotation": (poses, "rotation_matrix", turned),
        "beams through cubes": (lidar, "cube_crossing", lambda f: lambda *a: f(*a)[::-1]),
        "pixel area": (camera, "clipped_pixel_area", scaled(1.0001)),
        "first hits": (Vehicle, "first_hit", farther),
        "radar cells": (radar, "cells_of", scaled(1.1)),
        "ultrasonic cone": (ultrasonic, "in_cone", negated),
        "steps of a search": (portfolio_steps, "BATCH", lambda batch: batch + 1),
    }


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("verify")
    return main(["verify", "-o", str(folder)]), folder


def test_all_cases_are_right_and_told(report):
    status, folder = report
    data = json.loads((folder / "verify.json").read_text())
    schema = json.loads((DOCS / "schemas" / "answers-1.schema.json").read_text())
    jsonschema.validate({"verify": data}, schema)
    assert (status, data["failed"], data["passed"]) == (0, 0, len(golden_cases()))
    assert data["versions"]["perception-entropy"] and data["machine"]["system"]
    assert len(data["digests"]["code"]) == len(data["digests"]["results"]) == 16
    page = html.unescape((folder / "verify.html").read_text())
    assert all(each.name in page for each in golden_cases())
    assert [each["id"] for each in data["known_defects"]] == [
        each.id for each in known_defects.known_defects()
    ]


def test_cases_have_names_of_their_own_and_are_hardly_ever_copied():
    cases = golden_cases()
    assert len({each.name for each in cases}) == len(cases) >= 50
    count = Counter(each.basis for each in cases)
    assert set(count) == set(BASES) and count["stored"] == 2


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_changed_kernel_is_noticed(kernel, monkeypatch):
    place, name, change = changes()[kernel]
    monkeypatch.setattr(place, name, change(getattr(place, name)))
    assert any(not each.passed for each in verifying())


def test_a_wrong_case_has_its_line_and_status_3(monkeypatch, capsys, tmp_path):
    def unable():
        raise ValueError("no kernel")

    cases = (
        GoldenCase("right", "a", BY_HAND, "", right=[1.0, 2.0], found=lambda: [1.0, 2.0]),
        GoldenCase("wrong", "a", BY_HAND, "", right=[1.0, 2.0], found=lambda: [1.0, 2.5]),
        GoldenCase("not a number", "a", BY_HAND, "", right=[1.0], found=lambda: [float("nan")]),
        GoldenCase("fewer", "b", BY_HAND, "", right=[1.0, 2.0], found=lambda: [1.0]),
        GoldenCase("unable", "b", BY_HAND, "", right=[1.0], found=unable),
        GoldenCase("text", "b", BY_HAND, "", right="abc", found=lambda: "abd"),
    )
    monkeypatch.setattr(verification, "golden_cases", lambda: cases)
    assert main(["verify", "--json", "-o", str(tmp_path)]) == 3
    data = json.loads(capsys.readouterr().out)
    assert data == json.loads((tmp_path / "verify.json").read_text())
    assert [each["passed"] for each in data["cases"]] == [True] + 5 * [False]
    told = [each["wrong"] for each in data["cases"]]
    assert "2.5" in told[1] and "nan" in told[2] and "no kernel" in told[4] and "abd" in told[5]


@pytest.mark.parametrize(
    ("made", "touched", "told"),
    [(OURS, True, True), (OURS, False, False), ("0.1.0", True, False), ("", True, False)],
)
def test_a_result_that_a_mended_defect_touches_says_so(
    made, touched, told, monkeypatch, capsys, tmp_path
):
    """A made-up row: fixed by 0.1.0, in results with requirements of the version before."""
    table = tmp_path / "defects.toml"
    table.write_text(MADE_UP)
    monkeypatch.setattr(known_defects, "TABLE", table)
    known_defects.known_defects.cache_clear()
    study = tmp_path / "study.toml"
    study.write_text(
        'samples = 1024\n[[sensor]]\nname = "a"\nmodel = "Pandar64"\nposition = [0, 0, 2]\n'
    )
    result = {"run": {"versions": {"perception-entropy": made}}, "requirements": [1] * touched}
    (tmp_path / "result.json").write_text(json.dumps(result))
    try:
        assert main(["score", str(study)]) == 0
        assert ("a made-up defect" in capsys.readouterr().err) is told
    finally:
        known_defects.known_defects.cache_clear()
