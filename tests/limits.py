"""What a test may take, and what it may leave behind.

A test fails when its process has used much processor time: that is the same on a busy machine. The
limit by the clock, `timeout` in pyproject.toml, is for a test that waits for ever and uses none; it
is so long that no busy machine reaches it. After a failure all processes end that were started.
"""

import contextlib
import itertools
import os
import signal
import time

import psutil
import pytest

PROCESSOR_LIMIT_S = 600
"""Of the setup, the call or the teardown of a test. The slowest takes a fifth of it."""
HANG_S = 900
"""So long does a test wait for a process or a window, which hangs if it takes longer [s]."""
MARK = "PE_TEST_PHASE"
"""Variable of the environment by which a process is known whose parent has ended."""
CLOCK_TICK_S = 0.05
"""The system rounds the time at which a process begins."""

_phases = itertools.count()


def patience(seconds: float) -> float:
    """Return how long to wait for what takes so long on a quiet machine: longer on a busy one."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    return seconds * max(1.0, load / (os.cpu_count() or 1))


@contextlib.contextmanager
def limited_processor_time():
    """Fail when this process uses more than `PROCESSOR_LIMIT_S`; without POSIX timers, nothing."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def end(*_):
        pytest.fail(f"more than {PROCESSOR_LIMIT_S} s of processor time")

    before = signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, PROCESSOR_LIMIT_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def end_processes(mark: str, since: float) -> None:
    """End the processes that began since then [s]: descendants, and all that carry the mark."""
    found = {p for p in psutil.Process().children(recursive=True) if _began(p) >= since}
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(MARK) == mark:
                found.add(process)
    for process in found:
        with contextlib.suppress(psutil.Error):
            process.kill()
    psutil.wait_procs(found, timeout=10.0)


def _began(process: psutil.Process) -> float:
    try:
        return process.create_time()
    except psutil.Error:
        return 0.0


def _within_limits():
    mark = os.environ[MARK] = f"{os.getpid()}-{next(_phases)}"
    since = time.time() - CLOCK_TICK_S
    try:
        with limited_processor_time():
            return (yield)
    except pytest.skip.Exception:
        raise
    except BaseException:
        end_processes(mark, since)
        raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item):
    """Limit what fixtures take."""
    return (yield from _within_limits())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Limit what a test takes."""
    return (yield from _within_limits())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item):
    """Limit what the end of fixtures takes."""
    return (yield from _within_limits())


@pytest.fixture
def heeded_signals():
    """Heed Ctrl-C and hangups, here and in processes that are started, whatever the caller ignores.

    A shell ignores Ctrl-C for what it starts in the background, `nohup` hangups. Tests that send
    signals ask for this; others go on being ended, or not, as their caller wishes.
    """
    wanted = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    if hasattr(signal, "SIGHUP"):
        wanted[signal.SIGHUP] = signal.SIG_DFL
    before = {number: signal.signal(number, handler) for number, handler in wanted.items()}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)
