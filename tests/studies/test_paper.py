"""The quick reproduction, the committed page, and going on where a run stopped."""

import copy
import json
import re
import signal
import subprocess
import sys

import pytest

from studies.paper import plots
from studies.paper.__main__ import page
from studies.paper.experiments import QUICK, plan
from studies.paper.findings import Findings, statements
from tests.limits import HANG_S
from tests.studies.conftest import ROOT, numbers, study

DOCS = ROOT / "docs" / "reproduction"
COMMITTED = json.loads((DOCS / "results.json").read_text("utf-8"))
STUDY = "paper"
PRIORS = ("road", "uniform", "highway")
SAID = "The figures are higher"
"""Of the committed results, not of quick ones."""


@pytest.fixture
def no_plots(monkeypatch):
    monkeypatch.setattr(plots, "draw_all", lambda *_: None)


@pytest.mark.thorough
def test_the_orderings_are_the_papers_but_for_the_cameras_under_wide_priors(quick):
    found = Findings(quick.data)
    for key in ("1", "3 default", "3 front", "4"):
        assert found.verdicts(key) == dict.fromkeys(PRIORS, "holds")
    assert found.verdicts("2") == {**dict.fromkeys(PRIORS, "does not hold"), "highway": "holds"}
    assert found.verdicts("pitch") == {"road": "holds"}
    for key in ("1", "3 default", "3 front"):
        assert found.verdicts(key, "searched") == {"road": "holds"}
    for claim in quick.data["claims"]:
        better = claim["worse_entropy"] - claim["better_entropy"] > claim["by"]
        assert claim["holds"] == better


@pytest.mark.thorough
def test_the_camera_row_is_out_of_reach(quick):
    for row, printed in (("2_60deg", 2.0055), ("2_120deg", 2.0237)):
        for prior in PRIORS:
            value = quick.data["results"][f"bound/{row}/{prior}"]["value"]
            ours = quick.data["results"][f"printed/{row}/{prior}"]["value"]["entropy"]
            assert printed < value["least_all_round"] < value["least"] < ours


@pytest.mark.thorough
def test_the_run_is_complete_and_a_second_one_computes_nothing(quick, no_plots):
    values = {name: entry["value"] for name, entry in quick.data["results"].items()}
    assert plan(QUICK, values) == [] and quick.data["made"]["commit"]
    before = (quick.folder / "results.json").read_bytes()
    run = study("paper", "--quick", "--json", f"--output={quick.folder}")
    assert run.returncode == 0 and json.loads(run.stdout) == quick.data
    assert "going on from" in run.stderr and "[" not in run.stderr
    assert (quick.folder / "results.json").read_bytes() == before


@pytest.mark.thorough
def test_every_figure_of_the_page_is_in_the_results_and_every_picture_is_there(quick):
    """Numbers of four decimals are entropies: each is one of the results' or of the paper's."""
    text = (quick.folder / "README.md").read_text("utf-8")
    paper = {"1.6429", "2.1212", "2.0055", "2.0237", "1.7119", "1.6864", "0.8965"}
    found = set(re.findall(r"(?<![\d.])-?\d+\.\d{4}(?!\d)", text))
    assert len(found) > 30 and found <= paper | {f"{v:.4f}" for v in numbers(quick.data)}
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", text)
    assert len(pictures) == 13
    for name in pictures:
        assert (quick.folder / name).read_bytes().startswith(b"\x89PNG"), name


def test_the_discussion_follows_from_the_committed_results():
    stated = statements(Findings(COMMITTED))
    assert len(stated) > 20 and all(stated.values()), [k for k, v in stated.items() if not v]
    assert SAID in page(Findings(COMMITTED))


@pytest.mark.thorough
def test_the_discussion_does_not_follow_from_quick_results(quick):
    assert not all(statements(Findings(quick.data)).values())
    assert SAID not in page(Findings(quick.data))


def test_claims_turned_over_turn_their_verdicts_but_where_chance_may_have_decided():
    data = copy.deepcopy(COMMITTED)
    for claim in data["claims"]:
        claim["holds"] = not claim["holds"]
    pairs = zip(COMMITTED["claims"], data["claims"], strict=True)
    verdicts = [(Findings(COMMITTED).verdict(a), Findings(data).verdict(b)) for a, b in pairs]
    assert sorted(set(verdicts)) == [
        ("does not hold", "holds"),
        ("holds", "does not hold"),
        ("not decided", "not decided"),
    ]
    assert verdicts.count(("not decided", "not decided")) == 1


def test_the_page_is_the_committed_one(tmp_path, no_plots):
    (tmp_path / "results.json").write_bytes((DOCS / "results.json").read_bytes())
    run = study("paper", "--page-only", "--json", f"--output={tmp_path}")
    assert run.returncode == 0 and json.loads(run.stdout) == COMMITTED and not run.stderr
    assert (tmp_path / "README.md").read_bytes() == (DOCS / "README.md").read_bytes()


@pytest.mark.thorough
@pytest.mark.usefixtures("heeded_signals")
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
    assert process.returncode == 128 + signal.SIGTERM and "Traceback" not in error
    kept = json.loads((tmp_path / "results.json").read_text("utf-8"))["results"]
    assert data["results"].keys() < kept.keys() < quick.data["results"].keys()
