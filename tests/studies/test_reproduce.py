"""The quick reproduction: the orderings, the page, the plots, and going on where it stopped."""

import copy
import json
import re
import signal
import subprocess
import sys

import pytest

from pe_core import InputError
from studies.paper import reproduce
from studies.paper.plan import FULL, QUICK, plan, scores_and_figures
from studies.results_file import ResultsFile
from tests.limits import HANG_S
from tests.studies.conftest import ROOT, numbers, study
from tests.thorough import THOROUGH

DOCS = ROOT / "docs" / "reproduction"
COMMITTED = json.loads((DOCS / "results.json").read_text("utf-8"))
KEYS = ("1", "2", "3 default", "3 front", "4")


def verdict(quick, experiment, where, prior):
    (claim,) = [
        c
        for c in quick.data["claims"]
        if (c["experiment"], c["where"], c["prior"]) == (experiment, where, prior)
    ]
    assert claim["holds"] == (claim["worse_entropy"] - claim["better_entropy"] > claim["by"])
    return claim["holds"]


@pytest.mark.parametrize("prior", ["road", "uniform", "highway"])
@pytest.mark.parametrize("experiment", KEYS)
def test_orderings_at_the_printed_placements(quick, experiment, prior):
    """All are the paper's, but 60 against 120 degrees: that one needs a narrow prior."""
    expected = experiment != "2" or prior == "highway"
    assert verdict(quick, experiment, "printed", prior) == expected


@pytest.mark.parametrize("experiment", ["1", "3 default", "3 front"])
def test_orderings_of_our_own_search(quick, experiment):
    assert verdict(quick, experiment, "searched", "road")


def test_a_small_pitch_difference_is_better_than_none(quick):
    assert verdict(quick, "pitch", "printed", "road")


def test_the_camera_row_is_out_of_reach(quick):
    for row, printed in (("2_60deg", 2.0055), ("2_120deg", 2.0237)):
        for prior in ("road", "uniform", "highway"):
            value = quick.data["results"][f"bound/{row}/{prior}"]["value"]
            ours = quick.data["results"][f"printed/{row}/{prior}"]["value"]["entropy"]
            assert printed < value["least_all_round"] < value["least"] < ours


def test_the_run_is_complete(quick):
    values = {name: entry["value"] for name, entry in quick.data["results"].items()}
    assert plan(QUICK, values) == []
    assert quick.data["made"]["commit"] and quick.data["made"]["machine"]
    assert "does not hold" in quick.run.stdout.lower()


def test_every_figure_of_the_page_is_in_the_results(quick):
    """Numbers of four decimals are entropies: each is one of the results' or of the paper's."""
    page = (quick.folder / "README.md").read_text("utf-8")
    paper = {"1.6429", "2.1212", "2.0055", "2.0237", "1.7119", "1.6864", "0.8965"}
    ours = {f"{v:.4f}" for v in numbers(quick.data)}
    found = set(re.findall(r"(?<![\d.])-?\d+\.\d{4}(?!\d)", page))
    assert len(found) > 30
    assert found <= ours | paper


def test_every_picture_of_the_page_is_there(quick):
    page = (quick.folder / "README.md").read_text("utf-8")
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", page)
    assert len(pictures) == 13
    for name in pictures:
        assert (quick.folder / name).read_bytes().startswith(b"\x89PNG"), name


def test_a_second_run_computes_nothing_and_prints_the_json(quick, monkeypatch):
    monkeypatch.setattr(reproduce, "draw_all", lambda *_: None)  # another test draws a second time
    before = (quick.folder / "results.json").read_bytes()
    run = study("paper", "--quick", "--json", "--output", quick.folder)
    assert run.returncode == 0
    assert json.loads(run.stdout) == quick.data
    assert "going on from" in run.stderr and "[" not in run.stderr
    assert (quick.folder / "results.json").read_bytes() == before


def test_what_is_done_is_kept_when_it_is_interrupted(quick, tmp_path):
    """A run that goes on with the pitch figure alone ends between two of its scores."""
    data = copy.deepcopy(quick.data)
    to_do = {task for task in data["results"] if task.startswith("pitch/")}
    data["results"] = {task: e for task, e in data["results"].items() if task not in to_do}
    (tmp_path / "results.json").write_text(json.dumps(data), "utf-8")
    command = [sys.executable, "-m", "studies.paper", "--quick", "--output", str(tmp_path)]
    process = subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert "going on from" in process.stderr.readline()
    assert "] pitch/" in process.stderr.readline()
    process.send_signal(signal.SIGTERM)
    _, error = process.communicate(timeout=HANG_S)
    assert process.returncode == 128 + signal.SIGTERM
    assert "interrupted" in error and "Traceback" not in error
    kept = json.loads((tmp_path / "results.json").read_text("utf-8"))["results"]
    assert data["results"].keys() < kept.keys() < quick.data["results"].keys()


def test_a_page_of_incomplete_results_is_refused(tmp_path):
    (tmp_path / "results.json").write_text('{"schema": 1, "made": {}, "results": {}}')
    run = study("paper", "--page-only", "--output", tmp_path)
    assert run.returncode == 1 and run.stderr.count("\n") == 1
    assert "complete results of schema 1" in run.stderr


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


@pytest.mark.parametrize("place", ["claims/0/better_entropy", "results/pitch|0/value/entropy"])
def test_claims_that_do_not_follow_from_the_values_are_refused(tmp_path, place):
    data = at = copy.deepcopy(COMMITTED)
    *folders, last = (k.replace("|", "/") for k in place.split("/"))
    for key in folders:
        at = at[int(key) if isinstance(at, list) else key]
    at[last] += 1.0
    (tmp_path / "results.json").write_text(json.dumps(data), "utf-8")
    with pytest.raises(InputError, match="claims"):
        reproduce.read_results(tmp_path / "results.json")


def test_results_of_another_commit_are_kept_under_a_name_of_their_own(tmp_path):
    results = ResultsFile(tmp_path, QUICK)
    results.add("pitch/0", {"entropy": 1.0}, 0.1)
    assert ResultsFile(tmp_path, QUICK).loaded == 1
    for name in ("results-2.json", "results-3.json"):
        assert ResultsFile(tmp_path, FULL).loaded == 0
        assert (tmp_path / name).exists() and not results.path.exists()
        results.save()


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
