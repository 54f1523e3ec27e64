"""The second plan, as `plan.toml` has it: its placements and its runs in their order."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from pe_core.sensors.lidar import Lidar

from ..after_search.plan import AfterSearchPlan, SearchedRig, full_after_search_plan
from ..placements import EDGE_M, SHUTTLE, Placement, PoseValues, placements, top_near, vehicle
from ..plan import FIXED, StudyPlan, full_plan, quickly, text_and_digest
from ..runs import Run, seed_by_seed
from .layouts import LAYOUTS

SECOND = "second"
GOOD, EQUAL_M, SEARCHES = "good", "equal-m", "searches"
"""The parts besides `LAYOUTS`. plan.toml has those that had code first; its digest stays."""
LAYOUT_SEEDS, SEARCH_SEEDS, SEARCHED_SEEDS = (1, 2, 3), (1, 2, 3), (1, 2)
"""Of the mixed detector; of the searches, and of the detectors after them."""
LIDARS = (2, 4)
"""Of a searched rig."""
ROOF_M, ABOVE_M = 0.3, 0.1
"""The roof is what is so near to the top of a body. A search starts so high above it."""


@dataclass(frozen=True, slots=True)
class SecondPlan:
    """The plan: that of the LiDAR study with the digest of both files, and its own parts."""

    study: StudyPlan
    good: dict[str, Any]
    equal_m: dict[str, Any]
    layout_seeds: tuple[int, ...]
    searches: AfterSearchPlan


@cache
def full_second_plan() -> SecondPlan:
    """Return the plan."""
    text, digest = text_and_digest(__package__)
    data = tomllib.loads(text)
    study = replace(full_plan(), digest=digest)
    return SecondPlan(study, data["good"], data["equal_m"], LAYOUT_SEEDS, _searches(study))


def _searches(study: StudyPlan) -> AfterSearchPlan:
    """Return the plan of part 4: the first one of searches, with six rigs and more seeds."""
    training = replace(study.training, seeds=SEARCHED_SEEDS)
    return replace(
        full_after_search_plan(),
        study=replace(study, vehicles=(*study.vehicles, SHUTTLE), training=training),
        rigs=tuple(_rig(name, count) for name in (*study.vehicles, SHUTTLE) for count in LIDARS),
        search_seeds=SEARCH_SEEDS,
    )


def _rig(name: str, count: int) -> SearchedRig:
    """Return a rig at the middles of the roof's sides (two LiDARs) or at its corners (four)."""
    body = vehicle(name)
    corners = body.triangles.reshape(-1, 3)
    roof = corners[corners[:, 2] >= body.bounds[1][2] - ROOF_M, :2]
    low, high = roof.min(axis=0) + EDGE_M, roof.max(axis=0) - EDGE_M
    along = (high[0], low[0]) if count > len(LIDARS) else ((low[0] + high[0]) / 2.0,)
    poses: list[PoseValues] = []
    for x in along:
        for y in (high[1], low[1]):
            place = x, y, top_near(body, x, y) + ABOVE_M
            poses.append((*(round(float(w), 3) for w in place), 0.0, 0.0, 0.0))
    model = full_plan().hardware[full_plan().fixed["channels"]]
    return SearchedRig(f"{name}_{count}", name, model, tuple(poses), {}, False)


@cache
def quick_second_plan() -> SecondPlan:
    """Return a plan that only shows that everything runs: few placements, few scenes."""
    plan = full_second_plan()
    good = {**plan.good, "each": 1, "seeds": [1], "selected": 1}
    equal_m = {**plan.equal_m, "rows": plan.equal_m["rows"][:1], "each": 1, "seeds": [1]}
    study = quickly(plan.study)
    training = replace(study.training, seeds=SEARCHED_SEEDS[:1])
    searches = replace(
        plan.searches,
        study=replace(study, vehicles=plan.searches.study.vehicles, training=training),
        rigs=plan.searches.rigs[:1],
        search_seeds=SEARCH_SEEDS[:2],
        samples=4096,
        evaluations=6,
    )
    return SecondPlan(study, good, equal_m, LAYOUT_SEEDS[:1], searches)


@cache
def _good(digest: str, each: int) -> tuple[Placement, ...]:
    first = full_plan()
    known = first.fixed["all_round"]
    drawn = placements(replace(first, fixed={**first.fixed, "all_round": known + each, "blind": 0}))
    return tuple(
        replace(p, name=f"{GOOD}-{vehicle}-{k:02}", design=GOOD)
        for vehicle in first.vehicles
        for k, p in enumerate(
            [p for p in drawn if p.design == FIXED and p.vehicle == vehicle][known:], 1
        )
    )


def good_placements(plan: SecondPlan) -> tuple[Placement, ...]:
    """Return the placements of part 1: the sedan's, then the bus's."""
    return _good(plan.study.digest, plan.good["each"])


def arm_placements(plan: SecondPlan) -> list[Placement]:
    """Return the placements of part 2: the same poses for each number of rows."""
    rule, good = plan.equal_m, good_placements(plan)
    first = [p for p in good if int(p.name[-2:]) <= rule["each"]]
    return [
        replace(p, name=p.name.replace(GOOD, f"{EQUAL_M}-{rows}"), design=EQUAL_M, lidar=lidar)
        for p in first
        for rows in rule["rows"]
        for lidar in [arm_lidar(plan, rows)]
    ]


def arm_lidar(plan: SecondPlan, rows: int) -> Lidar:
    """Return the LiDAR of so many rows: all have the same number of beams."""
    rule = plan.equal_m
    return _lidar(rows, rule["beams"] // rows, rule["elevation_deg"], rule["max_range_m"])


@cache
def _lidar(rows: int, columns: int, top_deg: float, max_range: float) -> Lidar:
    top = math.radians(top_deg)
    return Lidar(f"{rows} x {columns}", np.linspace(-top, top, rows), columns, max_range)


def second_runs(plan: SecondPlan) -> list[Run]:
    """Return the runs: part 2, then part 1, seed by seed, vehicles by turns."""
    good = sorted(good_placements(plan), key=lambda p: p.name[-2:])
    arms = [Run(p, seed) for seed in plan.equal_m["seeds"] for p in arm_placements(plan)]
    return arms + [Run(p, seed) for seed in plan.good["seeds"] for p in good]


def layout_runs(plan: SecondPlan) -> list[Run]:
    """Return the runs of part 3: the mixed detector, tested in real layouts."""
    return [Run(None, seed, LAYOUTS) for seed in plan.layout_seeds]


def parts_of(plan: SecondPlan, searched: Sequence[Placement]) -> dict[str, list[Run]]:
    """Return the runs of each part; of part 4 those of the placements that were searched."""
    main = second_runs(plan)
    parts = {name: [run for run in main if run.design == name] for name in (EQUAL_M, GOOD)}
    parts[LAYOUTS] = layout_runs(plan)
    return {**parts, SEARCHES: seed_by_seed(plan.searches.study, searched)}
