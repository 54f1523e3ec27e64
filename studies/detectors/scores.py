"""The scores of the placements, as shipped: computed once and kept in scores.json."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.scoring.targets import ObjectEvaluator, TargetRule
from pe_core.sensors.lidar import Lidar

from ..results_file import Json, read_json
from .placements import Placement, vehicle
from .plan import Plan

SCORES = "scores.json"
SPACE = pe.PerceptionSpace()
ALONE = "alone"
TRAFFIC = "traffic"
PRIMARY = "perception entropy, road prior"
EXPECTED_AP = "expected AP, in traffic"
COVERAGE = "coverage"
HEIGHT = "mean height"
BEAMS = "number of beams"


@dataclass(frozen=True, slots=True)
class ComparedScore:
    """A score that is compared with AP; `value` takes a placement and its computed scores.

    Higher is better. With `across_only` it is the same for all placements of one rig.
    """

    name: str
    value: Callable[[Placement, Json], float]
    across_only: bool = False


COMPARED = (
    ComparedScore(PRIMARY, lambda _, s: -float(s["road"]["entropy"])),
    ComparedScore("perception entropy, uniform prior", lambda _, s: -float(s["uniform"])),
    ComparedScore(COVERAGE, lambda _, s: float(s["road"]["coverage"])),
    ComparedScore("object entropy", lambda _, s: -float(s[ALONE]["entropy"])),
    ComparedScore("object entropy, in traffic", lambda _, s: -float(s[TRAFFIC]["entropy"])),
    ComparedScore("expected AP", lambda _, s: float(s[ALONE]["ap"])),
    ComparedScore(EXPECTED_AP, lambda _, s: float(s[TRAFFIC]["ap"])),
    ComparedScore(HEIGHT, lambda p, _: p.mean_height),
    ComparedScore(BEAMS, lambda _, s: float(s["beams"]), across_only=True),
)
"""The scores of the plan, the primary one first. Entropies are taken with a minus sign."""


def placement_scores(
    plan: Plan,
    needed: Iterable[tuple[Placement, pe.Rig]],
    folder: Path,
    report: Callable[[str], None],
    scored: Callable[[Plan, str, pe.Rig], Json] | None = None,
) -> dict[str, Json]:
    """Return the scores of placements by name; those that scores.json does not have are computed.

    `report` takes a line for each that is scored; `scored` computes them from plan, vehicle and
    rig, in place of the first plan's. A file of another plan is an `InputError`.
    """
    path = folder / SCORES
    scores: dict[str, Json] = {}
    if path.exists():
        data = read_json(path)
        if data.get("plan") != plan.digest or not isinstance(data.get("scores"), dict):
            raise InputError(path, "plan", plan.digest, str(data.get("plan")))
        scores = data["scores"]
    missing = [(p, rig) for p, rig in needed if p.name not in scores]
    for placement, rig in missing:
        scores[placement.name] = (scored or _scores)(plan, placement.vehicle, rig)
        data = {"plan": plan.digest, "scores": dict(sorted(scores.items()))}
        write_bytes(path, dump_json(data).encode())
        report(f"scored {placement.name}")
    return scores


def _scores(plan: Plan, vehicle_name: str, rig: pe.Rig) -> Json:
    road = _voxels(vehicle_name, "road").score(rig)
    return {
        "road": {"entropy": road.entropy, "coverage": road.coverage},
        "uniform": _voxels(vehicle_name, "uniform").entropy(rig),
        **{t: _of_objects(plan, vehicle_name, rig, t == TRAFFIC) for t in (ALONE, TRAFFIC)},
        "beams": sum(s.model.beam_count for s in rig if isinstance(s.model, Lidar)),
    }


def _of_objects(plan: Plan, vehicle_name: str, rig: pe.Rig, traffic: bool) -> Json:
    score = scored_objects(vehicle_name, traffic, plan.statistics.scenes).score(rig)
    of_objects = score.objects
    assert of_objects is not None
    by_class = {name: part.ap for name, part in of_objects.per_class.items()}
    return {"entropy": score.entropy, "ap": of_objects.ap, "by_class": by_class}


@lru_cache(maxsize=4)
def _voxels(vehicle_name: str, prior: str) -> pe.Evaluator:
    chosen = pe.Prior.road() if prior == "road" else pe.Prior.uniform()
    return pe.Evaluator(SPACE, chosen, vehicle(vehicle_name), workers=1)


@lru_cache(maxsize=4)
def scored_objects(vehicle_name: str, traffic: bool, scenes: int) -> ObjectEvaluator:
    """Return the evaluator of objects on a vehicle, as shipped; it is kept for all placements."""
    rule = TargetRule("objects", traffic, scenes)
    return ObjectEvaluator(SPACE, pe.Prior.road(), vehicle(vehicle_name), targets=rule)
