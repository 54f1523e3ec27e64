"""What the runs with one frame and with several say; no figure before all are done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

import pe_core as pe
from pe_core.base.arrays import Floats, Ints
from pe_core.metric.frames import Frames

from ...ranks import holm
from ...results_file import Json
from ..analysis import HOLDS, UNDECIDED, Results, of_runs
from ..placements import vehicle
from ..plan import StudyPlan
from ..rank_tests import (
    PlacementSamples,
    Resample,
    bca_interval,
    interval,
    permutation_p,
    rho_within,
)
from ..scenes import CLASSES
from ..scores import SPACE
from .plan import FRAMES, FramesPlan, frames_runs

ONE, FIVE, ONE_FRAME = "one", "five", "one_frame"
"""The arms, and where a run has the results of the first."""
BETTER, WORSE, ALIKE = "ranks better", "ranks worse", "alike"
MORE, FEWER = "five frames find more", "five frames find fewer"


def key_of(q: float) -> str:
    """Return the name of the entropy over frames with a process noise q; inf is one frame's."""
    return f"q {q:g}"


def frame_scorer(plan: FramesPlan) -> Callable[[StudyPlan, str, pe.Rig], Json]:
    """Return what scores a rig: entropy of one frame, and over frames with each q of the plan."""

    @cache
    def evaluator(vehicle_name: str, q: float) -> pe.Evaluator:
        rule = plan.motion
        frames = None if np.isinf(q) else Frames(rule.count, q, rule.rate_hz)
        model = pe.PerceptionModel(frames=frames)
        return pe.Evaluator(SPACE, pe.Prior.road(), vehicle(vehicle_name), model=model, workers=1)

    def scored(_: StudyPlan, vehicle_name: str, rig: pe.Rig) -> Json:
        every = (np.inf, plan.q, *plan.other_q)
        return {key_of(q): evaluator(vehicle_name, q).entropy(rig) for q in every}

    return scored


def frames_analysis(plan: FramesPlan, results: Results, scores: Results) -> Json:
    """Return the runs done and planned; with all of them, and scores, figures and verdicts."""
    wanted = frames_runs(plan)
    five = of_runs(FRAMES, wanted, results)
    found: Json = {"runs": {"done": five.done, "planned": five.planned}, "ranks": None}
    if not (five.complete and scores):
        return found
    one = of_runs(FRAMES, wanted, results, lambda run: float(run[ONE_FRAME]["ap"]))
    arms = {ONE: one.samples, FIVE: five.samples}
    value = {
        key: -np.array([scores[p.name][key] for p in five.chosen])
        for key in map(key_of, (np.inf, plan.q, *plan.other_q))
    }
    ranks = {key: {arm: _rank(plan, v, s) for arm, s in arms.items()} for key, v in value.items()}
    judged = [ranks[key][FIVE] for key in (key_of(np.inf), key_of(plan.q))]
    rule = plan.study.statistics
    for row, p in zip(judged, holm([row["p"] for row in judged]), strict=True):
        row |= {"p_holm": p}
        row["verdict"] = HOLDS if p < rule.alpha and row["rho"] > 0.0 else UNDECIDED
    less = {key: _minus(plan, v, value[key_of(np.inf)], five.samples) for key, v in value.items()}
    by_arm = [r[ONE_FRAME] for r in results.values()], list(results.values())
    gained = replace(five.samples, aps=arms[FIVE].aps - arms[ONE].aps)
    return {
        **found,
        "ranks": ranks,
        "minus_one": {k: row for k, row in less.items() if k != key_of(np.inf)},
        "aps_alike": float(rho_within(one.samples.ap, five.samples.ap, five.samples.members)),
        "noise": {arm: round(s.noise, 4) for arm, s in arms.items()},
        "converged": [sum(run["training"]["converged"] for run in of_arm) for of_arm in by_arm],
        "gain": _gain(plan, gained),
        "ap": {arm: _range(s.ap) for arm, s in arms.items()},
        "by_class": {
            name: [
                round(float(np.mean([run["by_class"][name] for run in of_arm])), 4)
                for of_arm in by_arm
            ]
            for name in CLASSES
        },
    }


def difference_verdict(low: float, high: float, alike: float) -> str:
    """Return what the interval of a difference of rho says."""
    if low > 0.0 or high < 0.0:
        return BETTER if low > 0.0 else WORSE
    return ALIKE if -alike <= low and high <= alike else UNDECIDED


def _range(ap: Floats) -> list[float]:
    return [round(float(v), 4) for v in (ap.min(), ap.mean(), ap.max())]


def _rank(plan: FramesPlan, value: Floats, samples: PlacementSamples) -> Json:
    """Return rho with AP, its interval and p."""
    study = plan.study
    return {
        "rho": float(rho_within(value, samples.ap, samples.members)),
        "interval": list(bca_interval(value, samples, study.statistics, study.seed)[0]),
        "p": permutation_p(value, samples, study.statistics, study.seed),
    }


def _minus(plan: FramesPlan, value: Floats, other: Floats, samples: PlacementSamples) -> Json:
    """Return rho of a figure minus that of another, of the same placements and seeds."""

    def less(index: Ints, ap: Floats) -> Floats:
        rho = [rho_within(v[index], ap, samples.members) for v in (value, other)]
        return np.asarray(rho[0] - rho[1])

    def of(drawn: Resample) -> Floats:
        return less(drawn.index, drawn.ap)

    low, high = interval(samples, plan.study.statistics, plan.study.seed, of)
    rho = float(less(np.arange(len(value)), samples.ap))
    verdict = difference_verdict(low, high, plan.alike_rho)
    return {"rho": rho, "interval": [low, high], "verdict": verdict}


def _gain(plan: FramesPlan, gained: PlacementSamples) -> Json:
    """Return AP of five frames minus that of one, mean over the placements."""

    def of(drawn: Resample) -> Floats:
        return np.asarray(drawn.ap.mean(axis=1))

    low, high = interval(gained, plan.study.statistics, plan.study.seed, of)
    verdict = MORE if low > 0.0 else FEWER if high < 0.0 else UNDECIDED
    mean = round(float(gained.ap.mean()), 4)
    return {"mean": mean, "interval": [round(low, 4), round(high, 4)], "verdict": verdict}
