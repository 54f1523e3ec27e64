"""The engine's process of this Blender: results are delivered by a timer, on the main thread.

There Blender's data may be read and written. Without a window there is no timer: requests are
called here and at once. The process ends with the file, with the add-on, and with Blender.
"""

import atexit
import traceback
from collections.abc import Callable
from typing import Any

import bpy

from ..engine import advice, catalog, engine_process, jobs, kinds, pe
from ..overlay.request import ViewRequest
from . import analysis_calls

FOLLOWS_MOUSE = engine_process.FOLLOWS_MOUSE
BEHIND = engine_process.BEHIND
JOB = "job"
"""Lanes: what follows the mouse waits for nothing else, and a job keeps nothing waiting."""
POLL_S = 0.005  # How often the timer looks for results, while one is awaited
MAX_MODELS = 256
LIVE_SCORE = "live score of "
OVERLAY = "overlay "
"""How topics begin. Layers are delivered while a view is drawn, as they write nothing into
Blender's data; a score is not, as the sidebar has been drawn by then."""
ADDON = __package__.rpartition(".")[0]
_PACKAGES = (__package__, f"{ADDON}.overlay")


def shared_types() -> dict[type, int]:
    """Return types of objects that are sent once, and how many of each the process keeps."""
    models = {kind.model: MAX_MODELS for kind in kinds.KINDS.values()}
    return {pe.Vehicle: 2, pe.Prior: 4, ViewRequest: 2, jobs.PlaceMap: 2, **models} | {
        advice.FreeRegion: 2
    }


def _setup() -> engine_process.EngineCall:
    """Return what the process has to know besides: own sensors."""
    return catalog.replace_added, (catalog.added(),)


_engine = engine_process.EngineProcess(shared_types, _setup, _PACKAGES)


def ask(
    topic: str,
    function: Callable[..., Any],
    arguments: tuple[Any, ...],
    deliver: Callable[[Any], None],
    fail: Callable[[Exception], None],
    *,
    step: Callable[[Any], None] | None = None,
    lane: str = BEHIND,
) -> None:
    """Have a function of a module without Blender called: see `EngineProcess.ask`."""
    if bpy.app.background:
        engine_process.call_here(function, arguments, deliver, fail, step=step)
        return
    _engine.ask(topic, function, arguments, deliver, fail=fail, step=step, lane=lane)
    if not bpy.app.timers.is_registered(deliver_all):
        bpy.app.timers.register(deliver_all, first_interval=POLL_S, persistent=True)


def deliver_for_view() -> None:
    """Before a view is drawn: deliver what it shows. A timer's turn comes after the redraw."""
    try:
        _engine.deliver_all(OVERLAY)
    except Exception:  # in what takes a result: the view is drawn all the same
        traceback.print_exc()


def begin(*_: object) -> None:
    """After a file was opened: start the process where there are sensors, while Blender draws."""
    sensors = (each.perception_entropy.is_sensor for each in bpy.data.objects)
    if not bpy.app.background and any(sensors):
        ask("begin", analysis_calls.clear, arguments=(), deliver=_ignore, fail=_ignore)


def _ignore(_: object) -> None:
    """Whoever asks next is told what keeps the process from starting."""


def deliver_all() -> float | None:
    """Timer: deliver results; it ends when none is awaited."""
    try:
        return POLL_S if _engine.deliver_all() else None
    except Exception:  # in what takes a result: others are awaited all the same
        traceback.print_exc()
        return POLL_S


cancel = _engine.cancel
drop = _engine.drop
busy = _engine.busy


def stop(*_: object) -> None:
    """Drop all requests, and end the process: another file is opened, or the add-on disabled."""
    if bpy.app.timers.is_registered(deliver_all):
        bpy.app.timers.unregister(deliver_all)
    _engine.stop()
    analysis_calls.clear()


atexit.register(_engine.stop)  # before multiprocessing's own, which waits for processes
