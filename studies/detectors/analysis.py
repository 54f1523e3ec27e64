"""What the results of the runs say: correlations by design, pairs across hardware, statements.

A statement has a verdict only when every run that it rests on is done; until then its figures are
those so far, and marked as such.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pe_core.base import Floats, Ints

from ..ranks import (
    PlacementSamples,
    Resample,
    Statistic,
    holm,
    interval,
    ordered_share,
    permutation_p,
    rank_figures,
    rho_statistic,
    rho_within,
)
from ..results_file import Json
from .placements import Placement, camera_placements, placements
from .plan import ACROSS, CAMERAS, FIXED, GRID, MIXED, PLAIN, Plan
from .runs import Run, runs, seed_by_seed
from .scores import COMPARED, EXPECTED_AP, HEIGHT, PRIMARY, ComparedScore

Results = Mapping[str, Json]
"""Results by the name of the run, or scores by that of the placement."""
ApOf = Callable[[Json], float]
"""Returns the AP of a run's results."""

HOLDS = "holds"
REFUTED = "refuted"
UNDECIDED = "not decided"
OPEN = "open"
FRESH = "mixed, fresh"
"""The mixed detector at placements that it was never trained with."""
WITH_PRIMARY_TEST = (FIXED, CAMERAS)
"""Designs in which the primary score's test is the one that counts, without a correction."""
MIN_SO_FAR = 6
"""Fewer placements give no figures at all."""
MOSTLY_RIGHT = 2.0 / 3.0
"""Share of pairs from which a score may be trusted across hardware."""
OF_CAMERAS = ("rho", "interval", "p", "holm")
"""Figures of a score in the study of cameras; eight placements are too few for the others."""


@dataclass(frozen=True)
class DesignResults:
    """The finished part of a design: placements with a result, AP of the seeds that all have.

    `done` and `planned` count runs.
    """

    name: str
    chosen: Sequence[Placement]
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

    @property
    def state(self) -> Json:
        """How many runs are done."""
        return {"done": self.done, "planned": self.planned}

    def values(self, score: ComparedScore, scores: Results) -> Floats:
        """Return a score's value at each placement, (P,)."""
        return np.array([score.value(p, scores[p.name]) for p in self.chosen])

    def all_values(self, scores: Results) -> dict[str, Floats]:
        """Return the values of all scores by name."""
        return {score.name: self.values(score, scores) for score in COMPARED}

    def all_round(self) -> DesignResults:
        """Return the placements that see all round."""
        index = np.flatnonzero([p.all_round for p in self.chosen])
        chosen = [self.chosen[k] for k in index]
        return replace(self, chosen=chosen, samples=self.samples.subset(index))


def analysis(plan: Plan, results: Results, scores: Results) -> Json:
    """Return what the plan asks for, as JSON data."""
    tables = {d.name: design_table(plan, d, scores) for d in designs_of(plan, results)}
    pairs = _pairs(plan, results, scores)
    steps = _steps(plan, results, scores)
    return {
        "runs": {"done": len(results), "planned": len(runs(plan))},
        "designs": tables,
        "pairs": pairs,
        "steps": steps,
        "statements": _statements(plan, tables, pairs, steps),
    }


def designs_of(plan: Plan, results: Results) -> list[DesignResults]:
    """Return the finished parts of all designs."""
    own = [plain_design(plan, [name], results) for name in (FIXED, ACROSS)]
    mixed = [run for run in runs(plan) if run.placement is None]
    return own + [of_mixed(name, mixed, placements(plan), results) for name in (MIXED, FRESH)]


def mean_ap(found: Json) -> float:
    """Return the mean AP of the classes that a run has found."""
    return float(found["ap"])


def mean_ap_in(ring: str) -> ApOf:
    """Return what takes the mean AP of the classes in a ring from what a run has found."""
    return lambda found: float(np.mean(list(found["by_ring"][ring].values())))


def mean_ap_of(name: str) -> ApOf:
    """Return what takes the AP of a class from what a run has found."""
    return lambda found: float(found["by_class"][name])


def plain_design(
    plan: Plan, names: Sequence[str], results: Results, ap_of: ApOf = mean_ap
) -> DesignResults:
    """Return the finished part of designs with a detector a placement, in the plain world."""
    wanted = [r for r in runs(plan) if r.design in names and (r.world, r.detector) == (PLAIN, GRID)]
    return of_runs(names[0], wanted, results, ap_of)


def of_runs(
    name: str, wanted: Sequence[Run], results: Results, ap_of: ApOf = mean_ap
) -> DesignResults:
    """Return what runs with a detector a placement have found, as far as they are done."""
    aps: dict[Placement, list[float]] = {}
    for run in wanted:
        if run.name in results and run.placement is not None:
            aps.setdefault(run.placement, []).append(ap_of(results[run.name]))
    return _design(name, aps, sum(map(len, aps.values())), len(wanted))


def of_mixed(
    name: str, wanted: Sequence[Run], chosen: Sequence[Placement], results: Results
) -> DesignResults:
    """Return what a detector for many placements found at them; only at fresh ones for `FRESH`."""
    by_name = {p.name: p for p in chosen}
    aps = dict[Placement, list[float]]()
    done = [run for run in wanted if run.name in results]
    for run in done:
        for placement, found in results[run.name]["placements"].items():
            if name != FRESH or not found["trained_with"]:
                aps.setdefault(by_name[placement], []).append(found["ap"])
    return _design(name, aps, len(done), len(wanted))


def _design(
    name: str, aps: Mapping[Placement, Sequence[float]], done: int, planned: int
) -> DesignResults:
    """Return a design with the AP of the seeds that all placements have."""
    count = min(map(len, aps.values()), default=0)
    values = np.array([list(row)[:count] for row in aps.values()]).reshape(len(aps), count)
    groups, hardware = (np.array([getattr(p, k) for p in aps]) for k in ("vehicle", "hardware"))
    return DesignResults(
        name, list(aps), PlacementSamples(values, groups, hardware), done, planned=planned
    )


def _of_design(name: str) -> list[ComparedScore]:
    return [s for s in COMPARED if name == ACROSS or not s.across_only]


def design_table(plan: Plan, design: DesignResults, scores: Results) -> Json:
    """Return the correlations of a design with each score."""
    head = {**design.state, "placements": len(design.chosen)}
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
        "noise": rounded(design.samples.noise),
        "scores": rows,
    }


def _row(plan: Plan, design: DesignResults, score: ComparedScore, scores: Results) -> Json:
    values = design.values(score, scores)
    samples = design.samples
    heights = np.array([p.mean_height for p in design.chosen])
    row = rho_of(plan, samples, values)
    row["p"] = permutation_p(values, samples, plan.statistics, plan.seed)
    if score.name != HEIGHT:
        row["given_height"] = rho_of(plan, samples, values, heights)
        row["height_given"] = rho_of(plan, samples, heights, values)
    if samples.aps.shape[1] > 1:
        index, half = samples.better_half()
        row["better_half"] = rho_of(plan, half, values[index]) if half.members else None
    return row


def rho_of(
    plan: Plan, samples: PlacementSamples, values: Floats, given: Floats | None = None
) -> Json:
    """Return the rank correlation of values with AP, partial where others are given."""
    return _figure("rho", plan, samples, rho_statistic(values, samples, given))


def rank_of(
    plan: Plan, samples: PlacementSamples, values: Floats, given: Floats | None = None
) -> Json:
    """Return rho as `rho_of`, its interval corrected for bias, and its p; nothing is rounded."""
    return rank_figures(values, samples, plan.statistics, plan.seed, given=given)


def _figure(key: str, plan: Plan, samples: PlacementSamples, statistic: Statistic) -> Json:
    """Return a statistic of all placements, and the interval that the plan names."""
    limits = interval(samples, plan.statistics, plan.seed, statistic)
    found = rounded(float(statistic(samples.whole)))
    return {key: found, "interval": [rounded(v) for v in limits]}


def share_of(
    plan: Plan, samples: PlacementSamples, values: Floats, less: Floats | None = None
) -> Json:
    """Return the share of pairs with different hardware that values order rightly, its interval.

    With other values, `less`, it is the difference from theirs.
    """

    def share(index: Ints, ap: Floats) -> float:
        tie = plan.statistics.tie_ap
        hardware = samples.hardware[index]
        groups = samples.groups[index]
        found = ordered_share(values[index], ap, hardware, groups, tie=tie)
        return (
            found
            if less is None
            else found - ordered_share(less[index], ap, hardware, groups, tie=tie)
        )

    def shares(drawn: Resample) -> Floats:
        pairs = zip(np.atleast_2d(drawn.index), np.atleast_2d(drawn.ap), strict=True)
        found = np.array([share(index, ap) for index, ap in pairs])
        return found if drawn.index.ndim > 1 else found[0]

    return _figure("share", plan, samples, shares)


def _pairs(plan: Plan, results: Results, scores: Results) -> Json:
    """Return how many pairs of placements with different hardware each score orders rightly."""
    parts = [plain_design(plan, [name], results) for name in (FIXED, ACROSS)]
    design = plain_design(plan, (FIXED, ACROSS), results)
    head = {"done": sum(p.done for p in parts), "planned": sum(p.planned for p in parts)}
    if not all(part.has_figures for part in parts):
        return {**head, "scores": {}}
    values = design.all_values(scores)
    samples = design.samples
    rows = {name: share_of(plan, samples, v) for name, v in values.items()}
    difference = share_of(plan, samples, values[EXPECTED_AP], values[PRIMARY])
    return {**head, "scores": rows, "expected_ap_minus_primary": difference}


def _steps(plan: Plan, results: Results, scores: Results) -> list[Json]:
    """Return rho of each score in the steps, and of the same placements in the plain world."""
    found = []
    for step in plan.steps.runs:
        wanted = [r for r in runs(plan) if (r.world, r.detector) == (step.world, step.detector)]
        for name in (FIXED, ACROSS):
            design = of_runs(name, [r for r in wanted if r.design == name], results)
            entry: Json = {"world": step.world, "detector": step.detector, "design": name}
            entry |= {**design.state, "scores": {}}
            plain = plain_design(plan, [name], results)
            if design.has_figures and set(design.chosen) <= set(plain.chosen):
                index = np.array([plain.chosen.index(p) for p in design.chosen])
                same = plain.samples.subset(index)
                entry |= {"placements": len(design.chosen), "seeds": design.samples.aps.shape[1]}
                entry["order"] = rho_of(plan, same, design.samples.ap)
                for score in _of_design(name):
                    values = design.values(score, scores)
                    here, there = (rho_of(plan, s, values) for s in (design.samples, same))
                    entry["scores"][score.name] = {**here, "plain": there}
            found.append(entry)
    return found


def _statements(
    plan: Plan, tables: Mapping[str, Json], pairs: Json, steps: Sequence[Json]
) -> list[Json]:
    """Return the statements of the plan, each with its figures, its verdict and its marks."""
    rule = plan.statistics
    fixed = tables[FIXED]
    primary = fixed["scores"].get(PRIMARY, {})
    half, given = (primary.get(key) or {} for key in ("better_half", "given_height"))
    share = pairs["scores"].get(PRIMARY, {})
    more = pairs.get("expected_ap_minus_primary", {})
    significant = bool(primary) and primary["p"] < rule.alpha and primary["rho"] > 0.0
    first = HOLDS if significant else REFUTED
    useful = _beside(primary, rule.useful_rho)
    rows: list[tuple[str, Json, str, Json]] = [
        ("Within one rig, a lower entropy goes with more found objects", primary, first, fixed),
        ("It is a useful ranking within one rig", primary, useful, fixed),
        ("It still ranks among good placements", half, _beside(half, 0.0), fixed),
        ("It says more than height", given, _beside(given, 0.0), fixed),
        ("It may be compared across hardware", share, _beside(share, MOSTLY_RIGHT), pairs),
        ("Expected AP in traffic is better across hardware", more, _beside(more, 0.0), pairs),
    ]
    return [
        {
            "statement": text,
            "figures": {k: figures[k] for k in ("rho", "share", "interval", "p") if k in figures},
            "verdict": verdict if figures and part["done"] == part["planned"] else OPEN,
            "sign_changes": [
                step_title(step)
                for step in steps
                if step["design"] == (FIXED if part is fixed else ACROSS)
                and _sign_changes(step["scores"].get(EXPECTED_AP if figures is more else PRIMARY))
            ],
        }
        for text, figures, verdict, part in rows
    ]


def _sign_changes(row: Json | None) -> bool:
    """Whether the rho of a score in a step has another sign than in the plain world."""
    return row is not None and (row["rho"] or 0.0) * (row["plain"]["rho"] or 0.0) < 0.0


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


# Cameras.


def design_of_cameras(plan: Plan, results: Results) -> DesignResults:
    """Return what the runs of cameras have found, as far as they are done."""
    return of_runs(CAMERAS, seed_by_seed(plan, camera_placements(plan)), results)


def camera_analysis(plan: Plan, results: Results, scores: Results) -> Json:
    """Return all that follows from the results of the runs of cameras, as JSON data."""
    design = design_of_cameras(plan, results)
    found = design_table(plan, design, scores)
    found["scores"] = {
        score: {key: row[key] for key in OF_CAMERAS if key in row}
        for score, row in found["scores"].items()
    }
    if found["scores"]:
        aps = design.samples.aps
        members = design.samples.members
        seen = design_table(plan, design.all_round(), scores)["scores"]
        found["all_round"] = {score: row["rho"] for score, row in seen.items()}
        found["mean_ap"] = round(float(design.samples.ap.mean()), 4)
        alike = rho_within(aps[:, 0], aps[:, 1], members) if aps.shape[1] > 1 else float("nan")
        found["seed_rho"] = rounded(float(alike))
    return {**found, "verdict": _verdict_of_cameras(plan, found)}


def is_too_noisy(plan: Plan, found: Json) -> bool:
    """Whether the detectors find too little, or their seeds agree too little, for a statement."""
    rule = plan.statistics
    seed_rho = found.get("seed_rho")
    return seed_rho is None or seed_rho < rule.min_seed_rho or bool(found["mean_ap"] < rule.min_ap)


def _verdict_of_cameras(plan: Plan, found: Json) -> str:
    rule = plan.statistics
    if found["done"] < found["planned"] or not found["scores"]:
        return OPEN
    primary = found["scores"][rule.primary]
    if is_too_noisy(plan, found) or primary["p"] >= rule.alpha:
        return UNDECIDED
    return HOLDS if primary["rho"] > 0.0 else REFUTED
