"""Work beside the window: the latest wish is done, answers come in Blender's own turn."""

import threading

import pytest

bpy = pytest.importorskip("bpy")

from blender_addon import worker  # noqa: E402


class Timers:
    """Blender's timers as a list that a test calls itself."""

    def __init__(self):
        self.waiting = []

    def is_registered(self, function):
        return any(each is function for each in self.waiting)

    def register(self, function, **_options):
        self.waiting.append(function)

    def unregister(self, function):
        self.waiting = [each for each in self.waiting if each is not function]

    def turn(self):
        self.waiting = [each for each in self.waiting if each() is not None]


@pytest.fixture
def timers(monkeypatch):
    """A Blender with a window, as the worker sees it."""
    made = Timers()
    app = type("App", (), {"timers": made, "background": False})
    monkeypatch.setattr(worker, "bpy", type("Bpy", (), {"app": app}))
    return made


@pytest.fixture
def desk(timers):
    made = worker.Worker()
    yield made
    made.stop()


class Gate:
    """Work that waits until it is let through."""

    def __init__(self, desk, topic="gate"):
        self.begun, self.open = threading.Event(), threading.Event()
        self.answers = []
        desk.ask(topic, self.work, self.answers.append, self.answers.append)
        assert self.begun.wait(10.0)

    def work(self):
        self.begun.set()
        assert self.open.wait(10.0)
        return "gate"


def settle(desk, timers):
    while desk.busy():
        timers.turn()
    timers.turn()


def test_the_latest_wish_of_a_topic_is_done_and_the_ones_between_are_not(desk, timers):
    gate, done, got = Gate(desk), [], []
    for number in range(5):
        desk.ask("score", lambda n=number: done.append(n) or n, got.append, got.append)
    gate.open.set()
    settle(desk, timers)
    assert done == [4] and got == [4] and gate.answers == ["gate"]


def test_topics_take_turns_in_the_order_of_their_last_wishes(desk, timers):
    gate, done = Gate(desk), []
    for topic in ("a", "b", "a"):
        desk.ask(topic, lambda t=topic: done.append(t), lambda _: None, lambda _: None)
    gate.open.set()
    settle(desk, timers)
    assert done == ["b", "a"]


def test_answers_are_delivered_by_the_timer_on_the_thread_that_calls_it(desk, timers):
    where = []
    desk.ask(
        "t",
        lambda: where.append(threading.get_ident()),
        lambda _: where.append(threading.get_ident()),
        lambda _: None,
    )
    settle(desk, timers)
    assert where[0] != threading.get_ident() and where[1] == threading.get_ident()
    assert timers.waiting == []


def test_what_work_raises_reaches_the_one_who_asked(desk, timers):
    answers, problems = [], []
    desk.ask("t", lambda: 1 / 0, answers.append, problems.append)
    settle(desk, timers)
    assert not answers and isinstance(problems[0], ZeroDivisionError)


def test_a_dropped_topic_is_never_delivered(desk, timers):
    gate = Gate(desk, "dropped")
    desk.drop("dropped")
    gate.open.set()
    settle(desk, timers)
    assert gate.answers == []


def test_stopping_leaves_no_thread_and_no_timer_and_work_can_begin_again(desk, timers):
    before = threading.active_count()
    desk.ask("t", lambda: 1, lambda _: None, lambda _: None)
    desk.stop()
    assert threading.active_count() == before and timers.waiting == [] and not desk.busy()
    got = []
    desk.ask("t", lambda: 2, got.append, got.append)
    settle(desk, timers)
    assert got == [2]


def test_without_a_window_work_is_done_at_once():
    got = []
    worker.background_worker.ask("t", lambda: 3, got.append, got.append)
    assert got == [3] and not worker.background_worker.busy()
