"""The runs before and after a search, their results, and what follows from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..analysis import HOLDS, OPEN, REFUTED, mean_ap, mean_ap_in
from ..plan import GRID, PLAIN
from ..result_files import ResultFiles
from ..runs import Run
from ..scores import TRAFFIC
from .plan import START, AfterSearchPlan, SearchedRig
from .searches import FOLDER, SearchedPlacement, placement_name

Json = dict[str, Any]

INTERVAL_SEEDS = 3
"""Student's quantile has a simple formula for so many seeds."""


def after_search_runs(plan: AfterSearchPlan, placements: Sequence[SearchedPlacement]) -> list[Run]:
    """Return the runs of placements in their order: seed by seed."""
    seeds = plan.study.training.seeds
    return [Run(placement, PLAIN, GRID, seed) for seed in seeds for placement in placements]


def planned_runs(plan: AfterSearchPlan) -> int:
    """Return how many runs there are once all searches are done."""
    return len(plan.rigs) * (1 + len(plan.objectives)) * len(plan.study.training.seeds)


class AfterSearchFiles(ResultFiles[Run]):
    """The results of the runs, in a folder of their own in that of the study."""

    def __init__(
        self, folder: Path, plan: AfterSearchPlan, placements: Sequence[SearchedPlacement]
    ) -> None:
        super().__init__(folder / FOLDER, plan.digest, after_search_runs(plan, placements))


def after_search_analysis(
    plan: AfterSearchPlan, results: Mapping[str, Json], scores: Mapping[str, Json]
) -> Json:
    """Return all that follows from the results of the runs, as JSON data.

    Parameters
    ----------
    plan : AfterSearchPlan
    results : mapping
        Results by the name of the run.
    scores : mapping
        Scores by the name of the placement.
    """
    rigs = {rig.name: _of_rig(plan, rig, results, scores) for rig in plan.rigs}
    if len(results) == planned_runs(plan):
        for rig in plan.rigs:
            rigs[rig.name]["by_ring"] = _by_ring(plan, rig, results)
    return {
        "done": len(results),
        "planned": planned_runs(plan),
        "rigs": rigs,
        "answers": {
            objective: _over_rigs([rig["after"][objective]["verdict"] for rig in rigs.values()])
            for objective in plan.objectives
        },
    }


def _of_rig(
    plan: AfterSearchPlan,
    rig: SearchedRig,
    results: Mapping[str, Json],
    scores: Mapping[str, Json],
) -> Json:
    """Return AP and scores of the placements of a rig, and the differences from its start."""
    names = {what: placement_name(rig, what) for what in (START, *plan.objectives)}
    aps = {what: _aps(plan, name, results) for what, name in names.items()}
    return {
        "placements": {
            what: {"ap": aps[what], **_scores(scores.get(name))} for what, name in names.items()
        },
        "after": {
            objective: _comparison(plan, aps[START], aps[objective])
            for objective in plan.objectives
        },
    }


def _by_ring(plan: AfterSearchPlan, rig: SearchedRig, results: Mapping[str, Json]) -> Json:
    """Return by ring how much more is found after the last objective's search than the first's."""
    first, *_, last = (placement_name(rig, objective) for objective in plan.objectives)
    found = {}
    for ring in plan.study.precision.rings:
        aps = [_aps(plan, name, results, mean_ap_in(ring)) for name in (first, last)]
        found[ring] = _difference(plan, *aps)
    return found


def _aps(
    plan: AfterSearchPlan,
    name: str,
    results: Mapping[str, Json],
    ap_of: Callable[[Json], float] = mean_ap,
) -> list[float | None]:
    """Return the AP of a placement by seed; None for a run that is missing."""
    runs = [f"{name}-s{seed}" for seed in plan.study.training.seeds]
    return [ap_of(results[run]) if run in results else None for run in runs]


def _scores(scores: Json | None) -> Json:
    if scores is None:
        return {"entropy": None, "expected_ap": None}
    found = scores["road"]["entropy"], scores[TRAFFIC]["ap"]
    return {"entropy": round(found[0], 4), "expected_ap": round(found[1], 4)}


def _comparison(
    plan: AfterSearchPlan, before: Sequence[float | None], after: Sequence[float | None]
) -> Json:
    """Return the differences of AP by seed, their mean and interval, and the verdict."""
    found = _difference(plan, before, after)
    if found["interval"] is None:
        return {**found, "verdict": OPEN}
    return {**found, "verdict": HOLDS if found["interval"][0] > 0.0 else REFUTED}


def _difference(
    plan: AfterSearchPlan, before: Sequence[float | None], after: Sequence[float | None]
) -> Json:
    """Return the differences of AP by seed, their mean, and its interval if all seeds are there."""
    pairs = zip(before, after, strict=True)
    found = [b - a for a, b in pairs if a is not None and b is not None]
    mean = round(float(np.mean(found)), 4) if found else None
    data: Json = {"differences": [round(d, 4) for d in found], "mean": mean, "interval": None}
    if len(found) < len(before) or len(found) != INTERVAL_SEEDS:
        return data
    low, high = student_interval(found, plan.confidence)
    return {**data, "interval": [round(low, 4), round(high, 4)]}


def student_interval(values: Sequence[float], confidence: float) -> tuple[float, float]:
    """Return Student's interval of the mean of three values.

    With two degrees of freedom the quantile at p is (2 p - 1) / sqrt(2 p (1 - p)).
    """
    assert len(values) == INTERVAL_SEEDS
    p = (1.0 + confidence) / 2.0
    quantile = (2.0 * p - 1.0) / math.sqrt(2.0 * p * (1.0 - p))
    half = quantile * float(np.std(values, ddof=1)) / math.sqrt(len(values))
    middle = float(np.mean(values))
    return middle - half, middle + half


def _over_rigs(verdicts: Sequence[str]) -> str:
    """Return `HOLDS` where it holds for all rigs; open while it is open for one."""
    if OPEN in verdicts:
        return OPEN
    return HOLDS if set(verdicts) == {HOLDS} else REFUTED
