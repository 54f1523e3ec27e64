"""From a scene to a live score: the scene is read on the main thread and scored on another.

A score as quick as a move of the mouse is made on a sample of voxels, and is a preview as long as a
sensor moves. On a sedan of 400,000 triangles, a move of a LiDAR takes this processor time, in ms:

============================  ========  =====  ================
move                          preview   exact  exact, 1.6 million
============================  ========  =====  ================
Pandar64 on the roof               7     17        19
Pandar64 at the bumper            11     52        71
Pandar64 low over the bonnet      13     60        89
128 channels, the same            27    110
============================  ========  =====  ================

So previews save up to 83 ms a move. To simplify the vehicle would save little: with 6 million
triangles a preview takes 9 ms as well, and the first score 5.3 s instead of 6.3 s. Only the first
preview on a vehicle would take 0.1 s instead of 2.9 s (0.7 s with 1.6 million).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import NamedTuple

import bpy

from .. import bridge, sensor_cache, vehicle_cache
from ..engine import pe
from .state import live_state

SAMPLES = 32_768
"""Voxels that a live score evaluates: an error of 0.02 nats on the sedan, 10 ms a move of a LiDAR.
16,384 would save 2 ms at nearly twice the error; 65,536 cost 5 ms more for an error of 0.017."""
DEFAULT_SPACE, VOXELS = pe.PerceptionSpace(), pe.TargetRule()
MAX_SCENES = 64
"""Scenes of objects that a live score evaluates at most."""


class Problem(NamedTuple):
    """What an evaluator is made for; `key` identifies it by plain values."""

    key: Hashable
    prior: pe.Prior
    vehicle: pe.Vehicle | None
    space: pe.PerceptionSpace = DEFAULT_SPACE
    model: pe.PerceptionModel | None = None
    targets: pe.TargetRule = VOXELS


@dataclass(frozen=True)
class ScoreRequest:
    """A rig to be scored; approximately, as a preview, where `preview`; `moving`: not idle."""

    problem: Problem
    rig: pe.Rig
    preview: bool
    prior_key: Hashable = None
    moving: bool = False


def read_prior(scene: bpy.types.Scene) -> tuple[Hashable, pe.Prior]:
    """Return what identifies a scene's prior, and the prior; made anew when settings change."""
    state, key = live_state(scene.name), bridge.prior_key(scene)
    if state.prior is None or state.prior[0] != key:
        state.prior = key, bridge.prior_from_scene(scene)
    return state.prior


def read_request(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, moving: bool
) -> ScoreRequest:
    """Read what the score needs of a scene; the vehicle only if it has changed.

    Raises
    ------
    InputError
        When something in the scene is wrong: one line.
    """
    bridge.check_scene(scene)
    rig = bridge.rig_from_objects(sensor_cache.sensors(scene), depsgraph)
    prior_key, prior = read_prior(scene)
    vehicle, vehicle_key = vehicle_cache.shared.read(scene, depsgraph)
    if vehicle is None:
        collection = scene.perception_entropy.vehicle
        vehicle = bridge.vehicle_from_collection(collection, depsgraph)  # raises the reason
    settings = scene.perception_entropy
    space, model = bridge.space_of(settings), bridge.perception_of(settings)
    targets = bridge.targets_of(settings)
    problem_key = prior_key, vehicle_key, space, model, targets
    problem = Problem(problem_key, prior, vehicle, space, model, targets)
    return ScoreRequest(problem, rig, moving, (prior_key, space, model, targets), moving)


class CachedEvaluator(NamedTuple):
    """An evaluator, and its problem's key."""

    key: Hashable
    evaluator: pe.RigEvaluator


class EvaluatorCache:
    """One evaluator a scene, kept as long as vehicle and prior stay. Used by one thread alone."""

    def __init__(self) -> None:
        self._kept: dict[str, CachedEvaluator] = {}

    def summary(self, scene_name: str, request: ScoreRequest) -> pe.SummaryScore:
        """Return the summary score of a rig; only sensors that have moved are measured again."""
        evaluator = self._evaluator_of(scene_name, request.problem).evaluator
        return evaluator.summary(request.rig, preview=request.preview)

    def clear(self) -> None:
        """Drop all evaluators."""
        self._kept.clear()

    def _evaluator_of(self, scene_name: str, problem: Problem) -> CachedEvaluator:
        cached = self._kept.get(scene_name)
        if cached is None or cached.key != problem.key:
            self._kept.pop(scene_name, None)  # two of them need not fit in memory
            evaluator = make_evaluator(problem)
            cached = self._kept[scene_name] = CachedEvaluator(problem.key, evaluator)
        return cached


def make_evaluator(problem: Problem) -> pe.RigEvaluator:
    """Return what scores a problem quickly: on a sample of voxels, or few scenes of objects."""
    place = problem.space, problem.prior, problem.vehicle
    rule = problem.targets
    if not rule.are_objects:
        return pe.Evaluator(*place, samples=SAMPLES, model=problem.model)
    few = replace(rule, scenes=min(rule.scenes, MAX_SCENES))
    return pe.ObjectEvaluator(*place, targets=few, model=problem.model)
