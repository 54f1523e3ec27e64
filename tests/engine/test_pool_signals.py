"""A signal that arrives while a task is submitted waits until the task is: no lock stays taken."""

import os
import signal
from collections.abc import Iterator

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


@pytest.mark.usefixtures("handler")
def test_a_handler_raises_after_the_submission_and_the_pool_still_ends(monkeypatch):
    with Processes(1) as processes:
        assert processes.submit(int, "7").result() == 7
        numbers, whole = processes._pool._work_ids, []
        put = numbers.put

        def put_meanwhile(number: int) -> None:
            os.kill(os.getpid(), signal.SIGTERM)
            put(number)
            whole.append(number)

        monkeypatch.setattr(numbers, "put", put_meanwhile)
        with pytest.raises(Ended):
            processes.submit(int, "8")
        assert whole, "the task is in the pool's queue before the handler raises"
        monkeypatch.setattr(numbers, "put", put)
        assert processes.submit(int, "9").result() == 9


def test_a_worker_can_be_ended_by_a_signal():
    with Processes(1) as processes:
        blocked = processes.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
    assert signal.SIGTERM not in blocked
