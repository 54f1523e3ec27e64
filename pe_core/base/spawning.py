"""How processes are started anywhere, inside Blender too, and how they end with their parent."""

import _thread
import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing import resource_tracker
from types import ModuleType
from typing import Any

from .files import finish_writing
from .lazy_threads import threads

TERMINAL_SIGNALS = ("SIGINT", "SIGHUP")
"""Signals that a terminal sends to all processes at once; Windows has no SIGHUP.

SIGTERM is not among them: a pool in which one process died ends the others by it, and waits until
they are gone."""

SAFE_PATH = "PYTHONSAFEPATH"
"""Variable that keeps the folder of the script, or the current one, out of `sys.path`; as ``-P``.
(Inside Blender, Python runs isolated and has its processes run so, too.)"""
_environment_lock = _thread.RLock()
"""Held while `SAFE_PATH` is set. Of `_thread`: Blender's own process has no `lazy_threads`."""
BEGINNING = """
import sys, types
for name, folder in {packages!r}:
    if name not in sys.modules:
        sys.modules[name] = types.ModuleType(name)
        sys.modules[name].__path__ = [folder]
from importlib import import_module
import_module({module!r}).{function}(*arguments)
"""


def beginning(module: str, function: str, packages: Iterable[tuple[str, str]]) -> str:
    """Return the first code that a process runs: it calls a function with `arguments`. Packages
    whose first lines would import Blender are not run in it: empty packages of these names and
    folders stand for them. It is text, because nothing can be imported yet."""
    return BEGINNING.format(packages=list(packages), module=module, function=function)


def packages_around() -> list[tuple[str, str]]:
    """Names of the packages that contain the engine, outermost first, and the folder of each."""
    names = __name__.split(".")[:-3]  # the engine, its room, and this module come last
    packages = []
    for number in range(1, len(names) + 1):
        inner = import_module(".".join(__name__.split(".")[: number + 1]))
        packages.append((".".join(names[:number]), os.path.dirname(inner.__path__[0])))
    return packages


@contextmanager
def without_main() -> Iterator[None]:
    """Hide the main script from processes that start: they would run it, outside Blender."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main


@contextmanager
def signals_blocked() -> Iterator[None]:
    """Hold SIGTERM and `TERMINAL_SIGNALS` back here, and block them in processes started meanwhile.

    A handler that raises in the middle of `submit` would leave a lock of the pool taken, for which
    its thread then waits for ever. A terminal sends its signals to all processes at once, also to
    one that does not ignore them yet: a worker would end in the middle of an import, with a
    traceback. The process that tracks semaphores is started here, too: it ignores all but SIGHUP.
    """
    names = ("SIGTERM", *TERMINAL_SIGNALS)
    numbers = {getattr(signal, name) for name in names if hasattr(signal, name)}
    with _handlers_held(numbers):
        if not hasattr(signal, "pthread_sigmask"):  # Windows blocks no signals
            yield
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
        try:
            resource_tracker.ensure_running()
            signal.pthread_sigmask(signal.SIG_BLOCK, numbers)  # ensure_running has unblocked SIGINT
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def starting_processes() -> Iterator[None]:
    """Start processes here: signals are held back as in `signals_blocked`, and the processes import
    no module from the current folder, which may be a stranger's."""
    with _safe_path(), signals_blocked():
        yield


@contextmanager
def _safe_path() -> Iterator[None]:
    """Keep the current folder out of `sys.path` of processes that are started meanwhile.

    Python starts them, and the one that tracks semaphores, with ``-c``: without `SAFE_PATH` a file
    ``pickle.py`` of the current folder would be run in place of Python's own module. One thread at
    a time: another one's end must not take the variable away."""
    with _environment_lock:
        before = os.environ.get(SAFE_PATH)
        os.environ[SAFE_PATH] = "1"
        try:
            yield
        finally:
            if before is None:
                del os.environ[SAFE_PATH]
            else:
                os.environ[SAFE_PATH] = before


@contextmanager
def _handlers_held(numbers: Iterable[int]) -> Iterator[None]:
    """Call Python's handlers of signals after the block. To block signals is not enough: another
    thread then gets them, and Python calls their handlers in the main thread all the same; in other
    threads never."""
    before: dict[int, Any] = {}
    came: list[int] = []
    try:
        with suppress(ValueError):  # in another thread no handler can be set
            for number in (n for n in numbers if callable(signal.getsignal(n))):
                before[number] = signal.signal(number, lambda number, _: came.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)


@contextmanager
def pipe_errors() -> Iterator[None]:
    """Have a pipe without another end raise an error, and not end this process. Python asks for
    that when it starts, but Blender's own does not. In the main thread only."""
    if not hasattr(signal, "SIGPIPE"):
        yield
        return
    before = signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGPIPE, before)


def belong_to_parent() -> None:
    """In a process: leave signals to the parent process, and end with it."""
    if hasattr(signal, "pthread_sigmask"):  # blocked until now: see `signals_blocked`
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])
    for name in TERMINAL_SIGNALS:
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)

    def end_with_parent() -> None:
        parent = multiprocessing.parent_process()
        assert parent is not None
        multiprocessing.connection.wait([parent.sentinel])
        end_process()

    threads().Thread(target=end_with_parent, daemon=True).start()


def end_process() -> None:
    """End this process at once, whatever its threads do; files that are being written are whole."""
    finish_writing()
    os._exit(1)
