"""Detectors before and after a search: the searches, their placements, what the runs say."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import pe_core as pe
import pe_tools as pt
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.search import PAPER_FREE

from ..ranks import student_interval
from ..results_file import Json, made_by, read_json
from .analysis import HOLDS, OPEN, REFUTED, ApOf, Results, mean_ap, mean_ap_in
from .placements import EDGE_M, Placement, PoseValues, top_near, vehicle
from .plan import AFTER_SEARCH, SHUTTLE, Plan, rings_of
from .scores import TRAFFIC

START = "start"
"""Name of the placement before a search; those after it have that of their objective."""
PLACEMENTS = "placements.json"
POSITION_DIGITS = 3
ANGLE_DIGITS = 2
"""Of a placement [m, deg]: what is scored and cast is what the file says."""
LIDARS = (2, 4)
"""Of a rig on a roof."""
ROOF_M = 0.3
ABOVE_M = 0.1
"""The roof is what is so near to the top of a body. A search starts so high above it."""
INTERVAL_SEEDS = 3
"""Differences of fewer seeds have no interval."""
Aps = Sequence[float | None]
"""AP of a placement by seed; None for a run that is missing."""


def whats_of(plan: Plan) -> tuple[str, ...]:
    """Return what the placements of a rig are: the start, and what each objective found."""
    return (START, *plan.searches.objectives)


@cache
def on_roofs(plan: Plan) -> Plan:
    """Return the plan of part 4 of the second plan: two or four LiDARs on three vehicles."""
    vehicles = (*plan.vehicles, SHUTTLE)
    model = plan.hardware[str(plan.fixed.channels)]
    rigs = {
        f"{name}_{count}": {
            "vehicle": name,
            "model": model,
            "poses": _on_roof(vehicle(name), count),
            "clear_housings": False,
        }
        for name in vehicles
        for count in LIDARS
    }
    kept = dict(list(rigs.items())[: plan.searches.count])
    seeds = {"seeds": plan.searched_seeds}
    return plan.but(vehicles=vehicles, training=seeds, searches={"rigs": kept})


def _on_roof(body: pe.Vehicle, count: int) -> tuple[PoseValues, ...]:
    """Return poses at the middles of the roof's sides (two LiDARs) or at its corners (four)."""
    corners = body.triangles.reshape(-1, 3)
    roof = corners[corners[:, 2] >= body.bounds[1][2] - ROOF_M, :2]
    low = roof.min(axis=0) + EDGE_M
    high = roof.max(axis=0) - EDGE_M
    along = (high[0], low[0]) if count > LIDARS[0] else ((low[0] + high[0]) / 2.0,)
    places = [(x, y, top_near(body, x, y) + ABOVE_M) for x in along for y in (high[1], low[1])]
    return tuple((*(round(float(w), 3) for w in place), 0.0, 0.0, 0.0) for place in places)


def study_of(plan: Plan, name: str, objective: str, seed: int) -> pe.Study:
    """Return the study whose search is run: the shipped defaults, but for what the plan says."""
    rig = plan.searches.rigs[name]
    sensors = placement_of(plan, name, START, rig.poses).rig()
    bounds = dict(_bounds(key, *limits) for key, limits in rig.get("bounds", {}).items())
    search = pe.Search(
        {sensor.name: tuple(bounds) or PAPER_FREE for sensor in sensors},
        {sensor.name: bounds for sensor in sensors if bounds},
        seed=seed,
        evaluations=plan.searches.evaluations,
        objective=objective,
        mounting=pe.Mounting(constraints=pe.Constraints(clear_housings=rig.clear_housings)),
    )
    return pe.Study(sensors, vehicle(rig.vehicle), samples=plan.searches.samples, search=search)


def _bounds(key: str, low: float, high: float) -> tuple[str, tuple[float, float]]:
    axis = key.removesuffix("_deg")
    return (axis, (low, high)) if axis == key else (axis, (math.radians(low), math.radians(high)))


def placement_name(rig: str, what: str, seed: int | None = None) -> str:
    """Return the name of a placement by what found it, with its seed if there are several."""
    name = f"after-{rig}-{what}".replace("_", "-")
    return name if seed is None else f"{name}-k{seed}"


def placement_of(
    plan: Plan, name: str, what: str, poses: tuple[PoseValues, ...], seed: int | None = None
) -> Placement:
    """Return a placement of a rig by what found it."""
    rig = plan.searches.rigs[name]
    named = placement_name(name, what, seed)
    return Placement(
        named, rig.vehicle, poses, all_round=False, design=AFTER_SEARCH, model=rig.model
    )


def searched_placements(
    plan: Plan, folder: Path, report: Callable[[str], None] | None = None
) -> list[Placement]:
    """Return the placements of all rigs; searches that the folder does not have are run.

    `report` takes a line for each. Without it none is run, and placements that are not there are
    left out. A file of another plan is an `InputError`.
    """
    path = folder / PLACEMENTS
    rule = plan.searches
    kept: Json = {"plan": plan.digest, "searches": {}}
    if path.exists():
        kept = read_json(path)
        if kept.get("plan") != plan.digest or not isinstance(kept.get("searches"), dict):
            raise InputError(path, "plan", plan.digest, str(kept.get("plan")))
    placements = []
    for name in rule.rigs:
        placements.append(placement_of(plan, name, START, rule.rigs[name].poses))
        for objective, seed in itertools.product(rule.objectives, rule.seeds):
            named = seed if len(rule.seeds) > 1 else None
            key = f"{name}, {objective}" + (f", {named}" if named else "")
            if key not in kept["searches"] and report is not None:
                report(f"searching {key}")
                kept["searches"][key] = _search(plan, name, objective, seed)
                path.parent.mkdir(parents=True, exist_ok=True)
                write_bytes(path, dump_json(kept).encode())
            if key in kept["searches"]:
                poses = tuple(map(tuple, kept["searches"][key]["poses"]))
                placements.append(placement_of(plan, name, objective, poses, seed=named))
    return placements


@dataclass(frozen=True)
class _SearchIdentity:
    """What `made_by` notes of a search besides the versions."""

    objective: str
    seed: int


def _search(plan: Plan, name: str, objective: str, seed: int) -> Json:
    """Run a search; return what was found, as JSON data."""
    job = pt.OptimizeJob(study_of(plan, name, objective, seed))
    for _ in job:
        pass
    outcome = job.outcome
    assert outcome is not None
    poses = tuple(_rounded(sensor.pose) for sensor in outcome.study.rig)
    in_traffic = outcome.in_traffic
    key = "x y z roll pitch yaw"
    return {
        "method": outcome.start.search.method,
        "seed": seed,
        "evaluations": outcome.evaluations,
        "entropy": [outcome.before.entropy, outcome.after.entropy],
        "expected_ap": in_traffic and [score.ap for score in in_traffic],
        key: placement_of(plan, name, objective, poses).listed()[key],
        "poses": [list(pose) for pose in poses],
        "seconds": round(outcome.seconds, 1),
        "made": made_by(_SearchIdentity(objective, seed)),
    }


def _rounded(pose: pe.Pose) -> PoseValues:
    position = (round(float(w), POSITION_DIGITS) for w in pose.position)
    return (*position, *(round(math.degrees(w), ANGLE_DIGITS) for w in pose.rpy))


# What the runs say.


def after_search_analysis(plan: Plan, results: Results, scores: Results) -> Json:
    """Return all that follows from the results of the runs, as JSON data."""
    names = plan.searches.rigs
    objectives = plan.searches.objectives
    whats = whats_of(plan)
    planned = len(names) * len(whats) * len(plan.training.seeds)
    rigs = dict[str, Json]()
    for rig in names:
        aps = {what: _aps(plan, rig, what, results) for what in whats}
        rigs[rig] = {
            "placements": {
                what: {"ap": ap, **_scores(scores.get(placement_name(rig, what)))}
                for what, ap in aps.items()
            },
            "after": {o: _comparison(aps[START], aps[o]) for o in objectives},
        }
        if len(results) == planned:  # how much more is found after the last objective's search
            ends = objectives[0], objectives[-1]
            rigs[rig]["by_ring"] = {
                ring: _difference(
                    *(_aps(plan, rig, o, results, ap_of=mean_ap_in(ring)) for o in ends)
                )
                for ring in rings_of(plan)
            }
    verdicts = {o: [rig["after"][o]["verdict"] for rig in rigs.values()] for o in objectives}
    answers = {objective: _over_rigs(found) for objective, found in verdicts.items()}
    return {"done": len(results), "planned": planned, "rigs": rigs, "answers": answers}


def _aps(plan: Plan, rig: str, what: str, results: Results, ap_of: ApOf = mean_ap) -> Aps:
    runs = [f"{placement_name(rig, what)}-s{seed}" for seed in plan.training.seeds]
    return [ap_of(results[run]) if run in results else None for run in runs]


def _scores(scores: Json | None) -> Json:
    if scores is None:
        return {"entropy": None, "expected_ap": None}
    found = scores["road"]["entropy"], scores[TRAFFIC]["ap"]
    return {"entropy": round(found[0], 4), "expected_ap": round(found[1], 4)}


def _comparison(before: Aps, after: Aps) -> Json:
    """Return the differences of AP by seed, their mean and interval, and the verdict."""
    found = _difference(before, after)
    if found["interval"] is None:
        return {**found, "verdict": OPEN}
    return {**found, "verdict": HOLDS if found["interval"][0] > 0.0 else REFUTED}


def _difference(before: Aps, after: Aps) -> Json:
    """Return the differences of AP by seed, their mean, and its interval if all seeds are there."""
    pairs = zip(before, after, strict=True)
    found = [b - a for a, b in pairs if a is not None and b is not None]
    mean = round(float(np.mean(found)), 4) if found else None
    data: Json = {"differences": [round(d, 4) for d in found], "mean": mean, "interval": None}
    if len(found) < len(before) or len(found) != INTERVAL_SEEDS:
        return data
    return {**data, "interval": [round(w, 4) for w in student_interval(found)]}


def _over_rigs(verdicts: Sequence[str]) -> str:
    """Return `HOLDS` where it holds for all rigs; open while it is open for one."""
    if OPEN in verdicts:
        return OPEN
    return HOLDS if set(verdicts) == {HOLDS} else REFUTED
