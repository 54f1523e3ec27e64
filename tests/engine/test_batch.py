"""Dispatched candidates: the same result for all executors, whatever happens to workers."""

import _multiprocessing
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from os import _exit as end_at_once
from pathlib import Path

import pytest

import pe_core as pe
from pe_core.search import (
    NO_VALUE,
    Processes,
    Value,
    as_objective,
    evaluate_all,
    processes,
    start_processes,
)
from pe_core.search.payload import Payload
from pe_tools.cli.executors import workplace
from tests.engine import shapes
from tests.limits import HANG_S

CANDIDATES = 7
ROOM = pe.PerceptionSpace((-8.0, 8.0), (-8.0, 8.0), (0.0, 2.0), 0.5)
PACKED = """
import os, shutil, sys
from pathlib import Path
here = Path(sys.argv[1])
shutil.copytree(sys.argv[2], here / "outer" / "addon" / "pe_core", copy_function=os.symlink)
(here / "outer" / "__init__.py").touch()
(here / "outer" / "addon" / "__init__.py").write_text("import sys; sys.in_blender")
sys.in_blender = True
sys.path.insert(0, str(here))
from outer.addon.pe_core.search import start_processes
with start_processes(2) as pool:
    from outer.addon.pe_core import Pose
    assert pool.submit(Pose, (1.0, 2.0, 3.0)).result() == Pose((1.0, 2.0, 3.0))
print("done")
"""
"""The engine inside an add-on, which runs in Blender alone; a script that is run by workers never
ends."""
POSIX = pytest.mark.skipif(
    not hasattr(signal, "pthread_sigmask"), reason="signals of POSIX systems"
)


@pytest.fixture(scope="module")
def pool():
    """Two processes."""
    with Processes(2) as made:
        yield made


@pytest.fixture(scope="module")
def evaluator():
    """A sampled one, with a vehicle that hides something."""
    car = pe.Vehicle(shapes.box((-1.0, -0.5, 0.2), (1.0, 0.5, 1.0)))
    return pe.Evaluator(ROOM, pe.Prior.uniform(), car, samples=1024)


@pytest.fixture(scope="module")
def rigs():
    """A LiDAR pushed along the roof, and a camera that stays."""
    lidar = shapes.small_lidar(8, 40)
    camera = pe.Camera("c", 200, 100, 1.0)
    still = pe.Sensor("ahead", camera, pe.Pose((0.9, 0.0, 1.1)))
    places = [pe.Pose((x / 5.0 - 0.6, 0.0, 1.1)) for x in range(CANDIDATES)]
    return [pe.Rig([pe.Sensor("roof", lidar, pose), still]) for pose in places]


class Landscape:
    """An objective: how far forward the first sensor is. It notes wherever it is unpacked."""

    def __init__(self, folder, deaths=0, error=None):
        self.folder = Path(folder)
        self.deaths = deaths
        self.error = error

    def __setstate__(self, state):
        vars(self).update(state)
        (self.folder / f"unpacked {os.getpid()} {time.monotonic_ns()}").touch()

    def entropy(self, rig):
        x = rig.sensors[0].pose.position[0]
        if x > 0.5:
            for number in range(self.deaths):
                self.die_unless(self.folder / f"death {number}")
            if self.error:
                raise self.error
        return x

    def die_unless(self, it_was):
        if not it_was.exists():
            it_was.touch()
            end_at_once(1)

    @property
    def unpacked(self):
        """The processes that it was unpacked in, once a time."""
        return [path.name.split()[1] for path in self.folder.glob("unpacked *")]


def evaluated(given, rigs, cutoff=math.inf, executor=None):
    """Evaluate rigs below a figure, by an executor."""
    below = NO_VALUE if cutoff == math.inf else Value(0.0, cutoff)
    return [each.objective for each in evaluate_all(as_objective(given), rigs, below, executor)]


def test_results_do_not_depend_on_who_evaluates(evaluator, rigs, pool):
    """To the bit: here, in one process, in two, in threads, in any order, after anything."""
    alone = [evaluator.entropy(rig) for rig in rigs]
    assert len(set(alone)) == CANDIDATES
    foreign = ProcessPoolExecutor(1, get_context("spawn"))
    with ThreadPoolExecutor(3) as threads, foreign:
        for executor in (None, threads, foreign, pool):
            assert evaluated(evaluator, rigs, math.inf, executor) == alone
        backward = evaluated(evaluator, rigs[::-1], math.inf, pool)
    assert backward[::-1] == alone


def test_an_objective_is_sent_to_a_process_once(tmp_path, rigs, pool):
    objective = Landscape(tmp_path)
    for _ in range(3):
        evaluated(objective, rigs, math.inf, pool)
    assert 1 <= len(objective.unpacked) <= 2
    assert len(set(objective.unpacked)) == len(objective.unpacked)


def test_what_objectives_and_rigs_share_is_sent_once(evaluator, rigs):
    """The vehicle of two evaluators once; a candidate refers to its sensors' models by number."""
    finer = pe.Evaluator(ROOM, pe.Prior.uniform(), evaluator.vehicle, samples=2048)
    payload = Payload([evaluator, finer, *(sensor.model for sensor in rigs[0])])
    assert payload.packed.data.count(evaluator.vehicle.triangles.tobytes()) == 1
    assert payload.covers([finer, rigs[1].sensors[0].model])
    candidate = payload.pickled((finer, rigs[1]))
    assert b"Evaluator" not in candidate and b"Lidar" not in candidate
    assert b"Lidar" in Payload([evaluator]).pickled((evaluator, rigs[1]))


def test_a_worker_that_dies_is_replaced_and_its_rig_evaluated_again(tmp_path, rigs, pool):
    objective = Landscape(tmp_path, deaths=1)
    values = evaluated(objective, rigs, math.inf, pool)
    assert values == [rig.sensors[0].pose.position[0] for rig in rigs]
    assert (tmp_path / "death 0").exists()


def test_a_rig_that_kills_two_workers_is_named(tmp_path, rigs):
    with Processes(1) as fresh, pytest.raises(pe.InputError) as raised:
        evaluated(Landscape(tmp_path, deaths=9), rigs, math.inf, fresh)
    assert str(raised.value) == (
        "workers: process: expected a worker that survives its task, "
        "found two that died with roof at [0.6, 0.0, 1.1], ahead at [0.9, 0.0, 1.1]"
    )


def test_what_an_objective_raises_in_a_worker_is_raised(tmp_path, rigs, pool):
    error = pe.InputError("mount", "part", "a surface", 3.5)
    with pytest.raises(pe.InputError) as raised:
        evaluated(Landscape(tmp_path, error=error), rigs, math.inf, pool)
    assert str(raised.value) == str(error)
    with pytest.raises(ZeroDivisionError) as fault:
        evaluated(Landscape(tmp_path, error=ZeroDivisionError()), rigs, math.inf, pool)
    assert "in entropy" in fault.value.__notes__[0], "the worker's traceback comes along"


def test_an_objective_that_cannot_be_sent_evaluates_here(tmp_path, rigs, pool):
    objective = Landscape(tmp_path)
    objective.cannot_be_pickled = lambda: None
    assert evaluated(objective, rigs, math.inf, pool) == evaluated(objective, rigs)
    assert not objective.unpacked


def test_where_no_process_can_be_started_there_are_none(monkeypatch):
    assert start_processes(1) is None
    monkeypatch.setattr(processes, "beginning", lambda *_: "raise SystemExit(1)")
    assert start_processes(2) is None


def test_without_semaphores_there_are_no_processes_and_one_line_says_so(monkeypatch, capsys):
    """As in a container whose /dev/shm cannot be written: a thread once ended in a traceback."""

    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(_multiprocessing, "SemLock", refuse)
    assert processes.no_processes() == "semaphores in /dev/shm: permission denied"
    assert start_processes(2) is None
    with pytest.raises(pe.InputError, match=r"semaphores .* /dev/shm, found permission denied"):
        Processes(2)
    with workplace(2, None) as here:
        assert here.width() == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_workers_of_an_engine_packed_into_an_add_on_run_no_add_on(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(PACKED)
    arguments = [str(tmp_path), str(Path(pe.__file__).parent)]
    command = [sys.executable, str(script), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    assert done.stdout == "done\n", done.stderr


class Ended(Exception):
    """What the handler raises."""


@pytest.fixture
def handler() -> Iterator[None]:
    def end(*_: object) -> None:
        raise Ended

    before = signal.signal(signal.SIGTERM, end)
    yield
    signal.signal(signal.SIGTERM, before)


@POSIX
def test_a_worker_can_be_ended_by_a_signal():
    with Processes(1) as processes:
        blocked = processes.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
    assert signal.SIGTERM not in blocked
