"""What the runs before and after a search say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...results_file import Json
from ..analysis import HOLDS, OPEN, REFUTED, ApOf, Results, mean_ap, mean_ap_in
from ..rank_tests import student_interval
from ..scores import TRAFFIC
from .plan import START, AfterSearchPlan, SearchedRig

Aps = Sequence[float | None]
"""AP of a placement by seed; None for a run that is missing."""
INTERVAL_SEEDS = 3
"""`student_interval` is for so many."""


def after_search_analysis(plan: AfterSearchPlan, results: Results, scores: Results) -> Json:
    """Return all that follows from the results of the runs, as JSON data."""
    planned = len(plan.rigs) * len(plan.whats) * len(plan.study.training.seeds)
    rigs = {rig.name: _of_rig(plan, rig, results, scores) for rig in plan.rigs}
    if len(results) == planned:
        for rig in plan.rigs:
            rigs[rig.name]["by_ring"] = _by_ring(plan, rig, results)
    verdicts = {o: [rig["after"][o]["verdict"] for rig in rigs.values()] for o in plan.objectives}
    answers = {objective: _over_rigs(found) for objective, found in verdicts.items()}
    return {"done": len(results), "planned": planned, "rigs": rigs, "answers": answers}


def _of_rig(plan: AfterSearchPlan, rig: SearchedRig, results: Results, scores: Results) -> Json:
    """Return AP and scores of the placements of a rig, and the differences from its start."""
    aps = {what: _aps(plan, rig, what, results) for what in plan.whats}
    return {
        "placements": {
            what: {"ap": aps[what], **_scores(scores.get(rig.placement_name(what)))}
            for what in plan.whats
        },
        "after": {o: _comparison(plan, aps[START], aps[o]) for o in plan.objectives},
    }


def _by_ring(plan: AfterSearchPlan, rig: SearchedRig, results: Results) -> Json:
    """Return by ring how much more is found after the last objective's search than the first's."""
    ends = plan.objectives[0], plan.objectives[-1]
    return {
        ring: _difference(plan, *(_aps(plan, rig, o, results, mean_ap_in(ring)) for o in ends))
        for ring in plan.study.precision.rings
    }


def _aps(
    plan: AfterSearchPlan, rig: SearchedRig, what: str, results: Results, ap_of: ApOf = mean_ap
) -> list[float | None]:
    runs = [f"{rig.placement_name(what)}-s{seed}" for seed in plan.study.training.seeds]
    return [ap_of(results[run]) if run in results else None for run in runs]


def _scores(scores: Json | None) -> Json:
    if scores is None:
        return {"entropy": None, "expected_ap": None}
    found = scores["road"]["entropy"], scores[TRAFFIC]["ap"]
    return {"entropy": round(found[0], 4), "expected_ap": round(found[1], 4)}


def _comparison(plan: AfterSearchPlan, before: Aps, after: Aps) -> Json:
    """Return the differences of AP by seed, their mean and interval, and the verdict."""
    found = _difference(plan, before, after)
    if found["interval"] is None:
        return {**found, "verdict": OPEN}
    return {**found, "verdict": HOLDS if found["interval"][0] > 0.0 else REFUTED}


def _difference(plan: AfterSearchPlan, before: Aps, after: Aps) -> Json:
    """Return the differences of AP by seed, their mean, and its interval if all seeds are there."""
    pairs = zip(before, after, strict=True)
    found = [b - a for a, b in pairs if a is not None and b is not None]
    mean = round(float(np.mean(found)), 4) if found else None
    data: Json = {"differences": [round(d, 4) for d in found], "mean": mean, "interval": None}
    if len(found) < len(before) or len(found) != INTERVAL_SEEDS:
        return data
    low, high = student_interval(found)
    return {**data, "interval": [round(low, 4), round(high, 4)]}


def _over_rigs(verdicts: Sequence[str]) -> str:
    """Return `HOLDS` where it holds for all rigs; open while it is open for one."""
    if OPEN in verdicts:
        return OPEN
    return HOLDS if set(verdicts) == {HOLDS} else REFUTED
