"""A signal that arrives while a task is submitted waits until the task is: no lock stays taken."""

import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator

import pytest

from pe_core.search.processes import Processes

pytestmark = pytest.mark.skipif(
    not hasattr(signal, "pthread_sigmask"), reason="signals of POSIX systems"
)


class Ended(Exception):
    """What the handler raises."""


@pytest.fixture
def handler() -> Iterator[None]:
    def end(*_: object) -> None:
        raise Ended

    before = signal.signal(signal.SIGTERM, end)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture
def other_thread() -> Iterator[None]:
    """A thread that blocks no signal: the system gives it those that the main thread blocks."""
    ended = threading.Event()
    thread = threading.Thread(target=ended.wait)
    thread.start()
    yield
    ended.set()
    thread.join()


@pytest.fixture
def kill() -> Iterator[Callable[[], None]]:
    """Send SIGTERM to this process, and wait until a thread has got it."""
    ours, systems = socket.socketpair()
    systems.setblocking(False)
    ours.settimeout(10.0)
    before = signal.set_wakeup_fd(systems.fileno())

    def kill() -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        assert ours.recv(1) == bytes([signal.SIGTERM])

    yield kill
    signal.set_wakeup_fd(before)
    for end in (ours, systems):
        end.close()


@pytest.mark.usefixtures("handler", "other_thread")
def test_a_handler_raises_after_the_submission_and_the_pool_still_ends(monkeypatch, kill):
    with Processes(1) as processes:
        assert processes.submit(int, "7").result() == 7
        numbers, whole = processes._pool._work_ids, []
        put = numbers.put

        def put_meanwhile(number: int) -> None:
            kill()
            put(number)
            whole.append(number)

        monkeypatch.setattr(numbers, "put", put_meanwhile)
        with pytest.raises(Ended):
            processes.submit(int, "8")
        monkeypatch.setattr(numbers, "put", put)
        answer = processes.submit(int, "9")
        assert whole, "the task is in the pool's queue before the handler raises"
        assert answer.result() == 9


def test_a_worker_can_be_ended_by_a_signal():
    with Processes(1) as processes:
        blocked = processes.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
    assert signal.SIGTERM not in blocked
