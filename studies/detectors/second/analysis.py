"""What the runs of the second plan say, by its rules; no verdict before a part is done."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from pe_core.base import Floats

from ...ranks import PlacementSamples, holm, rho_within, student_interval
from ...results_file import Json
from ..after_search import on_roofs, placement_name
from ..analysis import HOLDS, REFUTED, UNDECIDED, Results, mean_ap_in, of_mixed, of_runs, rank_of
from ..placements import arm_lidar, good_placements
from ..plan import EQUAL_M, GOOD, LAYOUTS, SEARCHES, Plan, rings_of
from ..runs import Run, parts_of
from ..scores import COVERAGE, EXPECTED_AP, PRIMARY

BEYOND = "perception entropy beyond coverage"
AP_BEYOND = "expected AP beyond coverage"
FINDS_MORE = {-1: "entropy finds more", 1: "expected AP finds more"}


def second_analysis(
    plan: Plan, parts: Mapping[str, Sequence[Run]], results: Results, scores: Results
) -> Json:
    """Return the runs done and planned, and of each part that is done its figures and verdicts.

    `parts` has the runs of each part, as far as they are known; `scores` are those of part 1's
    placements, empty while none is wanted.
    """
    counted = {**parts, GOOD: good_runs(plan, parts[GOOD], results)}
    conclusions: dict[str, Callable[[], Json]] = {
        EQUAL_M: lambda: _arms(plan, parts[EQUAL_M], results),
        GOOD: lambda: _good(plan, counted[GOOD], results, scores),
        LAYOUTS: lambda: _layouts(plan, results, scores),
        SEARCHES: lambda: _searches(on_roofs(plan), results),
    }
    done = {name: sum(run.name in results for run in own) for name, own in counted.items()}
    rule = plan.searches
    rig_runs = len(plan.searched_seeds) * (1 + len(rule.objectives) * len(rule.seeds))
    seeds = len(plan.second.good.seeds)
    chosen = plan.second.good.selected * len(plan.vehicles)
    planned = {name: len(parts[name]) for name in parts}
    planned[GOOD] = planned[GOOD] // seeds + (seeds - 1) * chosen
    planned[SEARCHES] = rule.count * rig_runs
    found: Json = {"parts": {name: [done[name], planned[name]] for name in parts}}
    for name, conclusion in conclusions.items():
        known = done[name] == planned[name] and (scores or name in (EQUAL_M, SEARCHES))
        found[name] = conclusion() if known else None
    return found


def good_runs(plan: Plan, runs: Sequence[Run], results: Results) -> list[Run]:
    """Return the runs of part 1 that its figures use.

    They are those of the first seed and, once all are done, those of the other seeds at the
    placements that they choose.
    """
    first = [run for run in runs if run.seed == plan.second.good.seeds[0]]
    if len(first) == len(runs) or any(run.name not in results for run in first):
        return first
    whole = of_runs(GOOD, first, results)
    chosen = {whole.chosen[k] for k in whole.samples.better_half()[0]}
    return first + [run for run in runs if run not in first and run.placement in chosen]


def tie_verdict(low: float, high: float, tie: float) -> str:
    """Return whether arms with equal m tie: within +-`tie`, wholly without, or not decided."""
    if -tie <= low and high <= tie:
        return HOLDS
    return REFUTED if low > tie or high < -tie else UNDECIDED


def _arms(plan: Plan, runs: Sequence[Run], results: Results) -> Json:
    """Return AP by rows, and the differences from the first arm with their intervals."""
    rows = plan.second.equal_m.rows
    aps = {}
    for count in rows:
        lidar = arm_lidar(plan.second.equal_m, count)
        own = [run for run in runs if run.placement and run.placement.lidar is lidar]
        aps[count] = of_runs(EQUAL_M, own, results).samples.ap
    found: Json = {"ap": {str(n): ap.round(4).tolist() for n, ap in aps.items()}, "minus_first": {}}
    for count in rows[1:]:
        less = aps[count] - aps[rows[0]]
        low, high = student_interval(less.tolist())
        found["minus_first"][str(count)] = {
            "mean": round(float(less.mean()), 4),
            "interval": [round(low, 4), round(high, 4)],
            "tie": tie_verdict(low, high, plan.second.equal_m.tie_ap),
        }
    return found


def _good(plan: Plan, runs: Sequence[Run], results: Results, scores: Results) -> Json:
    """Return rho of each figure with the AP of the last seed, in the half chosen by the first."""
    first = plan.second.good.seeds[0]
    half = of_runs(GOOD, [run for run in runs if run.seed != first], results)
    values = half.all_values(scores)
    samples = half.samples
    at_first = np.array([results[f"{p.name}-s{first}"]["ap"] for p in half.chosen])
    return {
        "placements": [placement.name for placement in half.chosen],
        "ap": _extent(samples.ap),
        "figures": _figures(plan, values, samples),
        "afterwards": {
            "seeds": float(rho_within(at_first, samples.ap, samples.members)),
            AP_BEYOND: rank_of(plan, samples, values[EXPECTED_AP], values[COVERAGE]),
        },
    }


def _layouts(plan: Plan, results: Results, scores: Results) -> Json:
    """Return rho of each figure with the AP in real layouts, over all placements."""
    whole = of_mixed(LAYOUTS, parts_of(plan)[LAYOUTS], good_placements(plan), results)
    values = whole.all_values(scores)
    return {
        "ap": _extent(whole.samples.ap),
        "noise": round(whole.samples.noise, 4),
        "figures": _figures(plan, values, whole.samples),
        "afterwards": {
            AP_BEYOND: rank_of(plan, whole.samples, values[EXPECTED_AP], values[COVERAGE])
        },
    }


def _extent(ap: Floats) -> list[float]:
    """Return the lowest, the median and the highest AP."""
    return [round(float(v), 4) for v in (ap.min(), np.median(ap), ap.max())]


def _figures(plan: Plan, value: Mapping[str, Floats], samples: PlacementSamples) -> Json:
    """Return rho, interval, p and verdicts of each figure, values (P,) by score."""
    found = {n: rank_of(plan, samples, value[n]) for n in (PRIMARY, EXPECTED_AP, COVERAGE)}
    found[BEYOND] = rank_of(plan, samples, value[PRIMARY], value[COVERAGE])
    for row, p in zip(found.values(), holm([r["p"] for r in found.values()]), strict=True):
        row["p_holm"] = p
        row |= rank_verdicts(row, plan.statistics.alpha, plan.second.good.useful_rho)
    return found


def _searches(plan: Plan, results: Results) -> Json:
    """Return by ring the AP after searches by expected AP minus that after those by entropy."""
    found = dict[str, Json]()
    entropy, expected_ap = plan.searches.objectives
    for ring in rings_of(plan):
        by_rig = {}
        for rig in plan.searches.rigs:
            after = {
                objective: [
                    mean_ap_in(ring)(results[f"{placement_name(rig, objective, seed)}-s{own}"])
                    for seed in plan.searches.seeds
                    for own in plan.training.seeds
                ]
                for objective in plan.searches.objectives
            }
            less = float(np.mean(after[expected_ap]) - np.mean(after[entropy]))
            by_rig[rig] = round(less, 4)
        found[ring] = _over_rigs(list(by_rig.values())) | {"by_rig": by_rig}
    return {"minus_entropy": found}


def _over_rigs(less: Sequence[float]) -> Json:
    """Return mean, interval over the rigs and verdict of differences of AP."""
    mean = round(float(np.mean(less)), 4)
    if len(less) < 2:  # of the quick plan
        return {"mean": mean, "interval": None, "verdict": UNDECIDED}
    low, high = student_interval(less)
    sign = int(low > 0.0) - int(high < 0.0)
    return {
        "mean": mean,
        "interval": [round(low, 4), round(high, 4)],
        "verdict": FINDS_MORE.get(sign, UNDECIDED),
    }


def rank_verdicts(row: Json, alpha: float, useful: float) -> dict[str, str]:
    """Return two verdicts: whether a figure ranks, by its p after Holm, and whether it is refuted
    as a useful ranking, by its interval alone. A figure may rank and be no useful ranking."""
    ranks = row["p_holm"] < alpha and row["rho"] > 0.0
    return {
        "verdict": HOLDS if ranks else UNDECIDED,
        "useful": REFUTED if row["interval"][1] < useful else UNDECIDED,
    }
