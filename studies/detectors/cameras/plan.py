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
    quick_plan,
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
    """Return the plan of a file's text; a key that is missing or unknown is an exception."""
    data, shared = tomllib.loads(text), full_plan()
    rig, placements, tested = data["rig"], data["placements"], data["statistics"]
    limits = {key: tested.pop(key) for key in ("min_seed_rho", "min_ap")}
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
        model=Camera(
            "study camera", rig["width_px"], rig["height_px"], math.radians(rig["hfov_deg"])
        ),
        count={True: rig["all_round"], False: rig["blind"]},
        yaw_deg=placements.pop("yaw_deg"),
        placements=rule_of(PlacementRule, placements),
        scenes=data["scenes"],
        pictures=PictureRule(**data["pictures"]),
        **limits,
    )
