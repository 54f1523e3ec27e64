"""Processes end with the run, whatever ends it; what is done is kept."""

import json
import signal
import subprocess
import sys

import pytest

from pe_report.effort import QUICK
from pe_report.ledger import Ledger
from tests.report.conftest import ROOT

TINY = """
import sys
from pathlib import Path
from pe_report.effort import QUICK
from pe_report.ledger import Ledger
from pe_report.plan import Task
from pe_report.runner import Ended, run_all

ENDLESS = {"row": "2_60deg", "prior": "road", "start": "roof", "seed": 0,
           "candidates": 10**7, "search_samples": 1024, "samples": 1024}

def plan(effort, known):
    every = [Task("bound_curve/60", "bound_curve", {"hfov_deg": 60}),
             Task("search/2_60deg/road/roof/0", "search", ENDLESS)]
    return [task for task in every if task.name not in known]

if __name__ == "__main__":
    try:
        ledger = Ledger(Path(sys.argv[1]), QUICK)
        run_all(QUICK, ledger, 2, lambda line: print(line, flush=True), plan)
    except Ended as end:
        sys.exit(f"ended by {end.signum}")
"""
"""One short task, and one that goes on until it is ended."""


def started(folder):
    """A run whose first task is done and whose second one goes on."""
    process = subprocess.Popen(
        [sys.executable, "-c", TINY, str(folder)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline().startswith("[1/2] bound_curve/60")
    return process


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_signal_ends_the_workers_and_keeps_what_is_done(tmp_path, name):
    """The workers hold the pipes: that they are at their end says that all workers are gone."""
    process = started(tmp_path)
    process.send_signal(getattr(signal, name))
    _, error = process.communicate(timeout=120)
    assert process.returncode == 1 and error == f"ended by {getattr(signal, name).value}\n"
    assert list(json.loads((tmp_path / "results.json").read_text("utf-8"))["results"]) == [
        "bound_curve/60"
    ]
    assert Ledger(tmp_path, QUICK).found == 1


def test_workers_end_when_the_parent_is_killed(tmp_path):
    process = started(tmp_path)
    process.kill()
    process.communicate(timeout=120)  # comes back once the last worker has closed its pipes
    assert process.returncode == -signal.SIGKILL
