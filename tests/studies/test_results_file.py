"""A damaged results.json, or a place that cannot be written: one line each, and no page."""

import copy
import json
import random

import pytest

from pe_core import InputError
from studies.paper import reproduce
from studies.paper.page import page
from studies.paper.plan import FULL, QUICK, scores_and_figures
from studies.paper.reproduce import check_value, read_results
from studies.paper.result_view import ReproductionResults
from studies.results_file import ResultsFile
from tests.studies.conftest import ROOT, study
from tests.thorough import THOROUGH

DOCS = ROOT / "docs" / "reproduction"
COMMITTED = json.loads((DOCS / "results.json").read_text("utf-8"))
NOT_JSON = {
    "empty": b"",
    "cut off": (DOCS / "results.json").read_bytes()[:20_000],
    "no text": b"\xff\xfe\x00\x01\x80",
    "a list": b"[]",
    "NaN": b'{"schema": NaN}',
    "infinity": b'{"schema": -Infinity}',
    "deep": b"[" * 100_000,
    "deep objects": b'{"a":' * 100_000,
    "5,000 digits": b'{"schema": ' + b"9" * 5000 + b"}",
    "another shape": b'{"schema": 1, "claims": [], "made": [], "results": 3}',
    "another result": b'{"schema": 2, "kind": "optimize", "seed": 0}',
}

ONE = {"entropy": 1.0, "alone": {"lidar_a": 1.0, "lidar_b": 1.0}}
PITCH = "results/pitch|0/value/"
SEARCH = "results/search|3_front|road|front|2/value/"
CHANGES = {
    "schema": 2,
    "made": None,
    "made/commit": "a\nb",
    "made/machine": "a | b",
    "made/numpy": "\x1b[31m",
    "made/python": "\u202eevil",
    "made/effort": {},
    "made/effort/pitch_step_deg": 1e-300,
    "made/effort/rows": [["nothing", "road"]],
    "claims": [],
    "claims/0/holds": False,
    "claims/0/better_entropy": 1.0,
    "results": [],
    "results/pitch|0": {},
    "results/pitch|0/seconds": -1.0,
    PITCH.rstrip("/"): "none",
    PITCH + "entropy": "5.1",
    f"{PITCH}entropy ": 5.1,
    PITCH + "alone": {},
    PITCH + "alone/lidar_c": 1.0,
    PITCH + "alone/lidar_a": True,
    PITCH + "alone/lidar_b": 1e999,
    "results/printed|4_cameras|uniform/value/entropy": 10**400,
    "results/printed|1_hdl64e|road/value/coverage": 0.0,
    "results/printed|1_hdl64e|road/value/per_class": [1.0],
    "results/bound|2_60deg|road/value/farthest_m": None,
    "results/bound_curve|30/value/entropy": [1.0],
    "results/prior|road/value/classes": ["$\\frac{$"] * 2 + ["\x07"],
    "results/prior|road/value/ground": [[1.0], [1.0, 2.0]],
    "results/fit|kitti_car/value/m": [0.0] * 9,
    "results/fit|kitti_car/value/left_out": [""],
    "results/vary|no vehicle|1_hdl64e/value/coverage": "all",
    SEARCH + "placements": {},
    SEARCH + "placements/lidar_b/position": [1.0, 2e9, 1.0],
    SEARCH + "placements/lidar_a/position": [1.0, 2.0],
    SEARCH + "placements/lidar_b/rotation": [1.0, 2.0, float("1e300")],
    "results/pitch|0.001": {"value": ONE, "seconds": 1.0},
    "results/nothing": {"value": {}, "seconds": 1.0},
    "results/search|none|road|front|0": {"value": {}, "seconds": 1.0},
}
"""What stands in results.json in place of what is right, by its place."""


def changed(place, value):
    data = copy.deepcopy(COMMITTED)
    *folders, last = place.split("/")
    at = data
    for key in folders:
        at = at[int(key) if isinstance(at, list) else key.replace("|", "/")]
    at[last.replace("|", "/")] = value
    return data


def refused(path):
    with pytest.raises(InputError) as error:
        read_results(path)
    line = str(error.value)
    assert line.startswith(str(path)) and line.isprintable() and len(line) < 400
    return line


@pytest.mark.parametrize("name", NOT_JSON)
def test_what_is_no_results_file_is_refused_in_one_line(tmp_path, name):
    path = tmp_path / "results.json"
    path.write_bytes(NOT_JSON[name])
    refused(path)


@pytest.mark.parametrize("place", CHANGES)
def test_every_field_is_checked_and_named(tmp_path, place):
    path = tmp_path / "results.json"
    path.write_text(json.dumps(changed(place, CHANGES[place])), "utf-8")
    line = refused(path)
    last = place.rstrip("/ ").replace("|", "/").split("/")[0 if place.startswith("claims") else -1]
    assert last in line or "results" in line or "effort" in line


@pytest.mark.parametrize("name", ["pitch/0", "fit/kitti_car", "pilot/3_front/road/rear"])
def test_an_incomplete_file_is_refused(tmp_path, name):
    data = copy.deepcopy(COMMITTED)
    del data["results"][name]
    path = tmp_path / "results.json"
    path.write_text(json.dumps(data), "utf-8")
    refused(path)


def places(at, path=()):
    """The places of all values in JSON data, of long lists the first few."""
    pairs = (
        at.items() if isinstance(at, dict) else enumerate(at[:6]) if isinstance(at, list) else ()
    )
    for key, value in pairs:
        yield (*path, key)
        yield from places(value, (*path, key))


def spoiled(rng, all_places):
    """The committed results with one value lost, or something else in its place."""
    *folders, last = rng.choice(all_places)
    data = at = copy.copy(COMMITTED)
    for key in folders:
        at[key] = copy.copy(at[key])
        at = at[key]
    if rng.random() < 0.1:
        del at[last]
    else:
        at[last] = rng.choice(STRANGE)
    return data


NUMBERS = (-1, 0, 1e300, -1e300, 1e-300, 10**400, 1e12, 100.0, float("nan"), float("inf"))
WORDS = ("", "x", "\x1b[2J", "\ud800", "a" * 10**5)
STRANGE = (*NUMBERS, *WORDS, None, True, [], {}, [[]], {"a": 1})


def test_whatever_one_value_is_there_is_a_page_or_one_line(tmp_path):
    rng, all_places = random.Random(8), list(places(COMMITTED))
    path = tmp_path / "results.json"
    pages = 0
    for _ in range(120):
        path.write_text(json.dumps(spoiled(rng, all_places)), "utf-8")
        try:
            data = read_results(path)
        except InputError as error:
            assert str(error).isprintable() and len(str(error)) < 400
        else:
            pages += page(ReproductionResults(data)).startswith("# ")
    assert 0 < pages < 120


def test_the_committed_file_is_right():
    assert read_results(DOCS / "results.json") == COMMITTED


def test_results_of_this_run_that_are_damaged_are_not_gone_on_with(tmp_path):
    results = ResultsFile(tmp_path, QUICK, check_value)
    results.add("pitch/0", ONE, 0.1)
    text = results.path.read_text("utf-8")
    results.path.write_text(text.replace('"seconds": 0.1', '"seconds": "long"'), "utf-8")
    with pytest.raises(InputError, match=r"results.pitch/0.seconds: expected a number"):
        ResultsFile(tmp_path, QUICK, check_value)


def test_results_of_another_commit_are_kept_under_their_own_name(tmp_path):
    value = ONE
    results = ResultsFile(tmp_path, QUICK, check_value)
    results.add("pitch/0", value, 0.1)
    assert (
        ResultsFile(tmp_path, QUICK, check_value).loaded == 1
        and ResultsFile(tmp_path, QUICK, check_value).old_results is None
    )
    old = results.path.read_text("utf-8").replace(
        results.made["commit"], "0123456789ab, changed since"
    )
    for kept in (
        "results-0123456789ab-changed-since.json",
        "results-0123456789ab-changed-since-2.json",
    ):
        results.path.write_text(old, "utf-8")
        new = ResultsFile(tmp_path, QUICK, check_value)
        assert (new.loaded, new.old_results) == (0, tmp_path / kept)
        assert results.path.read_text("utf-8") == old  # until there is a result of this run
        new.add("pitch/1", value, 0.1)
        assert (tmp_path / kept).read_text("utf-8") == old
        assert list(json.loads(results.path.read_text("utf-8"))["results"]) == ["pitch/1"]


def test_results_of_another_effort_are_kept(tmp_path):
    ResultsFile(tmp_path, QUICK, check_value).add("pitch/0", ONE, 0.1)
    full = ResultsFile(tmp_path, FULL, check_value)
    assert full.loaded == 0 and full.old_results.name.startswith("results-")


@pytest.mark.parametrize("name", ["README.md", "priors.png", "rows.png"])
def test_a_folder_in_the_place_of_a_file_is_one_line(tmp_path, name):
    (tmp_path / "results.json").write_bytes((DOCS / "results.json").read_bytes())
    (tmp_path / name).mkdir()
    run = study("paper", "--page-only", "--output", tmp_path)
    assert run.returncode == 1 and not run.stdout and run.stderr.count("\n") == 1
    assert f"{tmp_path / name}: file: expected a path that can be written" in run.stderr


def test_a_page_of_the_users_own_is_not_written_over(tmp_path):
    (tmp_path / "README.md").write_text("# My project")
    (tmp_path / "results.json").write_bytes((DOCS / "results.json").read_bytes())
    run = study("paper", "--page-only", "--json", "--output", tmp_path)
    assert run.returncode == 1 and not run.stdout and run.stderr.count("\n") == 1
    assert (tmp_path / "README.md").read_text() == "# My project"


def test_the_page_is_the_committed_one(tmp_path, monkeypatch):
    monkeypatch.setattr(reproduce, "draw_all", lambda *_: None)
    (tmp_path / "results.json").write_bytes((DOCS / "results.json").read_bytes())
    run = study("paper", "--page-only", "--json", "--output", tmp_path)
    assert run.returncode == 0 and json.loads(run.stdout) == COMMITTED and not run.stderr
    assert (tmp_path / "README.md").read_bytes() == (DOCS / "README.md").read_bytes()


@pytest.mark.parametrize("count", ["-1", "2.5", "two", "9" * 5000, ""])
def test_a_wrong_number_of_workers_is_reported_in_one_short_message(tmp_path, count):
    run = study("paper", "--quick", f"--workers={count}", "--output", tmp_path)
    assert run.returncode == 2 and not list(tmp_path.iterdir())
    assert "--workers" in run.stderr and len(run.stderr) < 1000


def kind_of(task_name):
    return task_name.partition("/")[0]


def test_check_reports_what_is_not_equal(quick, tmp_path, monkeypatch):
    """Of results with one figure changed, that one alone is not equal."""
    tasks = scores_and_figures(QUICK)
    if not THOROUGH:  # the first task of every kind
        tasks = list({kind_of(task.name): task for task in reversed(tasks)}.values())
        monkeypatch.setattr(reproduce, "scores_and_figures", lambda _: tasks)
    data = copy.deepcopy(quick.data)
    data["results"]["bound/2_60deg/road"]["value"]["in_view"] += 1e-15
    (tmp_path / "results.json").write_text(json.dumps(data), "utf-8")
    run = study("paper", "--quick", "--check", "--output", tmp_path)
    assert run.returncode == 1
    first, last = run.stdout.splitlines()
    assert first == "not equal: bound/2_60deg/road"
    checked = {name for name in data["results"] if kind_of(name) not in ("search", "pilot")}
    assert {kind_of(task.name) for task in tasks} == {kind_of(name) for name in checked}
    assert len(tasks) == len(checked) or not THOROUGH
    assert last == f"{len(tasks) - 1} of {len(tasks)} scores and figures are equal"
