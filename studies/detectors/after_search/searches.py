"""The searches of the study, and the placements that they start from and find."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pe_core as pe
import pe_tools as pt
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.search import PAPER_FREE

from ...results_file import Json, made_by, read_json
from ..placements import Placement, PoseValues, vehicle
from ..plan import AFTER_SEARCH
from .plan import START, AfterSearchPlan, SearchedRig

PLACEMENTS = "placements.json"
POSITION_DIGITS, ANGLE_DIGITS = 3, 2
"""Of a placement [m, deg]: what is scored and cast is what the file says."""


def study_of(plan: AfterSearchPlan, rig: SearchedRig, objective: str, seed: int) -> pe.Study:
    """Return the study whose search is run: the shipped defaults, but for what the plan says."""
    sensors = placement_of(rig, START, rig.poses).rig()
    axes = tuple(rig.bounds) or PAPER_FREE
    search = pe.Search(
        {sensor.name: axes for sensor in sensors},
        {sensor.name: rig.bounds for sensor in sensors if rig.bounds},
        seed=seed,
        evaluations=plan.evaluations,
        objective=objective,
        mounting=pe.Mounting(constraints=pe.Constraints(clear_housings=rig.clear_housings)),
    )
    return pe.Study(sensors, vehicle(rig.vehicle), samples=plan.samples, search=search)


def placement_of(
    rig: SearchedRig, what: str, poses: tuple[PoseValues, ...], seed: int | None = None
) -> Placement:
    """Return a placement of a rig by what found it."""
    name = rig.placement_name(what, seed)
    return Placement(name, rig.vehicle, poses, False, AFTER_SEARCH, rig.model)


def searched_placements(
    plan: AfterSearchPlan, folder: Path, report: Callable[[str], None] | None = None
) -> list[Placement]:
    """Return the placements of all rigs; searches that the folder does not have are run.

    `report` takes a line for each. Without it none is run, and placements that are not there are
    left out. A file of another plan is an `InputError`.
    """
    path = folder / PLACEMENTS
    kept: Json = {"plan": plan.study.digest, "searches": {}}
    if path.exists():
        kept = read_json(path)
        if kept.get("plan") != plan.study.digest or not isinstance(kept.get("searches"), dict):
            raise InputError(path, "plan", plan.study.digest, str(kept.get("plan")))
    placements = []
    for rig in plan.rigs:
        placements.append(placement_of(rig, START, rig.poses))
        for objective, seed in itertools.product(plan.objectives, plan.search_seeds):
            named = plan.named_seed(seed)
            key = f"{rig.name}, {objective}" + (f", {named}" if named else "")
            if key not in kept["searches"] and report is not None:
                report(f"searching {key}")
                kept["searches"][key] = _search(plan, rig, objective, seed)
                path.parent.mkdir(parents=True, exist_ok=True)
                write_bytes(path, dump_json(kept).encode())
            if key in kept["searches"]:
                poses = tuple(map(tuple, kept["searches"][key]["poses"]))
                placements.append(placement_of(rig, objective, poses, named))
    return placements


@dataclass(frozen=True)
class _SearchIdentity:
    """What `made_by` notes of a search besides the versions."""

    objective: str
    seed: int


def _search(plan: AfterSearchPlan, rig: SearchedRig, objective: str, seed: int) -> Json:
    """Run a search; return what was found, as JSON data."""
    job = pt.OptimizeJob(study_of(plan, rig, objective, seed))
    for _ in job:
        pass
    outcome = job.outcome
    assert outcome is not None
    poses = tuple(_rounded(sensor.pose) for sensor in outcome.study.rig)
    in_traffic = outcome.in_traffic
    shown = placement_of(rig, objective, poses).listed()
    return {
        "method": outcome.start.search.method,
        "seed": seed,
        "evaluations": outcome.evaluations,
        "entropy": [outcome.before.entropy, outcome.after.entropy],
        "expected_ap": in_traffic and [score.ap for score in in_traffic],
        "x y z roll pitch yaw": shown["x y z roll pitch yaw"],
        "poses": [list(pose) for pose in poses],
        "seconds": round(outcome.seconds, 1),
        "made": made_by(_SearchIdentity(objective, seed)),
    }


def _rounded(pose: pe.Pose) -> PoseValues:
    position = (round(float(w), POSITION_DIGITS) for w in pose.position)
    angles = (round(math.degrees(w), ANGLE_DIGITS) for w in pose.rpy)
    return (*position, *angles)
