"""Requirements after a sensor moved: against a score of 262,144 samples after the same move."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

import pe_core as pe
from pe_core.study import requirement_file

from .problems import four_on_car, moved_a_little
from .timing import Timing, best_of_processor, peak_mb

SAMPLES = 262_144
NINE = (
    "r159_crossing",
    "r159_longitudinal",
    "r159_annex3",
    "r151_moving",
    "r158_camera",
    "r158_detection",
    "ncap26_forward_child",
    "ncap26_reverse_static",
    "perceptor_ground",
)
TWELVE = (*NINE, "fmvss111_rear", "r151_static_crossing", "ncap26_frontal_pedestrian")
"""Three of them ask for a share of the body."""


def nine_presets_preview() -> Timing:
    """Verdicts that follow a drag."""
    return _after_a_move("nine presets, preview", _checked(preview=True))


def twelve_presets_with_shares_preview() -> Timing:
    """The same of a dozen requirements, three of which ask for a share of the body."""
    label = "twelve presets, three with a share, preview"
    return _after_a_move(label, _checked(preview=True, names=TWELVE))


def nine_presets() -> Timing:
    """Verdicts with margins when the hand rests."""
    return _after_a_move("nine presets with margins", _checked(preview=False))


def _checked(preview: bool, names: Sequence[str] = NINE) -> Callable[[pe.Rig], object]:
    study = four_on_car()
    presets = requirement_file.presets()
    requirements = [presets[name].requirement() for name in names]
    checker = pe.requirements.RequirementChecker(requirements, study.vehicle, space=study.space)
    return lambda rig: checker.check(rig, preview=preview)


def _after_a_move(label: str, look: Callable[[pe.Rig], object]) -> Timing:
    """Look again after one Pandar64 of four sensors moved."""
    study = four_on_car()
    evaluator = study.evaluator(SAMPLES)
    look(study.rig)
    evaluator.entropy(study.rig)
    rigs = [moved_a_little(study.rig, along) for along in np.linspace(0.004, 0.05, 12)]
    ours = iter(rigs)
    theirs = iter(rigs)
    mine = best_of_processor(lambda: look(next(ours)), len(rigs))
    yardstick = best_of_processor(lambda: evaluator.entropy(next(theirs)), len(rigs))
    work = f"{label}, one Pandar64 of four sensors moved, processor time"
    return Timing(work, mine, peak_mb(), f"score of {SAMPLES:,} samples", yardstick_s=yardstick)
