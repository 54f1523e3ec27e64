"""A request to the engine's process: what it costs the side that asks, and until the answer."""

from __future__ import annotations

import time

import numpy as np

import pe_core as pe
from pe_core.base import RecentCache
from pe_tools.engine_process import EngineProcess

from .problems import car, four_on_car, moved_a_little
from .timing import Timing, best_in_turn, peak_mb

SAMPLES = 32_768
MOVES = 12
_evaluators: RecentCache[pe.RigEvaluator] = RecentCache()


def score(study: pe.Study, rig: pe.Rig) -> float:
    """Return the entropy of a rig; the evaluator is kept for the vehicle."""
    evaluator = _evaluators.made(id(study.vehicle), lambda: study.evaluator(SAMPLES))
    return evaluator.entropy(rig)


def request_of_a_move() -> Timing:
    """What a drag's callback does, against the score that it asks for."""
    return _asked(sent=True)


def answer_to_a_move() -> Timing:
    """The score of a move by the process, against the same score here."""
    return _asked(sent=False)


def _asked(*, sent: bool) -> Timing:
    study = four_on_car()
    rigs = [moved_a_little(study.rig, along) for along in np.linspace(0.0, 0.05, 2 * MOVES)]
    engine = EngineProcess(lambda: {pe.Vehicle: 2, pe.Prior: 2, pe.Lidar: 64, pe.Camera: 64})
    found: list[object] = []

    def ask(rig: pe.Rig) -> None:
        engine.ask("score", score, (study, rig), found.append, found.append)

    def answered() -> None:
        while engine.deliver_all():
            time.sleep(0.0)

    ask(study.rig)
    answered()
    score(study, study.rig)
    ours = iter(rigs)
    theirs = iter(rigs)

    def work() -> None:
        ask(next(ours))
        if not sent:
            answered()

    def yardstick() -> None:
        answered()
        score(study, next(theirs))

    mine, other = best_in_turn(work, yardstick, MOVES)
    answered()
    engine.stop()
    what = "asked of the engine's process" if sent else "by the engine's process"
    work_text = f"score of {SAMPLES:,} samples after a move, {what}"
    return Timing(work_text, mine, peak_mb(), "the same score here", yardstick_s=other)


def mesh_sent() -> Timing:
    """A mesh of a million triangles sent, against copying it."""
    vehicle = car(1_000_000)
    engine = EngineProcess(lambda: {pe.Vehicle: 1})
    found: list[object] = []
    engine.ask("up", abs, (-1,), found.append, found.append)
    while engine.deliver_all():
        time.sleep(0.0)

    def work() -> None:
        fresh = pe.Vehicle(vehicle.triangles)
        engine.ask("mesh", getattr, (fresh, "part_names"), found.append, found.append)
        while engine.deliver_all():
            time.sleep(0.0)

    mine, other = best_in_turn(work, lambda: pe.Vehicle(vehicle.triangles.copy()), 3)
    engine.stop()
    count = f"{len(vehicle.triangles):,} triangles"
    return Timing(
        f"send {count} to the engine's process", mine, peak_mb(), "make it here", yardstick_s=other
    )
