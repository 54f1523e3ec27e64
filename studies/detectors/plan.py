"""The plan of our own study, as `plan.toml` has it: fixed before the first run."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from itertools import pairwise
from typing import Any, TypeVar

T = TypeVar("T")

PLAN_FILE = "plan.toml"
FIXED, ACROSS, MIXED = "fixed", "across", "mixed"
"""The designs: one rig at many placements; rigs of other hardware; one detector for many."""
CAMERAS, AFTER_SEARCH = "cameras", "after_search"
"""The designs of the other studies, and their folders."""
SPLITS = ("train", "validation", "test")
PLAIN, TOWN = "plain", "town"
"""Worlds: flat ground with distractors; hills, houses and parked rows besides."""
GRID, POINTS = "grid", "points"
"""Detectors: counts of points in a grid of voxels; learned features of the points of a pillar."""


@dataclass(frozen=True, slots=True)
class PlacementRule:
    """How the place of a sensor is drawn; the fields are those of the table in the file."""

    roof_share: float
    roof_height_m: tuple[float, float]
    side_height_m: tuple[float, float]
    side_gap_m: float
    tilt_deg: float
    apart_m: float
    round_directions: int
    round_distance_m: float
    round_heights_m: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class SceneRule:
    """How many scenes there are, by split, and what is in them besides the prior's objects."""

    counts: Mapping[str, int]
    shifts: Mapping[str, float]
    distractors: float
    range_noise_m: float
    dropped: float


@dataclass(frozen=True, slots=True)
class DetectionRegion:
    """The rectangle round the vehicle in which objects are to be found [m]."""

    x_m: float
    y_m: float
    cell_m: float

    @property
    def shape(self) -> tuple[int, int]:
        """Cells along x and y."""
        return round(2.0 * self.x_m / self.cell_m), round(2.0 * self.y_m / self.cell_m)


@dataclass(frozen=True, slots=True)
class TrainingRule:
    """How a detector is trained, and when its training ends."""

    seeds: tuple[int, ...]
    batch: int
    rate: float
    average: float
    min_epochs: int
    max_epochs: int
    window: int
    improvement: float
    mirrored: bool = True


@dataclass(frozen=True, slots=True)
class PrecisionRule:
    """Distances at which a detection is right, and rings by which AP is reported, too [m]."""

    distances_m: tuple[float, ...]
    rings_m: tuple[float, ...]

    @property
    def rings(self) -> dict[str, tuple[float, float]]:
        """Inner and outer distance [m] of each ring by its name in the results."""
        return {f"{a:g} to {b:g} m": (a, b) for a, b in pairwise(self.rings_m)}


@dataclass(frozen=True, slots=True)
class StatisticsRule:
    """The primary score, and how correlations are tested."""

    primary: str
    alpha: float
    permutations: int
    resamples: int
    useful_rho: float
    tie_ap: float
    scenes: int


@dataclass(frozen=True, slots=True)
class RealismStep:
    """Runs in another world or with another detector."""

    world: str
    detector: str
    seeds: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class StudyPlan:
    """The whole plan; `digest` is the SHA-256 of the file's content, which results keep."""

    digest: str
    seed: int
    vehicles: tuple[str, ...]
    placements: PlacementRule
    hardware: Mapping[int, str]
    """Name in the catalogue by channel count."""
    fixed: Mapping[str, int]
    """LiDARs, channels, and how many placements see all round or do not, on each vehicle."""
    across: tuple[tuple[int, int, int], ...]
    """LiDARs, channels, placements."""
    mixed: Mapping[str, int]
    scenes: SceneRule
    region: DetectionRegion
    training: TrainingRule
    precision: PrecisionRule
    statistics: StatisticsRule
    step_fixed: int
    step_across: tuple[str, ...]
    """How many placements of the fixed design the steps have; all across of these vehicles."""
    steps: tuple[RealismStep, ...]


@cache
def full_plan() -> StudyPlan:
    """Return the plan of the study."""
    return plan_of(_text_of(__package__))


def text_and_digest(package: str) -> tuple[str, str]:
    """Return the text of the plan of a study that shares this one, and the digest of both files."""
    text = _text_of(package)
    return text, _digest(_text_of(__package__) + text)


def _text_of(package: str) -> str:
    return resources.files(package).joinpath(PLAN_FILE).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def quick_plan() -> StudyPlan:
    """Return a plan that only shows that everything runs: three placements, few scenes."""
    plan = full_plan()
    return replace(
        plan,
        digest=f"quick-{plan.digest}",
        vehicles=plan.vehicles[:1],
        fixed={**plan.fixed, "all_round": 1, "blind": 1},
        across=((1, 16, 1),),
        mixed={"trained": 2, "fresh": 0, "scenes": 8, "test_scenes": 4},
        scenes=replace(plan.scenes, counts={"train": 16, "validation": 4, "test": 8}),
        training=replace(plan.training, seeds=(1,), min_epochs=2, max_epochs=2),
        statistics=replace(plan.statistics, permutations=99, resamples=50, scenes=8),
        steps=(),
    )


def quickly(study: StudyPlan) -> StudyPlan:
    """Return the plan of another study with the scenes and trainings of `quick_plan`."""
    quick = quick_plan()
    return replace(
        study,
        digest=f"quick-{study.digest}",
        scenes=quick.scenes,
        mixed=quick.mixed,
        training=replace(quick.training, mirrored=study.training.mirrored),
        statistics=replace(study.statistics, permutations=99, resamples=50, scenes=8),
    )


def plan_of(text: str) -> StudyPlan:
    """Return the plan of a file's text; a key that is missing or unknown is an exception."""
    data = tomllib.loads(text)
    scenes, steps = data["scenes"], data["steps"]
    counts = {split: scenes.pop(split) for split in SPLITS}
    return StudyPlan(
        digest=_digest(text),
        seed=data["seed"],
        vehicles=tuple(data["vehicles"]["names"]),
        placements=rule_of(PlacementRule, data["placements"]),
        hardware={int(k): v for k, v in data["hardware"].items()},
        fixed=data["fixed"],
        across=tuple(map(tuple, data["across"]["hardware"])),
        mixed=data["mixed"],
        scenes=SceneRule(counts, **scenes),
        region=rule_of(DetectionRegion, data["region"]),
        training=rule_of(TrainingRule, data["training"]),
        precision=rule_of(PrecisionRule, data["precision"]),
        statistics=rule_of(StatisticsRule, data["statistics"]),
        step_fixed=steps["fixed"],
        step_across=tuple(steps["across"]),
        steps=tuple(rule_of(RealismStep, row) for row in steps["runs"]),
    )


def rule_of(rule: type[T], table: Mapping[str, Any], **more: Any) -> T:
    """Return a rule from the table of a plan whose keys are the rule's fields."""
    return rule(**{k: tuple(v) if isinstance(v, list) else v for k, v in table.items()}, **more)
