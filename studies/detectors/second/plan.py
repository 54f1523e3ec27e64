"""The second plan, as `plan.toml` has it: its placements and its runs in their order."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from pe_core.sensors.lidar import Lidar

from ..placements import Placement, placements
from ..plan import FIXED, StudyPlan, full_plan, quickly, text_and_digest
from ..runs import Run

SECOND = "second"
GOOD, EQUAL_M = "good", "equal-m"
"""The designs."""


@dataclass(frozen=True, slots=True)
class SecondPlan:
    """The plan: that of the LiDAR study with the digest of both files, and its own tables."""

    study: StudyPlan
    good: dict[str, Any]
    equal_m: dict[str, Any]


@cache
def full_second_plan() -> SecondPlan:
    """Return the plan."""
    text, digest = text_and_digest(__package__)
    data = tomllib.loads(text)
    return SecondPlan(replace(full_plan(), digest=digest), data["good"], data["equal_m"])


@cache
def quick_second_plan() -> SecondPlan:
    """Return a plan that only shows that everything runs: few placements, few scenes."""
    plan = full_second_plan()
    good = {**plan.good, "each": 1, "seeds": [1], "selected": 1}
    equal_m = {**plan.equal_m, "rows": plan.equal_m["rows"][:1], "each": 1, "seeds": [1]}
    return SecondPlan(quickly(plan.study), good, equal_m)


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
