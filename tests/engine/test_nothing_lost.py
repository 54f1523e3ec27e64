"""Signals, streams and folders that go away: a search never ends without its result."""

import errno
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.codec import record
from pe_tools import jobs
from tests.engine.processes import ROOT, Command
from tests.limits import HANG_S

if sys.platform == "win32":
    pytest.skip("POSIX signals and files", allow_module_level=True)
pytestmark = pytest.mark.usefixtures("heeded_signals")
ENDLESS = ("--set", "optimize.candidates=100000")
SHORT = ("--set", "optimize.candidates=4")
SIGNALS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


def result(folder):
    """Return result.json, after checking that the set is whole and of one run."""
    data = json.loads((folder / "result.json").read_text("utf-8"))
    best = pe.load_study(folder / "study.toml")
    assert record(jobs.placements(best.rig)) == data["placements"]["after"]
    assert best.evaluator().score(best.rig).to_dict() == data["after"]
    assert (folder / "history.csv").read_text().count("\n") == len(data["history"]) + 1
    return data


def entropy_of(path):
    study = pe.load_study(path)
    return study.evaluator().entropy(study.rig)


def test_the_first_signal_evaluates_keeps_and_analyses_the_best(study, out):
    with Command(["optimize", "--no-review", study, "-o", out, *ENDLESS]) as command:
        command.wait_for_better()
        command.send(signal.SIGHUP)
        assert command.end() == SIGNALS[signal.SIGHUP]
    data = result(out)
    assert data["stopped"] and data["after"]["entropy"] <= data["before"]["entropy"]
    assert data["robustness"] is not None


def test_the_second_signal_ends_the_analysis(study, out):
    with Command(["optimize", "--no-review", study, "-o", out, *ENDLESS], hangs=True) as command:
        command.wait_for_better()
        command.send(signal.SIGINT)
        command.wait_for_stage("analysing")  # it would analyse for ever
        command.send(signal.SIGTERM)
        assert command.end() == SIGNALS[signal.SIGINT]
    data = result(out)
    assert data["stopped"] and "robustness" not in data and data["flatness"] is None


def test_the_third_signal_ends_at_once_with_the_best_kept(study, out):
    with Command(
        ["optimize", "--no-review", study, "-o", out, *ENDLESS], hang_in_score=2
    ) as command:
        command.wait_for_better()
        command.send(signal.SIGINT)
        command.wait_for_stage("scoring the result")  # it would wait there for ever
        command.send(signal.SIGHUP)
        command.send(signal.SIGTERM)
        assert command.end() == SIGNALS[signal.SIGTERM]
    assert entropy_of(out / "study.toml") < entropy_of(study)
    assert not (out / "result.json").exists()
    assert f"the best placement so far is in {out / 'study.toml'}" in "".join(command.complaints)


@pytest.mark.parametrize(
    ("signum", "verb"),
    [(signal.SIGINT, "score"), (signal.SIGTERM, "optimize"), (signal.SIGHUP, "score")],
)
def test_a_signal_during_the_first_score_ends_it_with_nothing_written(study, out, verb, signum):
    with Command([verb, study, "-o", out], hang_in_score=1) as command:
        command.wait_for_stage("scoring")
        command.send(signum)
        assert command.end() == SIGNALS[signum]
    expected = "pe: interrupted; no score was complete, so nothing was written\n"
    assert command.complaints == [expected]
    assert list(out.iterdir()) == []


@pytest.mark.parametrize("module", ["numpy", "pe_tools.cli.terminal"])
def test_ctrl_c_while_loading_is_one_line(module):
    """Python tells of each module that it has loaded; many more follow these."""
    process = subprocess.Popen(
        [sys.executable, "-X", "importtime", "-m", "pe_core", "sensors"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    told = []
    for line in process.stderr:
        told.append(line)
        if line.split("|")[-1].strip().startswith(module):
            process.send_signal(signal.SIGINT)
            break
    _, rest = process.communicate(timeout=HANG_S)
    own = [line for line in (*told, *rest.splitlines()) if not line.startswith("import time:")]
    assert (process.returncode, [line.strip() for line in own]) == (130, ["pe: interrupted"])


def test_closed_streams_end_nothing(study, out):
    def close():
        for number in (0, 1, 2):
            os.close(number)

    with Command(
        ["optimize", "--no-review", study, "-o", out, *SHORT], preexec_fn=close
    ) as command:
        assert command.end() == 0
    assert not result(out)["stopped"]


def test_a_disk_that_fills_leaves_the_older_set(study, out, monkeypatch):
    from pe_tools.cli.run_job import keep

    first = pt.OptimizeJob(pe.load_study(study))
    list(first)
    assert keep(first.outcome, out, None)[0] == 0
    old = (out / "result.json").read_bytes()
    job = pt.OptimizeJob(replace(first.study, search=replace(first.study.search, seed=9)))
    list(job)
    jobs.Checkpoint(job).save(out)
    real = jobs.folder.write_synced
    fired = []

    def full(path, data):
        if path.parent == out:
            fired.append(path)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(path, data)

    monkeypatch.setattr(jobs.folder, "write_synced", full)
    assert keep(job.outcome, out, None)[0] == 1
    assert fired and (out / "result.json").read_bytes() == old


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_a_set_is_replaced_whole_or_stays(study, out, failing_call, call):
    job = pt.ScoreJob(pe.load_study(study))
    list(job)
    jobs.write_outcome(job.outcome, out)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    again = pt.ScoreJob(replace(job.study, samples=2048))
    list(again)
    count = failing_call(call, errno.EIO, first=3, once=call == "replace")
    with pytest.raises(pe.InputError, match="input/output error"):
        jobs.write_outcome(again.outcome, out)
    assert count.fired >= 1
    now = {path.name: path.read_bytes() for path in out.iterdir()}
    assert {**now, ".perception-entropy.json": b""} == {**before, ".perception-entropy.json": b""}


def test_a_file_that_appears_meanwhile_is_not_written_over(study, out):
    with Command(["optimize", "--no-review", study, "-o", out, *ENDLESS]) as command:
        command.wait_for_better()
        (out / "history.csv").write_text("mine")
        command.send(signal.SIGTERM)
        assert command.end() == 1
    assert (out / "history.csv").read_text() == "mine"
