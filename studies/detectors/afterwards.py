"""What was looked for after the results were known: it decides no statement of the plan.

Intervals are those of the plan, percentiles of bootstraps; none is corrected for how many were
looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.scoring.targets import ObjectEvaluator, TargetRule

from ..published.scores import DEGREES, Paper, body_of, paper_of
from ..ranks import (
    SAME,
    bca_interval,
    better_ones,
    holm,
    mean_ranks,
    permutation_p,
    power,
    rho_within,
    standard_ranks,
)
from ..results_file import Json, read_json
from .analysis import DesignResults, Results, mean_ap_in, plain_design, rho_of, rounded, share_of
from .plan import ACROSS, FIXED, Plan, rings_of
from .scan_curves import beam_counts
from .scores import BEAMS, COVERAGE, EXPECTED_AP, PRIMARY, SPACE

SHOWN = (PRIMARY, COVERAGE, EXPECTED_AP)
"""Scores that are looked at by ring."""
STUDIES = 1000
STUDY_RESAMPLES = 1000
"""Made-up studies from which a power is computed, and bootstraps of each one."""
TABLE = Path(__file__).parents[1] / "published" / "data" / "place3d_segmentation.json"
SCORES = "segmentation.json"
CONDITIONS = {"clean": "clean", "adverse_mean": "mean of the adverse conditions"}


def afterwards(plan: Plan, results: Results, scores: Results, curves: Json) -> Json:
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


def _better_half(plan: Plan, design: DesignResults, scores: Results) -> Json:
    """Return other figures of the better half, and why its percentile interval is unsure."""
    index, half = design.samples.better_half()
    values = design.all_values(scores)[PRIMARY][index]
    rule = plan.statistics
    corrected, mean = bca_interval(values, half, rule, plan.seed)
    found = float(rho_within(values, half.ap, half.members))
    quick = rule.but(resamples=min(rule.resamples, STUDY_RESAMPLES))
    return {
        "p": permutation_p(values, half, rule, plan.seed),
        "bca": [rounded(v) for v in corrected],
        "bootstrap_mean": rounded(mean),
        "power": [
            {
                "rho": rounded(rho),
                "share": rounded(power(rho, half, quick, plan.seed, studies=STUDIES)),
            }
            for rho in (rule.useful_rho, found)
        ],
    }


def _all_round(plan: Plan, part: DesignResults, scores: Results) -> Json:
    samples = part.samples
    rows = {}
    for name, values in part.all_values(scores).items():
        if name != BEAMS:
            by_vehicle = {
                str(samples.groups[own[0]]): rounded(float(rho_within(values, samples.ap, [own])))
                for own in samples.members
            }
            rows[name] = {**rho_of(plan, samples, values), "by_vehicle": by_vehicle}
    return {"placements": len(part.chosen), "scores": rows}


def _rings(plan: Plan, results: Results, scores: Results) -> Json:
    """Return rho by ring, of the placements that see all round; AP is the mean of the classes."""
    found = {}
    for ring in rings_of(plan):
        design = plain_design(plan, [FIXED], results, mean_ap_in(ring))
        part = design.all_round()
        values = part.all_values(scores)
        rows = {name: rho_of(plan, part.samples, values[name]) for name in SHOWN}
        found[ring] = {"scores": rows, "beyond_coverage": _beyond_coverage(plan, design, scores)}
    return found


def _beyond_coverage(plan: Plan, design: DesignResults, scores: Results) -> Json:
    values = design.all_values(scores)
    return rho_of(plan, design.samples, values[PRIMARY], values[COVERAGE])


def _fewer_beams(plan: Plan, design: DesignResults, scores: Results) -> Json:
    """Return how scores order the pairs in which the rig with fewer beams finds more."""
    values = design.all_values(scores)
    samples = design.samples
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


def _curves_across(plan: Plan, results: Results, curves: Json) -> Json:
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


# A look from outside: Place3D's segmentation networks, ten placements with four networks.


@cache
def published() -> Json:
    """Return the published placements and mIoU."""
    return read_json(TABLE)


def segmentation_scores(folder: Path, report: Callable[[str], None]) -> dict[str, Json]:
    """Return the scores of the published placements by name; what is missing is computed."""
    path = folder / SCORES
    names = list(published()["placements"])
    scores: dict[str, Json] = read_json(path) if path.exists() else {}
    if not set(scores) <= set(names):
        raise InputError(path, "placements", f"some of {', '.join(names)}", ", ".join(scores))
    if missing := [name for name in names if name not in scores]:
        score = _scorer()
        for name in missing:
            scores[name] = score(name)
            report(f"scored {name} of Place3D")
        write_bytes(path, dump_json({name: scores[name] for name in names}).encode())
    return scores


def _scorer() -> Callable[[str], Json]:
    """Return a function that scores a placement, as the page on published detectors does."""
    body = body_of("box")
    road = pe.Prior.road()
    voxels = pe.Evaluator(SPACE, road, body, workers=1)
    rules = {traffic: TargetRule("objects", traffic) for traffic in (False, True)}
    objects = {t: ObjectEvaluator(SPACE, road, body, targets=rule) for t, rule in rules.items()}
    paper: Paper = replace(paper_of("place3d"), placements=published()["placements"])

    def score(name: str) -> Json:
        rig = paper.rig(name, DEGREES)
        of_voxels = voxels.score(rig)
        found = {"perception entropy, road prior": -of_voxels.entropy}
        found["coverage"] = of_voxels.coverage
        for traffic, evaluator in objects.items():
            of_objects = evaluator.score(rig).objects
            assert of_objects is not None
            found[f"expected AP{', in traffic' if traffic else ''}"] = of_objects.ap
        found["mean height"] = paper.height(name)
        return found

    return score


def outside(scores: Mapping[str, Json], rule: Any, seed: int) -> Json:
    """Return for the page: rho, p and p after Holm by score and condition, and what they are of."""
    rows: dict[str, list[Json]] = {}
    for condition in CONDITIONS:
        found = correlations(condition, scores, rule, seed)
        adjusted = holm([row["p"] for row in found.values()])
        for (name, row), corrected in zip(found.items(), adjusted, strict=True):
            rows.setdefault(name, []).append({**row, "holm": corrected})
    table = published()
    return {
        "rows": rows,
        "conditions": list(CONDITIONS.values()),
        "placements": len(table["placements"]),
        "networks": list(table["miou"]["clean"]),
        "source": table["source"],
    }


def correlations(
    condition: str, scores: Mapping[str, Json], rule: Plan, seed: int
) -> dict[str, Json]:
    """Return mean rho over the networks and its p, by score."""
    names = list(published()["placements"])
    mious = [[row[n] for n in names] for row in published()["miou"][condition].values()]
    of_networks = mean_ranks(mious)
    rows = {}
    for score in scores[names[0]]:
        ranks = standard_ranks([scores[n][score] for n in names])
        if not ranks.any():
            raise InputError(SCORES, score, "values that differ", "one value")
        rng = np.random.default_rng([seed, 4])
        tiled = np.broadcast_to(ranks, (rule.permutations, len(names)))
        chance = np.abs((rng.permuted(tiled, axis=1) * of_networks).sum(axis=1))
        rho = float((ranks * of_networks).sum())
        p = (1 + int((chance >= abs(rho) - SAME).sum())) / (1 + rule.permutations)
        rows[score] = {"rho": rho, "p": p}
    return rows
