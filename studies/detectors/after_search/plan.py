"""The plan of the detectors before and after a search, as `plan.toml` has it."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from ..placements import SHUTTLE
from ..plan import StudyPlan, full_plan, quick_plan, text_and_digest
from ..posed_sensors import PoseValues

START = "start"
"""Name of the placement before a search; those after it have that of their objective."""
RIGS = ("experiment_4", "shuttle")
TITLES = {RIGS[0]: "experiment 4", RIGS[1]: "shuttle"}
AxisRanges = Mapping[str, tuple[float, float]]


@dataclass(frozen=True, slots=True)
class SearchedRig:
    """A rig of LiDARs of one model on a vehicle, before a search.

    Attributes
    ----------
    name, vehicle, model : str
    poses : tuple of PoseValues
        Where the LiDARs are at the start.
    bounds : mapping
        Of each LiDAR, by axis [m, rad]; empty: as shipped.
    clear_housings : bool
        Whether the search keeps housings clear of the body and of each other.
    """

    name: str
    vehicle: str
    model: str
    poses: tuple[PoseValues, ...]
    bounds: AxisRanges
    clear_housings: bool


@dataclass(frozen=True, slots=True)
class AfterSearchPlan:
    """The whole plan.

    Attributes
    ----------
    study : StudyPlan
        The LiDAR study's plan, with this one's seeds, and with the digest of both files.
    rigs : tuple of SearchedRig
    objectives : tuple of str
    search_seed, samples : int
        Of the searches; voxels on which their start and result are scored.
    evaluations : int
        Of a search; 0: as many as the method takes.
    confidence : float
        Of the intervals.
    """

    study: StudyPlan
    rigs: tuple[SearchedRig, ...]
    objectives: tuple[str, ...]
    search_seed: int
    samples: int
    evaluations: int
    confidence: float

    @property
    def digest(self) -> str:
        """SHA-256 of the two files' content, which placements and results keep."""
        return self.study.digest


@cache
def full_after_search_plan() -> AfterSearchPlan:
    """Return the plan of the study."""
    return after_search_plan_of(*text_and_digest(__package__))


@cache
def quick_after_search_plan() -> AfterSearchPlan:
    """Return a plan that only shows that everything runs: one rig, few scenes, short searches."""
    plan, quick = full_after_search_plan(), quick_plan()
    study = replace(
        plan.study,
        digest=f"quick-{plan.digest}",
        scenes=quick.scenes,
        mixed=quick.mixed,
        training=quick.training,
        statistics=quick.statistics,
    )
    return replace(plan, study=study, rigs=plan.rigs[1:], samples=4096, evaluations=6)


def after_search_plan_of(text: str, digest: str) -> AfterSearchPlan:
    """Return the plan of a file's text; a key that is missing is an exception."""
    data, shared = tomllib.loads(text), full_plan()
    return AfterSearchPlan(
        study=replace(
            shared,
            digest=digest,
            vehicles=(*shared.vehicles, SHUTTLE),  # those before keep their scenes
            training=replace(shared.training, seeds=tuple(data["seeds"])),
        ),
        rigs=tuple(_rig(name, data[name]) for name in RIGS),
        objectives=tuple(data["search"]["objectives"]),
        search_seed=data["search"]["seed"],
        samples=data["search"]["samples"],
        evaluations=0,
        confidence=data["confidence"],
    )


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
