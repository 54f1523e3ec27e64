"""The plan of the study of cameras, as `plan.toml` has it: fixed before the first run."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

from pe_core.base import Table
from pe_core.sensors.camera import Camera

from ..plan import (
    PLAN_FILE,
    SPLITS,
    PlacementRule,
    StudyPlan,
    full_plan,
    placement_rule,
    quick_plan,
    region_of,
    text_and_digest,
    training_rule,
)


@dataclass(frozen=True, slots=True)
class PictureRule:
    """Noise of pictures, light on surfaces away from the sun, contrast of the ground."""

    noise: float
    ambient: float
    ground_contrast: float


@dataclass(frozen=True, slots=True)
class CameraPlan:
    """The whole plan.

    Attributes
    ----------
    study : StudyPlan
        The LiDAR study's plan, whose scenes and precision are shared, with the seed of the scenes;
        digest, region, training and statistics are those of the cameras.
    seed : int
        Of placements.
    vehicle : str
    cameras : int
        Of a rig.
    model : Camera
    count : mapping
        Placements that see all round (True) and that do not (False).
    placements : PlacementRule
    yaw_deg : float
        Greatest deviation from four directions at right angles.
    scenes : mapping
        How many of the shared scenes are used, by split.
    pictures : PictureRule
    min_seed_rho, min_ap : float
        With less, nothing is said.
    """

    study: StudyPlan
    seed: int
    vehicle: str
    cameras: int
    model: Camera
    count: Mapping[bool, int]
    placements: PlacementRule
    yaw_deg: float
    scenes: Mapping[str, int]
    pictures: PictureRule
    min_seed_rho: float
    min_ap: float

    @property
    def digest(self) -> str:
        """SHA-256 of the two files' content, which results keep."""
        return self.study.digest


@cache
def full_camera_plan() -> CameraPlan:
    """Return the plan of the study of cameras."""
    return camera_plan_of(*text_and_digest(__package__))


@cache
def quick_camera_plan() -> CameraPlan:
    """Return a plan that only shows that everything runs: two placements, few scenes and pixels."""
    plan, quick = full_camera_plan(), quick_plan()
    study = replace(
        plan.study,
        digest=f"quick-{plan.digest}",
        scenes=quick.scenes,
        mixed=quick.mixed,
        training=replace(quick.training, mirrored=False),
        statistics=replace(plan.study.statistics, permutations=99, resamples=50, scenes=8),
    )
    return replace(
        plan,
        study=study,
        count={True: 1, False: 1},
        model=replace(plan.model, width=plan.model.width // 2, height=plan.model.height // 2),
        scenes={"train": 16, "validation": 4, "test": 8},
    )


def camera_plan_of(text: str, digest: str) -> CameraPlan:
    """Return the plan of a file's text.

    Raises
    ------
    InputError
        When a key is missing, unknown, or has another type.
    """
    table, shared = Table(tomllib.loads(text), PLAN_FILE), full_plan()
    table.whole("version")
    seed, rig = table.whole("seed"), table.table("rig")
    placements, pictures = table.table("placements"), table.table("pictures")
    scenes, statistics = table.table("scenes"), table.table("statistics")
    yaw_deg = placements.number("yaw_deg")
    tested = replace(
        shared.statistics,
        primary=statistics.text("primary"),
        alpha=statistics.number("alpha"),
        permutations=statistics.whole("permutations"),
        resamples=statistics.whole("resamples"),
    )
    vehicle = rig.text("vehicle", choices=shared.vehicles[:1])  # its scenes are those of the first
    width, height = rig.whole("width_px"), rig.whole("height_px")
    plan = CameraPlan(
        study=replace(
            shared,
            digest=digest,
            vehicles=(vehicle,),
            region=region_of(table.table("region")),
            training=training_rule(table.table("training"), mirrored=False),
            statistics=tested,
        ),
        seed=seed,
        vehicle=vehicle,
        cameras=rig.whole("cameras"),
        model=Camera("study camera", width, height, math.radians(rig.number("hfov_deg"))),
        count={True: rig.whole("all_round"), False: rig.whole("blind")},
        placements=placement_rule(placements),
        yaw_deg=yaw_deg,
        scenes={split: scenes.whole(split) for split in SPLITS},
        pictures=PictureRule(
            *(pictures.number(key) for key in ("noise", "ambient", "ground_contrast"))
        ),
        min_seed_rho=statistics.number("min_seed_rho"),
        min_ap=statistics.number("min_ap"),
    )
    for part in (rig, scenes, pictures, statistics, table):
        part.finish()
    return plan
