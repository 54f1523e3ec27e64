"""The engine held to its golden cases by its own process: what the preferences show of it."""

from .. import signals
from ..engine import verify
from ..processes import engine_process

TOPIC = "verification"
_lines: list[str] = []


def begin() -> None:
    """Have the engine verified; the preferences show what came of it."""
    _lines.clear()
    engine_process.ask(TOPIC, verify.verify_in_short, arguments=(), deliver=_store, fail=_fail)
    signals.view_changed.emit()


def is_running() -> bool:
    """Whether the engine is being verified."""
    return engine_process.busy(TOPIC)


def lines() -> tuple[str, ...]:
    """Return what came of the last verification: a line in short, and one for each wrong case."""
    return tuple(_lines)


def _store(found: tuple[str, ...]) -> None:
    _lines[:] = found
    signals.view_changed.emit()


def _fail(error: Exception) -> None:
    _store((str(error) or type(error).__name__, "FAILED: the engine could not be verified"))
