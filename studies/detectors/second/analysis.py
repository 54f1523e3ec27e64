"""What the runs of the second plan say, by its rules; no verdict before a part is done."""

from __future__ import annotations

import numpy as np

from ...ranks import holm
from ...results_file import Json
from ..analysis import HOLDS, REFUTED, UNDECIDED, Results, of_runs
from ..rank_tests import bca_interval, partial_rho, permutation_p, permutation_p_beyond, rho_within
from ..scores import COVERAGE, EXPECTED_AP, PRIMARY
from .plan import EQUAL_M, GOOD, SecondPlan, arm_lidar, second_runs

BEYOND = "perception entropy beyond coverage"
STUDENT_3 = 3.1824
"""Student's quantile at 0.975 for three degrees of freedom: four placements."""


def second_analysis(plan: SecondPlan, results: Results, scores: Results) -> Json:
    """Return the runs done and planned, and of each part that is done its figures and verdicts."""
    of_part = {
        name: [run for run in second_runs(plan) if run.design == name] for name in (EQUAL_M, GOOD)
    }
    done = {name: all(run.name in results for run in planned) for name, planned in of_part.items()}
    return {
        "done": len(results),
        "planned": sum(map(len, of_part.values())),
        EQUAL_M: _arms(plan, results) if done[EQUAL_M] else None,
        GOOD: _good(plan, results, scores) if done[GOOD] and scores else None,
    }


def tie_verdict(low: float, high: float, tie: float) -> str:
    """Return whether arms with equal m tie: within +-`tie`, wholly without, or not decided."""
    if -tie <= low and high <= tie:
        return HOLDS
    return REFUTED if low > tie or high < -tie else UNDECIDED


def _arms(plan: SecondPlan, results: Results) -> Json:
    """Return AP by rows, and the differences from the first arm with their intervals."""
    runs = [run for run in second_runs(plan) if run.design == EQUAL_M]
    rows, aps = plan.equal_m["rows"], {}
    for count in rows:
        lidar = arm_lidar(plan, count)
        own = [run for run in runs if run.placement and run.placement.lidar is lidar]
        aps[count] = of_runs(EQUAL_M, own, results).samples.ap
    found: Json = {"ap": {str(n): ap.round(4).tolist() for n, ap in aps.items()}, "minus_first": {}}
    for count in rows[1:]:
        less = aps[count] - aps[rows[0]]
        half = STUDENT_3 * float(less.std(ddof=1)) / np.sqrt(len(less))
        low, high = float(less.mean() - half), float(less.mean() + half)
        found["minus_first"][str(count)] = {
            "mean": round(float(less.mean()), 4),
            "interval": [round(low, 4), round(high, 4)],
            "tie": tie_verdict(low, high, plan.equal_m["tie_ap"]),
        }
    return found


def _good(plan: SecondPlan, results: Results, scores: Results) -> Json:
    """Return rho of each figure with the AP of the last seed, in the half chosen by the first."""
    runs = [run for run in second_runs(plan) if run.design == GOOD]
    whole = of_runs(GOOD, runs, results)
    index, half = whole.samples.better_half()
    rule, seed = plan.study.statistics, plan.study.seed
    value = {name: all_of[index] for name, all_of in whole.all_values(scores).items()}
    found: Json = {"placements": [whole.chosen[k].name for k in index], "figures": {}}
    coverage, p_values = value[COVERAGE], {}
    for name in (PRIMARY, EXPECTED_AP, COVERAGE):
        rho = float(rho_within(value[name], half.ap, half.members))
        interval, _ = bca_interval(value[name], half, rule, seed)
        p_values[name] = permutation_p(value[name], half, rule, seed)
        found["figures"][name] = {"rho": rho, "interval": interval}
    rho = float(partial_rho(value[PRIMARY], half.ap, coverage, half.members))
    interval, _ = bca_interval(value[PRIMARY], half, rule, seed, coverage)
    p_values[BEYOND] = permutation_p_beyond(value[PRIMARY], coverage, half, rule, seed)
    found["figures"][BEYOND] = {"rho": rho, "interval": interval}
    for (name, p), corrected in zip(p_values.items(), holm(list(p_values.values())), strict=True):
        row = found["figures"][name]
        row |= {"p": p, "p_holm": corrected}
        row["verdict"] = rank_verdict(row, rule.alpha, plan.good["useful_rho"])
    return found


def rank_verdict(row: Json, alpha: float, useful: float) -> str:
    """Return whether a figure ranks among the good, by its p after Holm and its interval."""
    if row["p_holm"] < alpha and row["rho"] > 0.0:
        return HOLDS
    return REFUTED if row["interval"][1] < useful else UNDECIDED
