"""The engine in a process of its own: requests are answered, whatever happens to the process."""

import errno
import math
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from operator import itemgetter

import numpy as np
import psutil
import pytest

import pe_core as pe
from pe_tools.engine_process import FOLLOWS_MOUSE, EngineEnded, EngineProcess, call_here
from pe_tools.engine_process.messages import Writer
from pe_tools.jobs import JobRun, OptimizeJob, WatchedJob, result_dict
from tests.engine import shapes
from tests.limits import HANG_S

RUN = {"run": None}
"""How long it took, and which programs took part."""


def vehicle_sum(vehicle):
    return float(vehicle.triangles.sum())


def own_sensors():
    return pe.catalog.replace_added, (pe.catalog.added(),)


@pytest.fixture(scope="module")
def engine():
    """One process for all tests; it is replaced wherever a test kills it."""
    made = EngineProcess(lambda: {pe.Vehicle: 2, pe.Lidar: 9}, own_sensors)
    yield made
    made.stop()


def settled(engine):
    for _ in range(200 * HANG_S):
        if not engine.deliver_all():
            return
        time.sleep(0.005)
    pytest.fail("an answer is awaited")


def ask(engine, topic, function, *arguments, **options):
    got = []
    engine.ask(topic, function, arguments, got.append, got.append, **options)
    return got


def killed(engine):
    psutil.Process(engine.pid).kill()


def test_the_latest_of_a_topic_is_answered_and_lanes_do_not_wait_for_each_other(engine):
    first = ask(engine, "busy", time.sleep, 0.5)
    score = [ask(engine, "score", math.factorial, n) for n in range(5)]
    beside = ask(engine, "beside", math.factorial, 5, lane=FOLLOWS_MOUSE)
    while not beside:
        engine.deliver_all()
    assert beside == [120] and not first and engine.busy("bu") and not engine.busy("beside")
    settled(engine)
    assert first == [None] and score == [[], [], [], [], [24]]
    dropped = ask(engine, "dropped", time.sleep, 0.1)
    engine.drop("dropped")
    assert not engine.busy()
    settled(engine)
    error = ask(engine, "wrong", math.sqrt, -1.0)
    settled(engine)
    assert not dropped and isinstance(error[0], ValueError) and "server.py" in error[0].__notes__[0]


@pytest.mark.skipif(sys.platform == "win32", reason="its pipes have no mode that does not wait")
def test_no_request_waits_for_the_engine(engine):
    """A process that reads nothing, as it has been stopped: a large request and many small ones are
    taken at once, cancelled and dropped. Without the writer's queue the test hangs until the timer
    lets the process go on."""
    ask(engine, "begin", math.factorial, 3)
    settled(engine)
    process = psutil.Process(engine.pid)
    late = []
    process.suspend()
    timer = threading.Timer(HANG_S, lambda: (late.append(True), process.resume()))
    timer.start()
    try:
        faces = np.random.default_rng(0).uniform(-1.0, 1.0, (200_000, 3, 3))
        large = ask(engine, "large", vehicle_sum, pe.Vehicle(faces))
        dropped = ask(engine, "dropped", bytes, 3_000_000)
        small = [ask(engine, f"small {n}", len, "x" * 1000) for n in range(500)]
        engine.cancel("small 0")
        engine.drop("dropped")
        assert all(engine.deliver_all() for _ in range(20))
        assert not late and not large and not any(small)
    finally:
        timer.cancel()
        process.resume()
    settled(engine)
    assert large == [float(faces.sum())] and small == [[1000]] * 500 and not dropped


def test_what_cannot_be_sent_fails_at_once_and_harms_nothing(engine):
    car = shapes.box_car()
    error = ask(engine, "odd", itemgetter(0), [car, lambda: None])
    assert isinstance(error[0], Exception) and not engine.busy("odd")
    fine = ask(engine, "fine", itemgetter(0), [car])
    settled(engine)
    assert fine == [car]
    answer = ask(engine, "answer", getattr, sys, "stdin")  # arguments are pickled by name
    settled(engine)
    assert isinstance(answer[0], Exception)


def test_a_vehicle_is_sent_once_and_comes_back_as_the_same_object(engine, monkeypatch):
    car = shapes.box_car()
    sent = []
    put = Writer.put

    def counted(self, message):
        sent.append(len(pickle.dumps(message, pickle.HIGHEST_PROTOCOL)))
        put(self, message)

    monkeypatch.setattr(Writer, "put", counted)
    for _ in range(2):
        got = ask(engine, "car", itemgetter(0), [car, car])
        settled(engine)
        assert got[0] is car
    assert sent[-1] < 500 < len(pickle.dumps(car)) < max(sent)
    others = [shapes.box_car() for _ in range(3)]  # more than are kept
    for each in (*others, car, *others):
        got = ask(engine, "car", itemgetter(0), [each])
        settled(engine)
        assert got[0] is each


def test_a_killed_process_is_asked_again_once_then_it_is_told(engine):
    got = ask(engine, "sleep", time.sleep, 0.3)
    pid = engine.pid
    killed(engine)
    settled(engine)
    assert got == [None] and engine.pid != pid
    got = ask(engine, "sleep", time.sleep, 60)
    for _ in range(2):
        pid = engine.pid
        killed(engine)
        while engine.pid == pid:
            engine.deliver_all()
    settled(engine)
    assert isinstance(got[0], EngineEnded)
    again = ask(engine, "add", math.factorial, 3)
    settled(engine)
    assert again == [6]


def small_search():
    search = shapes.short_search({"roof": ("x", "z")})
    return shapes.car_study(shapes.roof_rig(16, 90), search=search)


def poses(study):
    return [sensor.pose for sensor in study.rig]


def run(engine, watched, step=None):
    def note(found):
        watched.note(found)
        if step is not None:
            step()

    return ask(engine, "job", JobRun, watched.job, "outcome", 0.0, step=note)


def test_a_search_there_has_the_bits_of_one_here(engine):
    study = small_search()
    here = OptimizeJob(small_search())
    list(here)
    watched = WatchedJob(OptimizeJob(study))
    got = run(engine, watched)
    settled(engine)
    (outcome,) = got
    assert outcome.evaluated == here.outcome.evaluated
    assert outcome.after.entropy == here.outcome.after.entropy
    assert outcome.result_cache, "it is not made in the window's process"
    assert result_dict(outcome) | RUN == result_dict(here.outcome) | RUN
    assert outcome.study.vehicle is study.vehicle, "the mesh is not sent back"
    assert watched.seen.curve == here.curve
    assert poses(watched.seen.best) == poses(here.best)
    assert watched.seen.best.rig["roof"].model is study.rig["roof"].model
    assert watched.seen.evaluations == here.evaluations and watched.job.evaluations == 0


def test_a_search_whose_process_is_killed_goes_on_where_it_was(engine):
    here = OptimizeJob(small_search())
    list(here)
    watched = WatchedJob(OptimizeJob(small_search()))
    kills = []
    known = []

    def step():
        known.append(len(watched.job.journal.entries))
        if watched.seen.evaluations >= 4 and not kills:
            kills.append(engine.pid)
            killed(engine)

    got = run(engine, watched, step)
    settled(engine)
    assert kills and any(known) and got[0].evaluated == here.outcome.evaluated
    assert got[0].after.entropy == here.outcome.after.entropy


def test_a_stopped_search_keeps_the_best_and_a_dropped_one_nothing(engine):
    for presses in (1, 2, 3):
        watched = WatchedJob(OptimizeJob(small_search()))
        pressed = []

        def step(watched=watched, pressed=pressed, presses=presses):
            if watched.seen.evaluations >= 2 and not pressed:
                pressed.append(presses)
                for _ in range(min(presses, 2)):
                    engine.cancel("job")
                if presses == 3:
                    engine.drop("job")

        got = run(engine, watched, step)
        settled(engine)
        assert pressed
        if presses == 3:
            assert not got
        else:
            assert got[0].stopped and (got[0].robustness is None) is (presses == 2)


def test_a_process_that_cannot_start_is_told_in_a_line(engine, monkeypatch):
    kept = ask(engine, "kept", time.sleep, 60)
    killed(engine)
    spawn = multiprocessing.get_context("spawn").Process

    def refuse(self):
        raise OSError(errno.ENOMEM, os.strerror(errno.ENOMEM))

    open_before = len(os.listdir("/dev/fd")) if os.path.exists("/dev/fd") else 0
    with monkeypatch.context() as patch:
        patch.setattr(spawn, "start", refuse)
        while engine.busy():
            engine.deliver_all()
        refused = ask(engine, "new", math.factorial, 3)
        assert not engine.deliver_all() and engine.pid is None
    for error in (*kept, *refused):
        assert isinstance(error, EngineEnded) and "cannot allocate memory" in str(error)
    if open_before:
        assert len(os.listdir("/dev/fd")) < open_before, "no pipe is left open"
    again = ask(engine, "new", math.factorial, 3)
    settled(engine)
    assert again == [6]


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_nothing_is_left_when_this_side_is_killed(tmp_path):
    """Neither the process, nor the workers of a search that it runs."""
    script = tmp_path / "window.py"
    script.write_text(
        "import sys, time\n"
        "from tests.engine.test_engine_process import *\n"
        "engine = EngineProcess(lambda: {pe.Vehicle: 2}, own_sensors)\n"
        "engine.ask('sleep', time.sleep, (600,), print, print)\n"
        "print(engine.pid, flush=True)\n"
        "time.sleep(600)\n"
    )
    env = {**os.environ, "PYTHONPATH": os.getcwd()}
    window = psutil.Popen([sys.executable, script], stdout=-1, env=env)
    child = psutil.Process(int(window.stdout.readline()))
    window.send_signal(signal.SIGKILL)
    window.wait()
    child.wait(HANG_S)


def test_without_a_process_the_same_functions_are_called_here():
    got = []
    call_here(math.factorial, (4,), got.append, got.append)
    call_here(math.sqrt, (-1.0,), got.append, got.append)
    steps = []
    call_here(JobRun, (OptimizeJob(small_search()),), got.append, got.append, step=steps.append)
    assert got[0] == 24 and isinstance(got[1], ValueError) and got[2].kind == "optimize" and steps
