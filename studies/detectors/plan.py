"""The plans of our own studies, as the files of `plans` have them: fixed before the first run.

A plan is data: the keys of its file are its attributes. The plans of cameras, searches, frames and
the second one are the first with some of its keys replaced, and their own file beside it.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

PLANS = Path(__file__).parent / "plans"
FIXED = "fixed"
ACROSS = "across"
MIXED = "mixed"
"""The designs: one rig at many placements; rigs of other hardware; one detector for many."""
CAMERAS = "cameras"
AFTER_SEARCH = "after_search"
FRAMES = "frames"
"""The designs of the other studies, and their folders."""
SECOND = "second"
GOOD = "good"
EQUAL_M = "equal-m"
LAYOUTS = "layouts"
SEARCHES = "searches"
"""The folder of the second plan, and its parts. Its file has those that had code first."""
LAYOUT_SEEDS = (1, 2, 3)
SEARCH_SEEDS = (1, 2, 3)
SEARCHED_SEEDS = (1, 2)
"""Of the mixed detector; of the searches, and of the detectors after them."""
SHUTTLE = "shuttle"
SPLITS = ("train", "validation", "test")
PLAIN = "plain"
TOWN = "town"
"""Worlds: flat ground with distractors; hills, houses and parked rows besides."""
GRID = "grid"
POINTS = "points"
"""Detectors: counts of points in a grid of voxels; learned features of the points of a pillar."""
QUICK_SCENES = {"train": 8, "validation": 4, "test": 4}
QUICK = {
    "scenes": QUICK_SCENES,
    "mixed": {"trained": 2, "fresh": 0, "scenes": 8, "test_scenes": 4},
    "training": {"seeds": (1,), "min_epochs": 2, "max_epochs": 2},
    "statistics": {"permutations": 99, "resamples": 50, "scenes": 8},
}
QUICK_SEARCHES = {"samples": 4096, "evaluations": 6}
"""What a plan has that only shows that everything runs."""
OWN = "."
"""The folder of the study of LiDARs, from that of all."""


class Plan(Mapping[str, Any]):
    """A plan, or a table of one: its keys are attributes, its tables plans. It does not change."""

    def __init__(self, table: Mapping[str, Any]) -> None:
        for key, value in table.items():
            is_table = isinstance(value, Mapping) and not isinstance(value, Plan)
            self.__dict__[key] = Plan(value) if is_table else _frozen(value)

    def __getattr__(self, key: str) -> Any:
        raise AttributeError(f"the plan has no {key}")

    def __getitem__(self, key: str) -> Any:
        return self.__dict__[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dict__)

    def __len__(self) -> int:
        return len(self.__dict__)

    def __hash__(self) -> int:
        return hash(tuple(self.__dict__.items()))

    def but(self, **changes: Any) -> Plan:
        """Return the plan with other values of some keys; tables are changed key by key."""
        new = {
            key: self[key].but(**value)
            if isinstance(self.get(key), Plan) and isinstance(value, Mapping)
            else value
            for key, value in changes.items()
        }
        return Plan({**self, **new})


def _frozen(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(map(_frozen, value))
    return Plan(value) if isinstance(value, dict) else value


def shape_of(region: Plan) -> tuple[int, int]:
    """Return how many cells a region has along x and y."""
    return round(2.0 * region.x_m / region.cell_m), round(2.0 * region.y_m / region.cell_m)


def rings_of(plan: Plan) -> dict[str, tuple[float, float]]:
    """Return inner and outer distance [m] of each ring by its name in the results."""
    return {f"{a:g} to {b:g} m": (a, b) for a, b in pairwise(plan.precision.rings_m)}


def _text(name: str) -> str:
    return (PLANS / f"{name}.toml").read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def full_plan() -> Plan:
    """Return the plan of the study of LiDARs; `digest` is of its file, which results keep."""
    data = tomllib.loads(_text("lidars"))
    return Plan(data).but(
        digest=_digest(_text("lidars")),
        vehicles=tuple(data["vehicles"]["names"]),
        training={"mirrored": True},
    )


def _other(name: str) -> tuple[Plan, str]:
    """Return the own plan of another study, and the digest of both files."""
    return Plan(tomllib.loads(_text(name))), _digest(_text("lidars") + _text(name))


@cache
def full_camera_plan() -> Plan:
    """Return the plan of cameras, on the first vehicle; `cameras` is its own file."""
    own, digest = _other(CAMERAS)
    return full_plan().but(
        digest=digest,
        vehicles=(own.rig.vehicle,),
        region=own.region,
        training={**own.training, "mirrored": False},
        statistics=own.statistics,
        cameras=own,
    )


@cache
def full_after_search_plan() -> Plan:
    """Return the plan of detectors before and after a search; `searches` is its own file.

    `searches.rigs` has the start of each rig; `evaluations` of 0: as many as the method takes.
    """
    own, digest = _other(AFTER_SEARCH)
    rigs = {name: own[name] for name in own if isinstance(own[name], Plan) and name != "search"}
    first = full_plan()
    return first.but(
        digest=digest,
        vehicles=(*first.vehicles, SHUTTLE),  # those before keep their scenes
        training={"seeds": own.seeds},
        searches={**own.search, "seeds": (own.search.seed,), "evaluations": 0, "rigs": rigs},
    )


@cache
def full_frames_plan() -> Plan:
    """Return the plan of detectors with one frame and with five; `frames` is its own file."""
    own, digest = _other(FRAMES)
    return full_plan().but(
        digest=digest,
        scenes={**own.scenes, **own.counts},
        mixed={"scenes": own.counts.train},
        region=own.region,
        training=own.training,
        frames=own,
    )


@cache
def full_second_plan() -> Plan:
    """Return the second plan; `second` is its own file."""
    own, digest = _other(SECOND)
    searches = {**full_after_search_plan().searches, "seeds": SEARCH_SEEDS, "rigs": {}, "count": 6}
    seeds = {"layout_seeds": LAYOUT_SEEDS, "searched_seeds": SEARCHED_SEEDS}
    return full_plan().but(digest=digest, second=own, searches=searches, **seeds)


def quickly(plan: Plan, **changes: Any) -> Plan:
    """Return a plan with few scenes and short trainings, and with other changes."""
    return plan.but(digest=f"quick-{plan.digest}", **QUICK).but(**changes)


@cache
def quick_plan() -> Plan:
    """Return a quick plan of LiDARs: three placements."""
    plan = full_plan()
    return quickly(
        plan,
        vehicles=plan.vehicles[:1],
        fixed={"all_round": 1, "blind": 1},
        across={"hardware": ((1, 16, 1),)},
        steps={"runs": ()},
    )


@cache
def quick_camera_plan() -> Plan:
    """Return a quick plan of cameras: two placements, few pixels."""
    rig = full_camera_plan().cameras.rig
    pixels = {key: rig[key] // 2 for key in ("width_px", "height_px")}
    own = {"rig": {**pixels, "all_round": 1, "blind": 1}, "scenes": QUICK_SCENES}
    return quickly(full_camera_plan(), cameras=own)


@cache
def quick_after_search_plan() -> Plan:
    """Return a quick plan of searches: one rig."""
    plan = full_after_search_plan()
    rigs = dict(list(plan.searches.rigs.items())[1:])
    return Plan({**quickly(plan), "searches": {**plan.searches, **QUICK_SEARCHES, "rigs": rigs}})


@cache
def quick_frames_plan() -> Plan:
    """Return a quick plan of frames: four placements."""
    plan = full_frames_plan()
    seeds = {"seeds": plan.training.seeds}
    return quickly(plan, vehicles=plan.vehicles[:1], training=seeds, frames={"each": 4})


@cache
def quick_second_plan() -> Plan:
    """Return a quick second plan: few placements."""
    plan = full_second_plan()
    few = {"each": 1, "seeds": (1,)}
    own = {"good": {**few, "selected": 1}, "equal_m": {**few, "rows": plan.second.equal_m.rows[:1]}}
    seeds = {"layout_seeds": LAYOUT_SEEDS[:1], "searched_seeds": SEARCHED_SEEDS[:1]}
    searches = {**QUICK_SEARCHES, "seeds": SEARCH_SEEDS[:2], "count": 1}
    return quickly(plan, second=own, searches=searches, **seeds)


FULL_AND_QUICK = {
    OWN: (full_plan, quick_plan),
    CAMERAS: (full_camera_plan, quick_camera_plan),
    AFTER_SEARCH: (full_after_search_plan, quick_after_search_plan),
}


def plans_of(quick: bool) -> dict[str, Plan]:
    """Return the plans of the studies that share a page, by folder."""
    return {name: plans[quick]() for name, plans in FULL_AND_QUICK.items()}
