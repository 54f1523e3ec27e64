"""What was looked for after the results were known: it decides no statement of the plan.

Intervals are those of the plan, percentiles of bootstraps; none is corrected for how many were
looked at.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import pe_core as pe

from .analysis import (
    DesignResults,
    better_half_of,
    interval_of,
    mean_ap_in,
    partial_of,
    plain_design,
    rho_of,
    rounded,
    values_of,
)
from .placements import Placement
from .plan import ACROSS, FIXED, StudyPlan
from .rank_tests import (
    bca_interval,
    better_ones,
    ordered_share,
    permutation_p,
    power,
    rho_within,
)
from .scan_curves import beam_counts
from .scores import BEAMS, COMPARED, COVERAGE, EXPECTED_AP, PRIMARY

Json = dict[str, Any]

SHOWN = (PRIMARY, COVERAGE, EXPECTED_AP)
"""Scores that are looked at by ring."""
STUDIES, STUDY_RESAMPLES = 1000, 1000
"""Made-up studies from which a power is computed, and bootstraps of each one."""


def afterwards(
    plan: StudyPlan, results: Mapping[str, Json], scores: Mapping[str, Json], curves: Json
) -> Json:
    """Return all of it as JSON data; nothing while runs of the two designs are missing.

    Parameters
    ----------
    plan : StudyPlan
    results : mapping
        Results by the name of the run.
    scores : mapping
        Scores by the name of the placement.
    curves : dict
        The results of `scan_curves`.
    """
    fixed, both = (plain_design(plan, names, results) for names in ((FIXED,), (FIXED, ACROSS)))
    if not (fixed.complete and both.complete and fixed.has_figures):
        return {}
    return {
        "better_half": _better_half(plan, fixed, scores),
        "all_round": _all_round(plan, fixed, scores),
        "rings": _rings(plan, results, scores),
        "beyond_coverage": _beyond_coverage(plan, fixed, scores),
        "fewer_beams": _fewer_beams(plan, both, scores),
        "minus_beams": _minus_beams(plan, both, scores),
        "curves_across": _curves_across(plan, results, curves),
    }


def _values(design: DesignResults, scores: Mapping[str, Json]) -> dict[str, Any]:
    return {score.name: values_of(score, design.chosen, scores) for score in COMPARED}


def all_round_part(design: DesignResults) -> DesignResults:
    """Return the placements of a design that see all round."""
    index = np.flatnonzero([p.all_round for p in design.chosen])
    chosen = [design.chosen[k] for k in index]
    return replace(design, chosen=chosen, samples=design.samples.subset(index))


def _better_half(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    """Return other figures of the better half, and why its percentile interval is unsure."""
    values, half = better_half_of(design.samples, _values(design, scores)[PRIMARY])
    rule = plan.statistics
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


def _all_round(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    part = all_round_part(design)
    samples, rows = part.samples, {}
    for name, values in _values(part, scores).items():
        if name != BEAMS:
            by_vehicle = {
                str(samples.groups[index[0]]): rounded(
                    float(rho_within(values, samples.ap, [index]))
                )
                for index in samples.members
            }
            rows[name] = {**rho_of(plan, samples, values), "by_vehicle": by_vehicle}
    return {"placements": len(part.chosen), "scores": rows}


def _rings(plan: StudyPlan, results: Mapping[str, Json], scores: Mapping[str, Json]) -> Json:
    """Return rho by ring, of the placements that see all round; AP is the mean of the classes."""
    found = {}
    for ring in plan.precision.rings:
        design = plain_design(plan, [FIXED], results, mean_ap_in(ring))
        part = all_round_part(design)
        values = _values(part, scores)
        rows = {name: rho_of(plan, part.samples, values[name]) for name in SHOWN}
        found[ring] = {"scores": rows, "beyond_coverage": _beyond_coverage(plan, design, scores)}
    return found


def _beyond_coverage(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    values = _values(design, scores)
    return partial_of(plan, design.samples, values[PRIMARY], values[COVERAGE])


def _fewer_beams(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    """Return how scores order the pairs in which the rig with fewer beams finds more."""
    values, samples = _values(design, scores), design.samples
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


def _minus_beams(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    """Return by how much more pairs entropy orders rightly than the number of beams does."""
    values, samples = _values(design, scores), design.samples

    def difference(index: Any, ap: Any) -> float:
        hardware, groups = samples.hardware[index], samples.groups[index]
        one, other = (
            ordered_share(values[name][index], ap, hardware, groups, plan.statistics.tie_ap)
            for name in (PRIMARY, BEAMS)
        )
        return one - other

    return {
        "share": rounded(difference(np.arange(len(samples.ap)), samples.ap)),
        "interval": interval_of(
            plan,
            samples,
            lambda r: np.array([difference(i, ap) for i, ap in zip(r.index, r.ap, strict=True)]),
        ),
    }


def _curves_across(plan: StudyPlan, results: Mapping[str, Json], curves: Json) -> Json:
    """Return how far the curves, fitted with one rig, are from the AP of other hardware."""
    fitted = {name: pe.ApCurve(row["a"], row["b"]) for name, row in curves["classes"].items()}
    if not fitted:
        return {}
    design = plain_design(plan, [ACROSS], results)
    beams = beam_counts(plan, [p for p in design.chosen if isinstance(p, Placement)])
    expected = np.mean([beams[name].expected_ap(fitted[name]) for name in fitted], axis=0)
    rmse = float(np.sqrt(((expected - design.samples.ap) ** 2).mean()))
    found = rho_of(plan, design.samples, expected)
    return {"placements": len(design.chosen), "rmse": rounded(rmse), **found}
