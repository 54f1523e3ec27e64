"""The plan of the study of cameras, as `plan.toml` has it: fixed before the first run."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

from pe_core.sensors.camera import Camera

from ..plan import (
    DetectionRegion,
    PlacementRule,
    StudyPlan,
    TrainingRule,
    full_plan,
    quickly,
    rule_of,
    text_and_digest,
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

    `study` is the LiDAR study's plan, whose scenes and precision are shared, with the seed of the
    scenes; digest (of both files), region, training and statistics are those of the cameras.
    """

    study: StudyPlan
    seed: int
    """Of placements."""
    vehicle: str
    cameras: int
    model: Camera
    count: Mapping[bool, int]
    """Placements that see all round (True) and that do not (False)."""
    placements: PlacementRule
    yaw_deg: float
    """Greatest deviation from four directions at right angles."""
    scenes: Mapping[str, int]
    """How many of the shared scenes are used, by split."""
    pictures: PictureRule
    min_seed_rho: float
    min_ap: float
    """With less, nothing is said."""


@cache
def full_camera_plan() -> CameraPlan:
    """Return the plan of the study of cameras."""
    text, digest = text_and_digest(__package__)
    data, shared = tomllib.loads(text), full_plan()
    rig, placements, tested = data["rig"], data["placements"], data["statistics"]
    limits = {key: tested.pop(key) for key in ("min_seed_rho", "min_ap")}
    size = rig["width_px"], rig["height_px"]
    return CameraPlan(
        study=replace(
            shared,
            digest=digest,
            vehicles=(rig["vehicle"],),  # its scenes are those of the LiDARs' first vehicle
            region=rule_of(DetectionRegion, data["region"]),
            training=rule_of(TrainingRule, data["training"], mirrored=False),
            statistics=replace(shared.statistics, **tested),
        ),
        seed=data["seed"],
        vehicle=rig["vehicle"],
        cameras=rig["cameras"],
        model=Camera("study camera", *size, math.radians(rig["hfov_deg"])),
        count={True: rig["all_round"], False: rig["blind"]},
        yaw_deg=placements.pop("yaw_deg"),
        placements=rule_of(PlacementRule, placements),
        scenes=data["scenes"],
        pictures=PictureRule(**data["pictures"]),
        **limits,
    )


@cache
def quick_camera_plan() -> CameraPlan:
    """Return a plan that only shows that everything runs: two placements, few scenes and pixels."""
    plan = full_camera_plan()
    return replace(
        plan,
        study=quickly(plan.study),
        count={True: 1, False: 1},
        model=replace(plan.model, width=plan.model.width // 2, height=plan.model.height // 2),
        scenes={"train": 8, "validation": 4, "test": 4},
    )
