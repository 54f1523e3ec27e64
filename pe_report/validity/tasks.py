"""What is computed of a placement: plain functions from names to JSON data, run in processes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.targets import DrawnObjects, ObjectEvaluator, TargetRule, drawn_objects

from .choices import ScoreChoice, body_of, box_triangles, curves_of, prior_of
from .published import paper_of

Json = dict[str, Any]

ALONE, TRAFFIC = "alone", "traffic"
PRIORS = {"road": pe.Prior.road, "uniform": pe.Prior.uniform}
SPACE = pe.PerceptionSpace()


def voxel_name(paper: str, placement: str, reading: str, traffic: str, way: ScoreChoice) -> str:
    """Name of a placement's voxel scores; the density tells only in traffic."""
    density = f"/{way.density:g}" if traffic == TRAFFIC else ""
    return f"voxels/{traffic}/{paper}/{placement}/{reading}/{way.body}{density}"


def object_name(paper: str, placement: str, reading: str, traffic: str, way: ScoreChoice) -> str:
    """Name of a placement's object scores."""
    return (
        f"objects/{traffic}/{paper}/{placement}/{reading}/{way.body}/{way.density:g}/{way.curves}"
    )


def voxels(paper: str, placement: str, reading: str, body: str, samples: int) -> Json:
    """Score a placement's voxels, by prior, with nothing but the vehicle's body in the way."""
    rig = paper_of(paper).rig(placement, reading)
    return {prior: _part_by_part(_evaluator(prior, body, samples).score(rig)) for prior in PRIORS}


def voxels_in_traffic(
    paper: str,
    placement: str,
    reading: str,
    body: str,
    density: float,
    samples: int,
    scenes: int,
) -> Json:
    """Score a placement's voxels among other road users: the mean over scenes, by prior."""
    rig = paper_of(paper).rig(placement, reading)
    among = [_among_others(prior, body, density, samples, scenes) for prior in PRIORS]
    scores = ([evaluator.score(rig) for evaluator in each] for each in among)
    return {
        prior: _mean(list(map(_part_by_part, own)))
        for prior, own in zip(PRIORS, scores, strict=True)
    }


def objects(
    paper: str,
    placement: str,
    reading: str,
    body: str,
    density: float,
    curves: str,
    traffic: bool,
    scenes: int,
) -> Json:
    """Score a placement's objects, alone or hiding each other."""
    rig = paper_of(paper).rig(placement, reading)
    score = _object_evaluator(body, density, curves, traffic, scenes).score(rig)
    told = score.objects
    assert told is not None
    return {
        "entropy": score.entropy,
        "stderr": score.stderr,
        "ap": told.ap,
        "per_class": {
            name: {"entropy": own.entropy, "stderr": own.stderr, "ap": own.ap}
            for name, own in told.per_class.items()
        },
    }


@lru_cache(maxsize=2)
def _evaluator(prior: str, body: str, samples: int) -> pe.Evaluator:
    """A process makes it once for all placements."""
    return pe.Evaluator(SPACE, PRIORS[prior](), body_of(body), samples=samples, workers=1)


@lru_cache(maxsize=2)
def _object_evaluator(
    body: str, density: float, curves: str, traffic: bool, scenes: int
) -> ObjectEvaluator:
    targets = TargetRule("objects", traffic, scenes)
    model = pe.PerceptionModel(objects=curves_of(curves))
    vehicle = body_of(body)
    return ObjectEvaluator(SPACE, prior_of(density), vehicle, targets=targets, model=model)


@lru_cache(maxsize=2)
def _among_others(
    prior: str, body: str, density: float, samples: int, scenes: int
) -> list[pe.Evaluator]:
    """Return an evaluator a scene: what stands there is part of what hides."""
    targets = TargetRule("objects", True, max(scenes, LEAST_SCENES))
    drawn = drawn_objects(prior_of(density), SPACE, body_of(body), targets)
    own = body_of(body)
    bodies = [] if own is None else [own.triangles]
    return [
        pe.Evaluator(
            SPACE,
            PRIORS[prior](),
            pe.Vehicle(np.concatenate([*bodies, *_boxes(drawn, scene)])),
            samples=samples,
            workers=1,
        )
        for scene in range(scenes)
    ]


LEAST_SCENES = 8
"""Fewer are not drawn."""


def _boxes(drawn: DrawnObjects, scene: int) -> list[np.ndarray]:
    """Return the triangles of a scene's objects."""
    of = drawn.objects
    there = np.flatnonzero(of.scenes == scene)
    return [box_triangles(of.centers[k], of.sizes[k], float(of.yaws[k])) for k in there]


def _part_by_part(score: pe.Score) -> Json:
    return {
        "entropy": score.entropy,
        "coverage": score.coverage,
        "per_class": {
            name: {"entropy": part.entropy, "coverage": part.coverage}
            for name, part in score.per_class.items()
        },
    }


def _mean(parts: Sequence[Any]) -> Any:
    """Return the mean of scores, figure by figure."""
    if isinstance(parts[0], dict):
        return {key: _mean([part[key] for part in parts]) for key in parts[0]}
    return float(np.mean(parts))
