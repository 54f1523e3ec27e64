"""Worker processes end with the run, whatever ends it; finished results are kept."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.paper.plan import QUICK
from studies.paper.reproduce import check_value
from studies.results_file import ResultsFile
from tests.studies.conftest import ROOT

TINY = """
import sys
from pathlib import Path
from pe_tools.cli import run
from studies.paper import tasks
from studies.paper.plan import QUICK
from studies.paper.reproduce import check_value
from studies.task_runner import Task, compute

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


def killed(process):
    """Kill a worker, once there is one; return the ids of all."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    while True:
        pids = [int(pid) for pid in children.read_text().split()]
        workers = [pid for pid in pids if b"spawn_main" in _command(pid)]
        if workers:
            os.kill(workers[0], signal.SIGKILL)
            return workers
        time.sleep(0.02)


def _command(pid):
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:  # it has ended meanwhile
        return b""


def gone(pid):
    """Whether a process has ended; what its parent has not noticed yet has no command line."""
    return not _command(pid)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="processes are found in /proc")
def test_a_task_that_loses_two_workers_ends_the_run_in_one_line(tmp_path):
    """The first time, the task is run again in a new process."""
    process = started(tmp_path)
    workers = killed(process)
    assert len(workers) == 2
    while not all(map(gone, workers)):
        time.sleep(0.02)
    assert killed(process)[0] not in workers
    _, error = process.communicate(timeout=120)
    assert process.returncode == 1 and error.count("\n") == 1
    assert error.startswith("pe: workers: process: expected a process that completes, found two ")
    assert "2_60deg" in error
    assert ResultsFile(tmp_path, QUICK, check_value).loaded == 1
