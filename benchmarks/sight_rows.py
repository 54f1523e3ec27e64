"""What a rig sees, after a sensor moved: against a score of 262,144 samples after the same move."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import pe_core as pe
from pe_tools.graphics import simplified

from .problems import car, four_on_car, moved_a_little
from .timing import Timing, best, best_in_turn, peak_mb

SAMPLES = 262_144


def live_map() -> Timing:
    """The map that follows a drag."""
    return _after_a_move("ground map of 1 m", lambda view, rig: view.ground(rig))


def fine_map() -> Timing:
    """The map when the hand rests."""
    return _after_a_move("ground map of 0.25 m", lambda view, rig: view.ground(rig, step=0.25))


def blind_ground() -> Timing:
    """Blind ground of what is half a metre tall."""
    return _after_a_move("blind ground at 0.5 m", lambda view, rig: view.blind(rig, 0.5))


def reach() -> Timing:
    """Reach in 72 directions, of the rig and of each sensor."""
    return _after_a_move("reach for a pedestrian", lambda view, rig: view.reach(rig, "pedestrian"))


def simplify() -> Timing:
    """Millions of triangles to 200,000, against the tree that casting rays needs of them."""
    vehicle = car(2_000_000)
    ours, _ = best(lambda: simplified(vehicle), 2)
    peak = peak_mb()
    fresh = pe.Vehicle(vehicle.triangles)
    theirs, _ = best(lambda: fresh.seen_from((0.0, 0.0, 2.0)), 1)
    work = f"simplify {len(vehicle.triangles):,} triangles"
    return Timing(work, ours, peak, "their tree", yardstick_s=theirs)


def _after_a_move(label: str, look: Callable[[pe.Sight, pe.Rig], object]) -> Timing:
    """Look again after one Pandar64 of four sensors moved."""
    study = four_on_car()
    view = study.sight()
    evaluator = study.evaluator(SAMPLES)
    rigs = [moved_a_little(study.rig, along) for along in np.linspace(0.0, 0.05, 12)]
    look(view, study.rig)
    evaluator.entropy(study.rig)
    ours = iter(rigs)
    theirs = iter(rigs)
    mine, yardstick = best_in_turn(
        lambda: look(view, next(ours)), lambda: evaluator.entropy(next(theirs)), len(rigs)
    )
    work = f"{label}, one Pandar64 of four sensors moved"
    return Timing(work, mine, peak_mb(), f"score of {SAMPLES:,} samples", yardstick_s=yardstick)
