"""The plan of our own study, as `plan.toml` has it: fixed before the first run."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from itertools import pairwise
from typing import Any

from pe_core.base import Table

PLAN_FILE = "plan.toml"
FIXED, ACROSS, MIXED = "fixed", "across", "mixed"
"""The designs: one rig at many placements; rigs of other hardware; one detector for many."""
SPLITS = ("train", "validation", "test")
PLAIN, TOWN = "plain", "town"
"""Worlds: flat ground with distractors; hills, houses and parked rows besides."""
GRID, POINTS = "grid", "points"
"""Detectors: counts of points in a grid of voxels; learned features of the points of a pillar."""


@dataclass(frozen=True, slots=True)
class PlacementRule:
    """How the place of a LiDAR is drawn; the fields are those of the table in the file."""

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
    """The whole plan.

    Attributes
    ----------
    digest : str
        SHA-256 of the file's content, which results keep.
    seed : int
    vehicles : tuple of str
    hardware : mapping
        Name in the catalogue by channel count.
    fixed : mapping
        LiDARs, channels, and how many placements see all round or do not, on each vehicle.
    across : tuple of (lidars, channels, placements)
    mixed : mapping
        Placements and scenes of the mixed detector.
    step_fixed, step_across : int, tuple of str
        Placements of the steps.
    """

    digest: str
    seed: int
    vehicles: tuple[str, ...]
    placements: PlacementRule
    hardware: Mapping[int, str]
    fixed: Mapping[str, int]
    across: tuple[tuple[int, int, int], ...]
    mixed: Mapping[str, int]
    scenes: SceneRule
    region: DetectionRegion
    training: TrainingRule
    precision: PrecisionRule
    statistics: StatisticsRule
    step_fixed: int
    step_across: tuple[str, ...]
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
        mixed={"trained": 2, "fresh": 0, "scenes": 16, "test_scenes": 8},
        scenes=replace(plan.scenes, counts={"train": 32, "validation": 8, "test": 16}),
        training=replace(plan.training, seeds=(1,), min_epochs=2, max_epochs=2),
        statistics=replace(plan.statistics, permutations=99, resamples=50, scenes=8),
        steps=(),
    )


def plan_of(text: str) -> StudyPlan:
    """Return the plan of a file's text.

    Raises
    ------
    InputError
        When a key is missing, unknown, or has another type.
    """
    table = Table(tomllib.loads(text), PLAN_FILE)
    table.whole("version")
    plan = StudyPlan(
        digest=_digest(text),
        seed=table.whole("seed"),
        vehicles=table.table("vehicles").texts("names"),
        placements=placement_rule(table.table("placements")),
        hardware={int(k): str(v) for k, v in table.table("hardware").data.items()},
        fixed=_whole_numbers(table.table("fixed"), "lidars", "channels", "all_round", "blind"),
        across=tuple(tuple(map(int, row)) for row in table.table("across").raw("hardware")),  # type: ignore[misc]
        mixed=_whole_numbers(table.table("mixed"), "trained", "fresh", "scenes", "test_scenes"),
        scenes=_scene_rule(table.table("scenes")),
        region=region_of(table.table("region")),
        training=training_rule(table.table("training")),
        precision=_precision_rule(table.table("precision")),
        statistics=_statistics_rule(table.table("statistics")),
        **_steps(table.table("steps")),
    )
    table.finish()
    return plan


def placement_rule(table: Table) -> PlacementRule:
    """Return the rule of a table; the reader of the table has read all other keys of it."""
    roof, side = (table.numbers(key, 2) for key in ("roof_height_m", "side_height_m"))
    rule = PlacementRule(
        table.number("roof_share"),
        (roof[0], roof[1]),
        (side[0], side[1]),
        table.number("side_gap_m"),
        table.number("tilt_deg"),
        table.number("apart_m"),
        table.whole("round_directions"),
        table.number("round_distance_m"),
        numbers_of(table, "round_heights_m"),
    )
    table.finish()
    return rule


def _scene_rule(table: Table) -> SceneRule:
    shifts = table.table("shifts")
    rule = SceneRule(
        {split: table.whole(split) for split in SPLITS},
        {split: shifts.number(split) for split in SPLITS},
        table.number("distractors"),
        table.number("range_noise_m"),
        table.number("dropped"),
    )
    shifts.finish()
    table.finish()
    return rule


def region_of(table: Table) -> DetectionRegion:
    """Return the region of a table."""
    region = DetectionRegion(table.number("x_m"), table.number("y_m"), table.number("cell_m"))
    table.finish()
    return region


def training_rule(table: Table, mirrored: bool = True) -> TrainingRule:
    """Return the rule of a table; whether scenes are mirrored follows from the inputs."""
    rule = TrainingRule(
        tuple(map(int, numbers_of(table, "seeds"))),
        table.whole("batch"),
        table.number("rate"),
        table.number("average"),
        table.whole("min_epochs"),
        table.whole("max_epochs"),
        table.whole("window"),
        table.number("improvement"),
        mirrored,
    )
    table.finish()
    return rule


def _precision_rule(table: Table) -> PrecisionRule:
    rule = PrecisionRule(numbers_of(table, "distances_m"), numbers_of(table, "rings_m"))
    table.finish()
    return rule


def _statistics_rule(table: Table) -> StatisticsRule:
    rule = StatisticsRule(
        table.text("primary"),
        table.number("alpha"),
        table.whole("permutations"),
        table.whole("resamples"),
        table.number("useful_rho"),
        table.number("tie_ap"),
        table.whole("scenes"),
    )
    table.finish()
    return rule


def _steps(table: Table) -> dict[str, Any]:
    steps = []
    for row in table.tables("runs"):
        world = row.text("world", choices=(PLAIN, TOWN))
        detector = row.text("detector", choices=(GRID, POINTS))
        steps.append(RealismStep(world, detector, tuple(map(int, numbers_of(row, "seeds")))))
        row.finish()
    fixed, across = table.whole("fixed"), table.texts("across")
    table.finish()
    return {"step_fixed": fixed, "step_across": across, "steps": tuple(steps)}


def numbers_of(table: Table, key: str) -> tuple[float, ...]:
    """Return the numbers of a key, however many there are."""
    return table.numbers(key, len(table.raw(key)))


def _whole_numbers(table: Table, *keys: str) -> dict[str, int]:
    values = {key: table.whole(key) for key in keys}
    table.finish()
    return values
