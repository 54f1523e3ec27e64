"""Signals that end a run: the first ones end its parts gracefully, the next one exits."""

import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import NoReturn

from pe_core.base.files import finish_writing

FATAL = 128  # Exit status of a process that a signal ended, less the signal's number
NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


class Interrupted(KeyboardInterrupt):
    """Raised when a signal ends the work; `note` describes what happened to the results."""

    def __init__(self, signum: int = signal.SIGINT, note: str = "") -> None:
        super().__init__()
        self.signum = signum
        self.note = note


@contextmanager
def _handled(numbers: Iterable[int], handler: Callable[[int, object], None]) -> Iterator[None]:
    """Have a function handle signals meanwhile; where that is not this thread's, the host does."""
    before = {}
    with suppress(ValueError):  # not the main thread
        for number in numbers:
            before[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, old in before.items():
            # One that is not Python's own (inside Blender) cannot be restored.
            default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
            signal.signal(number, default if old is None else old)


def _numbers() -> list[signal.Signals]:
    numbers = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]
    ignored = {n for n in numbers if signal.getsignal(n) is signal.SIG_IGN}
    return [n for n in numbers if n == signal.SIGINT or n not in ignored]  # as under nohup


@contextmanager
def signals_interrupt() -> Iterator[None]:
    """Have SIGTERM and SIGHUP raise `Interrupted`, as Ctrl-C raises KeyboardInterrupt. By default
    they would end the program without cleanup and without a message."""

    def handler(signum: int, _frame: object) -> None:
        raise Interrupted(signum)

    with _handled([number for number in _numbers() if number != signal.SIGINT], handler):
        yield


@contextmanager
def noted_when_interrupted(note: str) -> Iterator[None]:
    """Add a note about the results to the message of an interruption."""
    try:
        yield
    except KeyboardInterrupt as error:
        signum = getattr(error, "signum", signal.SIGINT)
        raise Interrupted(signum, getattr(error, "note", "") or note) from None


@dataclass
class Received:
    """The received signal; None before the first."""

    signum: int | None = None

    def status(self, otherwise: int) -> int:
        """Return the exit status for the signal; `otherwise` without a signal."""
        return otherwise if self.signum is None else FATAL + self.signum


@contextmanager
def stop_at_first(stop: Callable[[], object]) -> Iterator[Received]:
    """Call `stop` at Ctrl-C, SIGTERM and SIGHUP; raise `Interrupted` at the second one, or later
    where `stop` says that there was something left to stop."""
    received = Received()

    def handler(signum: int, _frame: object) -> None:
        is_first = received.signum is None
        received.signum = received.signum or signum
        if not (stop() or is_first):
            raise Interrupted(signum)

    with _handled(_numbers(), handler):
        yield received


def leave(status: int, *, at_once: bool = False) -> NoReturn:
    """Exit the process; without waiting for its threads after a signal or with `at_once`."""
    if status <= FATAL and not at_once:
        sys.exit(status)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, OSError, ValueError):  # it is closed, or nobody reads it
            stream.flush()
    finish_writing()
    if "multiprocessing.util" in sys.modules:
        # Of semaphores: Python would warn of them later, after the prompt.
        sys.modules["multiprocessing.util"]._run_finalizers(0)
    os._exit(status)
