"""The plan of the detectors before and after a search, as `plan.toml` has it."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from ..placements import SHUTTLE, PoseValues
from ..plan import StudyPlan, full_plan, quickly, text_and_digest

START = "start"
"""Name of the placement before a search; those after it have that of their objective."""
TITLES = {"experiment_4": "experiment 4", "shuttle": "shuttle"}
"""The rigs of the plan, in words."""
AxisRanges = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, slots=True)
class SearchedRig:
    """A rig of LiDARs of one model on a vehicle, before a search.

    `bounds` are those of each LiDAR, by axis [m, rad]; empty: as shipped.
    """

    name: str
    vehicle: str
    model: str
    poses: tuple[PoseValues, ...]
    bounds: AxisRanges
    clear_housings: bool

    def placement_name(self, what: str, seed: int | None = None) -> str:
        """Return the name of a placement by what found it, with its seed if there are several."""
        name = f"after-{self.name}-{what}".replace("_", "-")
        return name if seed is None else f"{name}-k{seed}"


@dataclass(frozen=True, slots=True)
class AfterSearchPlan:
    """The whole plan.

    `study` is the LiDAR study's plan, with this one's seeds, and with the digest of both files.
    """

    study: StudyPlan
    rigs: tuple[SearchedRig, ...]
    objectives: tuple[str, ...]
    search_seeds: tuple[int, ...]
    samples: int
    """Voxels on which start and result of a search are scored."""
    evaluations: int
    """Of a search; 0: as many as the method takes."""

    def named_seed(self, seed: int) -> int | None:
        """Return the seed of a search as names have it: None if there is one."""
        return seed if len(self.search_seeds) > 1 else None

    @property
    def whats(self) -> tuple[str, ...]:
        """What the placements of a rig are: the start, and what each objective found."""
        return (START, *self.objectives)


@cache
def full_after_search_plan() -> AfterSearchPlan:
    """Return the plan of the study."""
    text, digest = text_and_digest(__package__)
    data, shared = tomllib.loads(text), full_plan()
    return AfterSearchPlan(
        study=replace(
            shared,
            digest=digest,
            vehicles=(*shared.vehicles, SHUTTLE),  # those before keep their scenes
            training=replace(shared.training, seeds=tuple(data["seeds"])),
        ),
        rigs=tuple(_rig(name, data[name]) for name in TITLES),
        objectives=tuple(data["search"]["objectives"]),
        search_seeds=(data["search"]["seed"],),
        samples=data["search"]["samples"],
        evaluations=0,
    )


@cache
def quick_after_search_plan() -> AfterSearchPlan:
    """Return a plan that only shows that everything runs: one rig, few scenes, short searches."""
    plan = full_after_search_plan()
    return replace(plan, study=quickly(plan.study), rigs=plan.rigs[1:], samples=4096, evaluations=6)


def _rig(name: str, table: Mapping[str, Any]) -> SearchedRig:
    return SearchedRig(
        name,
        table["vehicle"],
        table["model"],
        tuple(map(tuple, table["poses"])),
        dict(_bounds(key, low, high) for key, (low, high) in table.get("bounds", {}).items()),
        table["clear_housings"],
    )


def _bounds(key: str, low: float, high: float) -> tuple[str, tuple[float, float]]:
    axis = key.removesuffix("_deg")
    return (axis, (low, high)) if axis == key else (axis, (math.radians(low), math.radians(high)))
