"""What was looked for after the results were known: it decides no statement of the plan.

Intervals are those of the plan, percentiles of bootstraps; none is corrected for how many were
looked at.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import pe_core as pe

from ..results_file import Json
from .analysis import (
    DesignResults,
    Results,
    mean_ap_in,
    partial_of,
    plain_design,
    rho_of,
    rounded,
    share_of,
)
from .plan import ACROSS, FIXED, StudyPlan
from .rank_tests import bca_interval, better_ones, permutation_p, power, rho_within
from .scan_curves import beam_counts
from .scores import BEAMS, COVERAGE, EXPECTED_AP, PRIMARY

SHOWN = (PRIMARY, COVERAGE, EXPECTED_AP)
"""Scores that are looked at by ring."""
STUDIES, STUDY_RESAMPLES = 1000, 1000
"""Made-up studies from which a power is computed, and bootstraps of each one."""


def afterwards(plan: StudyPlan, results: Results, scores: Results, curves: Json) -> Json:
    """Return all of it as JSON data; nothing while runs of the two designs are missing.

    `curves` are the results of `scan_curves`.
    """
    fixed, both = (plain_design(plan, names, results) for names in ((FIXED,), (FIXED, ACROSS)))
    if not (fixed.complete and both.complete and fixed.has_figures):
        return {}
    values = both.all_values(scores)
    return {
        "better_half": _better_half(plan, fixed, scores),
        "all_round": _all_round(plan, fixed.all_round(), scores),
        "rings": _rings(plan, results, scores),
        "beyond_coverage": _beyond_coverage(plan, fixed, scores),
        "fewer_beams": _fewer_beams(plan, both, scores),
        "minus_beams": share_of(plan, both.samples, values[PRIMARY], values[BEAMS]),
        "curves_across": _curves_across(plan, results, curves),
    }


def _better_half(plan: StudyPlan, design: DesignResults, scores: Results) -> Json:
    """Return other figures of the better half, and why its percentile interval is unsure."""
    index, half = design.samples.better_half()
    values, rule = design.all_values(scores)[PRIMARY][index], plan.statistics
    corrected, mean = bca_interval(values, half, rule, plan.seed)
    found = float(rho_within(values, half.ap, half.members))
    quick = replace(rule, resamples=min(rule.resamples, STUDY_RESAMPLES))
    return {
        "p": permutation_p(values, half, rule, plan.seed),
        "bca": [rounded(v) for v in corrected],
        "bootstrap_mean": rounded(mean),
        "power": [
            {"rho": rounded(rho), "share": rounded(power(rho, half, quick, plan.seed, STUDIES))}
            for rho in (rule.useful_rho, found)
        ],
    }


def _all_round(plan: StudyPlan, part: DesignResults, scores: Results) -> Json:
    samples, rows = part.samples, {}
    for name, values in part.all_values(scores).items():
        if name != BEAMS:
            alone = [float(rho_within(values, samples.ap, [index])) for index in samples.members]
            vehicles = [str(samples.groups[index[0]]) for index in samples.members]
            by_vehicle = dict(zip(vehicles, map(rounded, alone), strict=True))
            rows[name] = {**rho_of(plan, samples, values), "by_vehicle": by_vehicle}
    return {"placements": len(part.chosen), "scores": rows}


def _rings(plan: StudyPlan, results: Results, scores: Results) -> Json:
    """Return rho by ring, of the placements that see all round; AP is the mean of the classes."""
    found = {}
    for ring in plan.precision.rings:
        design = plain_design(plan, [FIXED], results, mean_ap_in(ring))
        part = design.all_round()
        values = part.all_values(scores)
        rows = {name: rho_of(plan, part.samples, values[name]) for name in SHOWN}
        found[ring] = {"scores": rows, "beyond_coverage": _beyond_coverage(plan, design, scores)}
    return found


def _beyond_coverage(plan: StudyPlan, design: DesignResults, scores: Results) -> Json:
    values = design.all_values(scores)
    return partial_of(plan, design.samples, values[PRIMARY], values[COVERAGE])


def _fewer_beams(plan: StudyPlan, design: DesignResults, scores: Results) -> Json:
    """Return how scores order the pairs in which the rig with fewer beams finds more."""
    values, samples = design.all_values(scores), design.samples
    better = better_ones(samples.ap, samples.hardware, samples.groups, plan.statistics.tie_ap)
    beams = values[BEAMS]
    first, second = np.nonzero(better & (beams[:, None] < beams))
    return {
        "pairs": len(first),
        "of": int(better.sum()),
        "others": len(set(second.tolist())),
        "blind": sum(not design.chosen[k].all_round for k in second),
        "wrong": {name: int((v[first] <= v[second]).sum()) for name, v in values.items()},
    }


def _curves_across(plan: StudyPlan, results: Results, curves: Json) -> Json:
    """Return how far the curves, fitted with one rig, are from the AP of other hardware."""
    fitted = {name: pe.ApCurve(row["a"], row["b"]) for name, row in curves["classes"].items()}
    if not fitted:
        return {}
    design = plain_design(plan, [ACROSS], results)
    beams = beam_counts(plan, design.chosen)
    expected = np.mean([beams[name].expected_ap(fitted[name]) for name in fitted], axis=0)
    rmse = float(np.sqrt(((expected - design.samples.ap) ** 2).mean()))
    found = rho_of(plan, design.samples, expected)
    return {"placements": len(design.chosen), "rmse": rounded(rmse), **found}
