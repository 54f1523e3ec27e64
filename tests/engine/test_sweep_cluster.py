"""A search and a sweep by a real Dask scheduler with two workers; one of them is killed."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.cli.verbs import main
from pe_tools.sweep import sweep_table
from tests.engine import shapes
from tests.engine.processes import ROOT
from tests.limits import HANG_S

pytestmark = pytest.mark.thorough
Client = pytest.importorskip("distributed").Client
if sys.platform == "win32":
    pytest.skip("POSIX signals", allow_module_level=True)
HEIGHTS = ("1.6", "1.8", "2.0", "2.1")
WAITING = """
import os, pathlib, time
from pe_core.scoring.evaluator import Evaluator
folder = pathlib.Path({folder!r})
plain = Evaluator.plain = getattr(Evaluator, "plain", Evaluator.score)  # it is run twice
def score(self, rig, **options):
    (folder / f"busy-{{os.getpid()}}").touch()
    while not (folder / "go").exists():
        time.sleep(0.02)
    return plain(self, rig, **options)
Evaluator.score = score
"""
"""In a worker: every score says that it has begun, and waits until it may go on."""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    rig = shapes.roof_rig(16, 180)
    path = tmp_path_factory.mktemp("sweep") / "car.toml"
    pt.export_study(shapes.car_study(rig), path)
    return path


class Cluster:
    """A scheduler and two workers, processes of their own."""

    def __init__(self, folder):
        self.scheduler = started("scheduler", folder, "--no-dashboard --host 127.0.0.1 --port 0")
        self.folder = folder
        script = folder / "waiting.py"
        script.write_text(WAITING.format(folder=str(folder)))
        options = "--no-dashboard --host 127.0.0.1 --nthreads 1 --no-nanny"
        options += f" --death-timeout {HANG_S} --preload {script}"
        self.workers = [started("worker", folder, options) for _ in range(2)]
        self.address = self._address(folder / "scheduler.json")

    def _address(self, file):
        wait_until(lambda: file.exists() and file.read_text())
        address = json.loads(file.read_text())["address"]
        with Client(address) as client:
            client.wait_for_workers(2, HANG_S)
        return address

    def busy(self, worker):
        return (self.folder / f"busy-{worker.pid}").exists()

    def end(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


def wait_until(is_so):
    """Wait for something that comes for certain, and give up where it does not."""
    for _ in range(50 * HANG_S):
        if is_so():
            return
        time.sleep(0.02)


def started(role, folder, arguments):
    """A process of a role, by words for the command line."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{role}", *arguments.split()]
    command += ["--scheduler-file", str(folder / "scheduler.json")]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(command, cwd=ROOT, env=env, stderr=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    yield cluster
    cluster.end()


class Noted:
    """An evaluator that notes each time a worker unpickles it, with the mesh."""

    def __init__(self, folder, evaluator):
        self.folder = folder
        self.evaluator = evaluator

    def __setstate__(self, state):
        vars(self).update(state)
        (Path(self.folder) / f"unpickled {os.getpid()} {time.monotonic_ns()}").touch()

    def entropy(self, rig):
        return self.evaluator.entropy(rig)


def steps(objective, study, executor=None):
    asked = {"evaluations": 30, "executor": executor}
    found = pe.optimize(objective, study.rig, study.search_space(), **asked)
    return [(s.entropy, s.improved, [own.pose for own in s.best]) for s in found]


def test_a_search_by_its_workers_takes_the_steps_of_one_process(study, cluster, tmp_path):
    """Here, before one of them is killed; and the mesh comes once to each."""
    given = pe.load_study(study)
    by_one_process = steps(given.evaluator(1024), given)
    with Client(cluster.address) as client:
        addresses = list(client.scheduler_info()["workers"])
        for count in (1, 2):
            executor = client.get_executor(workers=addresses[:count], pure=False)
            noted = Noted(str(tmp_path), given.evaluator(1024))
            assert steps(noted, given, executor) == by_one_process
            files = list(tmp_path.glob("unpickled *"))
            unpickled = [path.name.split()[1] for path in files]
            assert 0 < len(unpickled) == len(set(unpickled)) <= count
            for path in files:
                path.unlink()


def at_first_result(monkeypatch, do):
    """Have something done when the first result has come; return the names of all that come."""
    came = []
    row_of = sweep_table.row_of

    def watched(run, result, *status):
        if not came:
            do()
        came.append(run.name)
        return row_of(run, result, *status)

    monkeypatch.setattr(sweep_table, "row_of", watched)
    return came


def kill_in_the_middle(cluster):
    """Kill a worker once both are busy, and let the other one go on."""
    wait_until(lambda: all(map(cluster.busy, cluster.workers)))
    cluster.workers[0].send_signal(signal.SIGKILL)
    cluster.workers[0].wait()
    (cluster.folder / "go").touch()


def test_a_worker_that_is_killed_costs_no_result(study, cluster, tmp_path, monkeypatch, capsys):
    threading.Thread(target=kill_in_the_middle, args=(cluster,), daemon=True).start()
    came = at_first_result(monkeypatch, lambda: None)
    values = f"sensor.roof.position.2={','.join(HEIGHTS)}"
    out = tmp_path / "out"
    argv = ["sweep", str(study), "--set", values, "-o", str(out), "--executor", cluster.address]
    assert main(argv) == 0
    assert len(came) == len(set(came)) == len(HEIGHTS), "each result once"
    rows = json.loads((out / "sweep.json").read_text())["runs"]
    base = pe.load_study(study)
    for row, height in zip(rows, HEIGHTS, strict=True):
        lidar = shapes.lidar_on_roof(shapes.small_lidar(16, 180), (-0.43, 0, float(height)))
        assert row["entropy"] == base.evaluator().score(pe.Rig([lidar])).entropy
        result = json.loads((out / row["run"] / "result.json").read_text())
        assert result["entropy"] == row["entropy"]
    assert cluster.workers[0].poll() == -signal.SIGKILL
    assert "Traceback" not in capsys.readouterr().err
