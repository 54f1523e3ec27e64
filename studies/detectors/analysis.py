"""What the results of the runs say: correlations by design, pairs across hardware, statements.

A statement has a verdict only when every run that it rests on is done; until then its figures are
those so far, and marked as such.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..published.ranks import holm
from .placements import placements
from .plan import ACROSS, FIXED, GRID, MIXED, PLAIN, StudyPlan
from .posed_sensors import PosedSensors
from .rank_tests import (
    PlacementSamples,
    Resample,
    better_half,
    interval,
    ordered_share,
    partial_rho,
    permutation_p,
    pooled_noise,
    rho_within,
)
from .result_files import PlacementRun
from .runs import runs
from .scores import COMPARED, EXPECTED_AP, HEIGHT, PRIMARY, ComparedScore

Json = dict[str, Any]
Floats = NDArray[np.float64]

HOLDS, REFUTED, UNDECIDED, OPEN = "holds", "refuted", "not decided", "open"
FRESH = "mixed, fresh"
"""The mixed detector at placements that it was never trained with."""
CAMERAS = "cameras"
"""The study of camera placements."""
WITH_PRIMARY_TEST = (FIXED, CAMERAS)
"""Designs in which the primary score's test is the one that counts, without a correction."""
MIN_SO_FAR = 6
"""Fewer placements give no figures at all."""
MOSTLY_RIGHT = 2.0 / 3.0
"""Share of pairs from which a score may be trusted across hardware."""


@dataclass(frozen=True)
class DesignResults:
    """The finished part of a design.

    Attributes
    ----------
    name : str
    chosen : list of PosedSensors
        Those with a result.
    samples : PlacementSamples
        Their AP, of the seeds that all of them have.
    done, planned : int
        Runs.
    """

    name: str
    chosen: Sequence[PosedSensors]
    samples: PlacementSamples
    done: int
    planned: int

    @property
    def complete(self) -> bool:
        """Whether all runs are done."""
        return self.done == self.planned

    @property
    def has_figures(self) -> bool:
        """Whether there are enough placements for a figure."""
        return len(self.chosen) >= MIN_SO_FAR and bool(self.samples.members)


def analysis(plan: StudyPlan, results: Mapping[str, Json], scores: Mapping[str, Json]) -> Json:
    """Return all that follows from the results of the runs, as JSON data.

    Parameters
    ----------
    plan : StudyPlan
    results : mapping
        Results by the name of the run.
    scores : mapping
        Scores by the name of the placement, of all placements with results.
    """
    tables = {d.name: design_table(plan, d, scores) for d in designs_of(plan, results)}
    pairs, steps = _pairs(plan, results, scores), _steps(plan, results, scores)
    return {
        "runs": {"done": len(results), "planned": len(runs(plan))},
        "designs": tables,
        "pairs": pairs,
        "steps": steps,
        "statements": _statements(plan, tables, pairs, steps),
    }


def designs_of(plan: StudyPlan, results: Mapping[str, Json]) -> list[DesignResults]:
    """Return the finished parts of all designs."""
    own = [plain_design(plan, [name], results) for name in (FIXED, ACROSS)]
    return own + [_mixed(plan, results, name) for name in (MIXED, FRESH)]


def mean_ap(found: Json) -> float:
    """Return the mean AP of the classes that a run has found."""
    return float(found["ap"])


def mean_ap_in(ring: str) -> Callable[[Json], float]:
    """Return what takes the mean AP of the classes in a ring from what a run has found."""
    return lambda found: float(np.mean(list(found["by_ring"][ring].values())))


def plain_design(
    plan: StudyPlan,
    names: Sequence[str],
    results: Mapping[str, Json],
    ap_of: Callable[[Json], float] = mean_ap,
) -> DesignResults:
    """Return the finished part of designs with a detector a placement, in the plain world.

    Parameters
    ----------
    plan : StudyPlan
    names : sequence of str
        Of the designs; the first one is that of the results.
    results : mapping
    ap_of : callable
        Returns the AP of a run's results.
    """
    wanted = [r for r in runs(plan) if r.design in names and (r.world, r.detector) == (PLAIN, GRID)]
    return of_runs(names[0], wanted, results, ap_of)


def of_runs(
    name: str,
    wanted: Sequence[PlacementRun],
    results: Mapping[str, Json],
    ap_of: Callable[[Json], float] = mean_ap,
) -> DesignResults:
    """Return what runs with a detector a placement have found, as far as they are done."""
    aps: dict[PosedSensors, list[float]] = {}
    for run in wanted:
        if run.name in results and run.placement is not None:
            aps.setdefault(run.placement, []).append(ap_of(results[run.name]))
    done = sum(map(len, aps.values()))
    return DesignResults(name, list(aps), _samples(aps), done, len(wanted))


def _mixed(plan: StudyPlan, results: Mapping[str, Json], name: str) -> DesignResults:
    """Return the placements at which the mixed detector was tested; only fresh ones for `FRESH`."""
    by_name = {p.name: p for p in placements(plan)}
    wanted = [run for run in runs(plan) if run.placement is None]
    aps: dict[PosedSensors, list[float]] = {}
    done = [run for run in wanted if run.name in results]
    for run in done:
        for placement, found in results[run.name]["placements"].items():
            if name == MIXED or not found["trained_with"]:
                aps.setdefault(by_name[placement], []).append(found["ap"])
    return DesignResults(name, list(aps), _samples(aps), len(done), len(wanted))


def _samples(aps: Mapping[PosedSensors, Sequence[float]]) -> PlacementSamples:
    """Return samples with the seeds that all placements have."""
    count = min(map(len, aps.values()), default=0)
    values = np.array([list(row)[:count] for row in aps.values()]).reshape(len(aps), count)
    groups = np.array([p.vehicle for p in aps])
    return PlacementSamples(values, groups, np.array([p.hardware for p in aps]))


def values_of(
    score: ComparedScore, chosen: Sequence[PosedSensors], scores: Mapping[str, Json]
) -> Floats:
    """Return a score's value at each placement, (P,)."""
    return np.array([score.value(p, scores[p.name]) for p in chosen])


def _of_design(name: str) -> list[ComparedScore]:
    return [s for s in COMPARED if name == ACROSS or not s.across_only]


def design_table(plan: StudyPlan, design: DesignResults, scores: Mapping[str, Json]) -> Json:
    """Return the correlations of a design with each score."""
    head = {"done": design.done, "planned": design.planned, "placements": len(design.chosen)}
    if not design.has_figures:
        return {**head, "scores": {}}
    rows = {s.name: _row(plan, design, s, scores) for s in _of_design(design.name)}
    primary = design.name in WITH_PRIMARY_TEST
    corrected = [name for name in rows if not (primary and name == PRIMARY)]
    for name, p in zip(corrected, holm([rows[n]["p"] for n in corrected]), strict=True):
        rows[name]["holm"] = p
    ap = design.samples.ap
    return {
        **head,
        "seeds": design.samples.aps.shape[1],
        "ap": [rounded(float(v)) for v in (ap.min(), np.median(ap), ap.max())],
        "noise": rounded(pooled_noise(design.samples)),
        "scores": rows,
    }


def _row(
    plan: StudyPlan, design: DesignResults, score: ComparedScore, scores: Mapping[str, Json]
) -> Json:
    values, samples = values_of(score, design.chosen, scores), design.samples
    heights = np.array([p.mean_height for p in design.chosen])
    row = rho_of(plan, samples, values)
    row["p"] = permutation_p(values, samples, plan.statistics, plan.seed)
    if score.name != HEIGHT:
        row["given_height"] = partial_of(plan, samples, values, heights)
        row["height_given"] = partial_of(plan, samples, heights, values)
    if samples.aps.shape[1] > 1:
        row["better_half"] = _better_half(plan, samples, values)
    return row


def rho_of(plan: StudyPlan, samples: PlacementSamples, values: Floats) -> Json:
    """Return the rank correlation of values with AP, and its interval."""
    members = samples.members

    def rho(resample: Resample) -> Floats:
        return rho_within(values[resample.index], resample.ap, members)

    return {
        "rho": rounded(float(rho_within(values, samples.ap, members))),
        "interval": interval_of(plan, samples, rho),
    }


def partial_of(plan: StudyPlan, samples: PlacementSamples, values: Floats, given: Floats) -> Json:
    """Return the partial rank correlation of values with AP, given others, and its interval."""
    members = samples.members

    def partial(resample: Resample) -> Floats:
        index = resample.index
        return partial_rho(values[index], resample.ap, given[index], members)

    return {
        "rho": rounded(float(partial_rho(values, samples.ap, given, members))),
        "interval": interval_of(plan, samples, partial),
    }


def _better_half(plan: StudyPlan, samples: PlacementSamples, values: Floats) -> Json | None:
    of_half, half = better_half_of(samples, values)
    return rho_of(plan, half, of_half) if half.members else None


def better_half_of(samples: PlacementSamples, values: Floats) -> tuple[Floats, PlacementSamples]:
    """Return the values of the better half of each vehicle's placements, and their samples."""
    index, half = better_half(samples)
    return values[index], half


def interval_of(
    plan: StudyPlan, samples: PlacementSamples, statistic: Callable[[Resample], Floats]
) -> list[float | None]:
    """Return the interval that the plan names, of any statistic."""
    return [rounded(v) for v in interval(samples, plan.statistics, plan.seed, statistic)]


def _pairs(plan: StudyPlan, results: Mapping[str, Json], scores: Mapping[str, Json]) -> Json:
    """Return how many pairs of placements with different hardware each score orders rightly."""
    parts = [plain_design(plan, [name], results) for name in (FIXED, ACROSS)]
    design = plain_design(plan, (FIXED, ACROSS), results)
    head = {"done": sum(p.done for p in parts), "planned": sum(p.planned for p in parts)}
    if not all(part.has_figures for part in parts):
        return {**head, "scores": {}}
    samples, tie = design.samples, plan.statistics.tie_ap
    values = {s.name: values_of(s, design.chosen, scores) for s in COMPARED}

    def share(name: str) -> Callable[[Resample], Floats]:
        def statistic(resample: Resample) -> Floats:
            found = [
                ordered_share(values[name][i], ap, samples.hardware[i], samples.groups[i], tie)
                for i, ap in zip(resample.index, resample.ap, strict=True)
            ]
            return np.array(found)

        return statistic

    def of_all(name: str) -> float:
        return ordered_share(values[name], samples.ap, samples.hardware, samples.groups, tie)

    rows = {
        name: {"share": rounded(of_all(name)), "interval": interval_of(plan, samples, share(name))}
        for name in values
    }
    difference = {
        "share": rounded(of_all(EXPECTED_AP) - of_all(PRIMARY)),
        "interval": interval_of(plan, samples, lambda r: share(EXPECTED_AP)(r) - share(PRIMARY)(r)),
    }
    return {**head, "scores": rows, "expected_ap_minus_primary": difference}


def _steps(plan: StudyPlan, results: Mapping[str, Json], scores: Mapping[str, Json]) -> list[Json]:
    """Return rho of each score in the steps, and of the same placements in the plain world."""
    found = []
    for step in plan.steps:
        wanted = [r for r in runs(plan) if (r.world, r.detector) == (step.world, step.detector)]
        for name in (FIXED, ACROSS):
            design = of_runs(name, [r for r in wanted if r.design == name], results)
            entry: Json = {"world": step.world, "detector": step.detector, "design": name}
            entry |= {"done": design.done, "planned": design.planned, "scores": {}}
            plain = plain_design(plan, [name], results)
            if design.has_figures and set(design.chosen) <= set(plain.chosen):
                index = np.array([plain.chosen.index(p) for p in design.chosen])
                same = plain.samples.subset(index)
                entry |= {"placements": len(design.chosen), "seeds": design.samples.aps.shape[1]}
                entry["order"] = rho_of(plan, same, design.samples.ap)
                for score in _of_design(name):
                    values = values_of(score, design.chosen, scores)
                    here, there = (rho_of(plan, s, values) for s in (design.samples, same))
                    entry["scores"][score.name] = {**here, "plain": there}
            found.append(entry)
    return found


def _statements(
    plan: StudyPlan, tables: Mapping[str, Json], pairs: Json, steps: Sequence[Json]
) -> list[Json]:
    """Return the statements of the plan, each with its figures, its verdict and its marks."""
    rule, fixed = plan.statistics, tables[FIXED]
    primary = fixed["scores"].get(PRIMARY, {})
    half = primary.get("better_half") or {}
    given = primary.get("given_height") or {}
    share = pairs["scores"].get(PRIMARY, {})
    difference = pairs.get("expected_ap_minus_primary", {})
    significant = bool(primary) and primary["p"] < rule.alpha and primary["rho"] > 0.0
    first = HOLDS if significant else REFUTED
    rows: list[tuple[str, Json, str, Json]] = [
        ("Within one rig, a lower entropy goes with more found objects", primary, first, fixed),
        (
            "It is a useful ranking within one rig",
            primary,
            _beside(primary, rule.useful_rho),
            fixed,
        ),
        ("It still ranks among good placements", half, _beside(half, 0.0), fixed),
        ("It says more than height", given, _beside(given, 0.0), fixed),
        ("It may be compared across hardware", share, _beside(share, MOSTLY_RIGHT), pairs),
        (
            "Expected AP in traffic is better across hardware",
            difference,
            _beside(difference, 0.0),
            pairs,
        ),
    ]
    return [
        {
            "statement": text,
            "figures": {k: figures[k] for k in ("rho", "share", "interval", "p") if k in figures},
            "verdict": verdict if figures and part["done"] == part["planned"] else OPEN,
            "sign_changes": _sign_changes(
                steps,
                FIXED if part is fixed else ACROSS,
                EXPECTED_AP if figures is difference else PRIMARY,
            ),
        }
        for text, figures, verdict, part in rows
    ]


def _sign_changes(steps: Sequence[Json], design: str, score: str) -> list[str]:
    """Return the steps in which the rho of a score has another sign than in the plain world."""
    changed = []
    for step in steps:
        row = step["scores"].get(score) if step["design"] == design else None
        if row and (row["rho"] or 0.0) * (row["plain"]["rho"] or 0.0) < 0.0:
            changed.append(step_title(step))
    return changed


def step_title(step: Json) -> str:
    """Return what a step is called."""
    return f"{step['world']} world, {step['detector']} detector, {step['design']}"


def _beside(figures: Json, edge: float) -> str:
    """Return `HOLDS` if the interval is above an edge, `REFUTED` if it is below."""
    low, high = figures.get("interval", (None, None))
    if low is None or high is None:
        return UNDECIDED
    return HOLDS if low > edge else REFUTED if high < edge else UNDECIDED


def rounded(value: float) -> float | None:
    """Return a figure as results have it; None for one that is not there."""
    return None if math.isnan(value) else round(value, 4)
