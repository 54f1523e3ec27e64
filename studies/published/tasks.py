"""The tasks of the comparison: how much is computed, and functions that worker processes run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.scoring.targets import ObjectEvaluator, SampledObjects, TargetRule, sample_objects

from ..results_file import Json, Task, Values
from .scores import (
    ALONE,
    BASE,
    TRAFFIC,
    ScoreChoice,
    body_of,
    box_triangles,
    curves_of,
    object_name,
    paper_of,
    papers,
    prior_of,
    variants,
    voxel_name,
)

PRIORS = {"road": pe.Prior.road, "uniform": pe.Prior.uniform}
SPACE = pe.PerceptionSpace()
MIN_SAMPLED_SCENES = 8
"""Scenes of objects are sampled at least this many at a time."""


@dataclass(frozen=True)
class ValidityEffort:
    """How much is computed."""

    samples: int
    """Voxels that a voxel score evaluates; 0: all."""
    variant_samples: int
    """The same, where the choices are varied."""
    traffic_samples: int
    traffic_scenes: int
    """Voxels in a scene, and scenes, that a voxel score in traffic evaluates."""
    scenes: int
    """Scenes, of about 19 objects each, that an object score evaluates."""
    all_variants: bool


FULL = ValidityEffort(
    samples=0,
    variant_samples=262_144,
    traffic_samples=32_768,
    traffic_scenes=16,
    scenes=500,
    all_variants=True,
)
QUICK = ValidityEffort(
    samples=8_192,
    variant_samples=8_192,
    traffic_samples=4_096,
    traffic_scenes=1,
    scenes=8,
    all_variants=False,
)


def plan(effort: ValidityEffort, values: Values) -> list[Task]:
    """Return the tasks that have no value yet."""
    return [task for name, task in _tasks(effort).items() if name not in values]


def _tasks(effort: ValidityEffort) -> dict[str, Task]:
    """Return all tasks by name: a task that several variants need is there once."""
    tasks = (
        task
        for choice in variants(effort.all_variants)
        for paper in papers()
        for placement in paper.placements
        for reading in paper.readings(placement)
        for task in _tasks_of(effort, choice, paper.id, placement, reading=reading)
    )
    return {task.name: task for task in tasks}


def _tasks_of(
    effort: ValidityEffort, choice: ScoreChoice, paper: str, placement: str, reading: str
) -> Iterator[Task]:
    """Yield the tasks of a placement: voxels and objects, alone and in traffic."""
    arguments: dict[str, Any] = {"paper": paper, "placement": placement, "reading": reading}
    arguments["body"] = choice.body
    samples = effort.samples if choice == BASE else effort.variant_samples
    yield Task(
        voxel_name(paper, placement, reading, ALONE, choice=choice),
        voxels,
        {**arguments, "samples": samples},
    )
    arguments["density"] = choice.density
    counts = {"samples": effort.traffic_samples, "scenes": effort.traffic_scenes}
    yield Task(
        voxel_name(paper, placement, reading, TRAFFIC, choice=choice),
        voxels_in_traffic,
        {**arguments, **counts},
    )
    arguments |= {"curves": choice.curves, "scenes": effort.scenes}
    for traffic in (ALONE, TRAFFIC):
        in_traffic = {"traffic": traffic == TRAFFIC}
        yield Task(
            object_name(paper, placement, reading, traffic, choice=choice),
            objects,
            {**arguments, **in_traffic},
        )


def voxels(paper: str, placement: str, reading: str, body: str, samples: int) -> Json:
    """Score a placement's voxels, by prior; only the vehicle's body occludes."""
    rig = paper_of(paper).rig(placement, reading)
    return {prior: _score_data(_evaluator(prior, body, samples).score(rig)) for prior in PRIORS}


def voxels_in_traffic(
    paper: str, placement: str, reading: str, body: str, density: float, samples: int, scenes: int
) -> Json:
    """Score a placement's voxels among other road users, by prior: the mean over scenes."""
    rig = paper_of(paper).rig(placement, reading)
    found = {}
    for prior in PRIORS:
        evaluators = _evaluators_in_traffic(prior, body, density, samples, scenes=scenes)
        found[prior] = _mean([_score_data(evaluator.score(rig)) for evaluator in evaluators])
    return found


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
    """Score a placement's objects, each alone or, in traffic, all occluding each other."""
    rig = paper_of(paper).rig(placement, reading)
    score = _object_evaluator(body, density, curves, traffic, scenes=scenes).score(rig)
    of_objects = score.objects
    assert of_objects is not None
    return {
        "entropy": score.entropy,
        "stderr": score.stderr,
        "ap": of_objects.ap,
        "per_class": {
            name: {key: getattr(part, key) for key in ("entropy", "stderr", "ap")}
            for name, part in of_objects.per_class.items()
        },
    }


@lru_cache(maxsize=2)
def _evaluator(prior: str, body: str, samples: int) -> pe.Evaluator:
    """Return an evaluator, which a worker process keeps for all placements."""
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
def _evaluators_in_traffic(
    prior: str, body: str, density: float, samples: int, scenes: int
) -> list[pe.Evaluator]:
    """Return an evaluator for each scene, in which the scene's objects are part of the body."""
    targets = TargetRule("objects", True, max(scenes, MIN_SAMPLED_SCENES))
    sampled = sample_objects(prior_of(density), SPACE, body_of(body), targets)
    vehicle = body_of(body)
    bodies = [] if vehicle is None else [vehicle.triangles]
    return [
        pe.Evaluator(
            SPACE,
            PRIORS[prior](),
            pe.Vehicle(np.concatenate([*bodies, *_object_triangles(sampled, scene)])),
            samples=samples,
            workers=1,
        )
        for scene in range(scenes)
    ]


def _object_triangles(sampled: SampledObjects, scene: int) -> list[np.ndarray]:
    """Return the triangles of a scene's objects, each (12, 3, 3)."""
    boxes = sampled.objects
    in_scene = np.flatnonzero(boxes.scenes == scene)
    return [box_triangles(boxes.centers[k], boxes.sizes[k], float(boxes.yaws[k])) for k in in_scene]


def _score_data(score: pe.Score) -> Json:
    return {
        "entropy": score.entropy,
        "coverage": score.coverage,
        "per_class": {
            name: {"entropy": part.entropy, "coverage": part.coverage}
            for name, part in score.per_class.items()
        },
    }


def _mean(scores: Sequence[Any]) -> Any:
    """Return the mean of scores, number by number."""
    if isinstance(scores[0], dict):
        return {key: _mean([score[key] for score in scores]) for key in scores[0]}
    return float(np.mean(scores))
