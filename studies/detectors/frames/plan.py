"""The plan of frames, as `plan.toml` has it: its placements and its runs in their order."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

from ..placements import Placement, placements
from ..plan import (
    MIXED,
    DetectionRegion,
    SceneRule,
    StudyPlan,
    full_plan,
    quickly,
    rule_of,
    text_and_digest,
)
from ..runs import Run, seed_by_seed

FRAMES = "frames"


@dataclass(frozen=True, slots=True)
class MotionRule:
    """How many frames there are, and what moves between them."""

    count: int
    rate_hz: float
    own_speed: tuple[float, float]
    oncoming_y_m: float
    speed_spread: float
    speeds: Mapping[str, float]
    moving: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class FramesPlan:
    """The plan: that of the LiDAR study with fewer scenes and the digest of both files."""

    study: StudyPlan
    each: int
    motion: MotionRule
    q: float
    other_q: tuple[float, ...]
    alike_rho: float


@cache
def full_frames_plan() -> FramesPlan:
    """Return the plan."""
    text, digest = text_and_digest(__package__)
    data, first = tomllib.loads(text), full_plan()
    study = replace(
        first,
        digest=digest,
        scenes=rule_of(SceneRule, {**data["scenes"]}, counts=data["counts"]),
        mixed={**first.mixed, "scenes": data["counts"]["train"]},
        region=rule_of(DetectionRegion, data["region"]),
        training=replace(first.training, **data["training"]),
    )
    motion = rule_of(MotionRule, data["motion"])
    other_q = tuple(data["judged"].pop("other_q"))
    return FramesPlan(study, data["each"], motion, other_q=other_q, **data["judged"])


@cache
def quick_frames_plan() -> FramesPlan:
    """Return a plan that only shows that everything runs: four placements, few scenes."""
    plan = full_frames_plan()
    study = quickly(plan.study)
    training = replace(study.training, seeds=plan.study.training.seeds)
    study = replace(study, vehicles=study.vehicles[:1], training=training)
    return replace(plan, study=study, each=4)


def frames_placements(plan: FramesPlan) -> list[Placement]:
    """Return the first placements of the first plan's design *mixed*, vehicles by turns."""
    drawn = [p for p in placements(full_plan()) if p.design == MIXED]
    groups = [[p for p in drawn if p.vehicle == name][: plan.each] for name in plan.study.vehicles]
    return [
        replace(p, name=p.name.replace(MIXED, FRAMES), design=FRAMES)
        for turn in zip(*groups, strict=True)
        for p in turn
    ]


def frames_runs(plan: FramesPlan) -> list[Run]:
    """Return the runs, seed by seed; each has both arms."""
    return seed_by_seed(plan.study, frames_placements(plan))
