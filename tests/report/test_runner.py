"""Worker processes end with the run, whatever ends it; finished results are kept."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from pe_tools.reproduction.plan import QUICK
from pe_tools.reproduction.reproduce import check_value
from pe_tools.reproduction.results_file import ResultsFile
from tests.report.conftest import ROOT

TINY = """
import sys
from pathlib import Path
from pe_tools.cli import run
from pe_tools.reproduction import tasks
from pe_tools.reproduction.plan import QUICK
from pe_tools.reproduction.reproduce import check_value
from pe_tools.reproduction.task_runner import Task, compute

ENDLESS = {"row": "2_60deg", "prior": "road", "start": "roof", "seed": 0,
           "candidates": 10**7, "search_samples": 1024, "samples": 1024}

def ready_tasks(values):
    tasks_in_order = [Task("bound_curve/60", tasks.bound_curve, {"hfov_deg": 60}),
                      Task("search/2_60deg/road/roof/0", tasks.search, ENDLESS)]
    return [task for task in tasks_in_order if task.name not in values]

if __name__ == "__main__":
    sys.exit(run(lambda: compute(Path(sys.argv[1]), QUICK, check_value, ready_tasks, 2)))
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
    assert process.stderr.readline().startswith("[1/2] bound_curve/60")
    return process


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_signal_ends_the_workers_and_keeps_what_is_done(tmp_path, name):
    """The workers hold the pipes: that they are at their end says that all workers are gone."""
    process = started(tmp_path)
    process.send_signal(getattr(signal, name))
    _, error = process.communicate(timeout=120)
    assert process.returncode == 128 + getattr(signal, name)
    path = tmp_path / "results.json"
    kept = "keeps the finished tasks; the same command goes on from them"
    assert error == f"pe: interrupted; {path} {kept}\n"
    assert list(json.loads(path.read_text("utf-8"))["results"]) == ["bound_curve/60"]
    assert ResultsFile(tmp_path, QUICK, check_value).loaded == 1


def test_workers_end_when_the_parent_is_killed(tmp_path):
    process = started(tmp_path)
    process.kill()
    process.communicate(timeout=120)  # comes back once the last worker has closed its pipes
    assert process.returncode == -signal.SIGKILL


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="processes are found in /proc")
def test_a_worker_that_is_killed_ends_the_run_in_one_line(tmp_path):
    process = started(tmp_path)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    workers = [
        pid for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()
    ]
    assert len(workers) == 2
    os.kill(int(workers[0]), signal.SIGKILL)
    _, error = process.communicate(timeout=120)
    assert process.returncode == 1 and error.count("\n") == 1
    assert error.startswith("pe: workers: process: expected one that runs to its end, found ")
    assert ResultsFile(tmp_path, QUICK, check_value).loaded == 1
