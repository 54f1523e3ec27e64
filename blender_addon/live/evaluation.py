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

from dataclasses import replace

import bpy

from .. import bridge, sensor_cache, vehicle_cache
from ..caches import RecentCache
from ..engine import pe
from .state import Problem, ScoreRequest, live_state

SAMPLES = 32_768
"""Voxels that a live score evaluates: an error of 0.02 nats on the sedan, 10 ms a move of a LiDAR.
16,384 would save 2 ms at nearly twice the error; 65,536 cost 5 ms more for an error of 0.017."""
MAX_SCENES = 64
"""Scenes of objects that a live score evaluates at most."""


def read_request(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, moving: bool
) -> ScoreRequest:
    """Read what the score needs of a scene; the vehicle only if it has changed.

    `InputError` when something in the scene is wrong: one line.
    """
    bridge.check_scene(scene)
    rig = bridge.rig_from_objects(sensor_cache.sensors(scene), depsgraph)
    state, prior_key = live_state(scene.name), bridge.prior_key(scene)
    if state.prior is None or state.prior[0] != prior_key:
        state.prior = prior_key, bridge.prior_from_scene(scene)
    prior = state.prior[1]
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


class EvaluatorCache:
    """One evaluator a scene, kept as long as vehicle and prior stay. Used by one thread alone."""

    def __init__(self) -> None:
        self._kept: dict[str, RecentCache[pe.RigEvaluator]] = {}

    def summary(self, scene_name: str, request: ScoreRequest) -> pe.SummaryScore:
        """Return the summary score of a rig; only sensors that have moved are measured again."""
        kept, problem = self._kept.setdefault(scene_name, RecentCache()), request.problem
        evaluator = kept.made(problem.key, lambda: make_evaluator(problem))
        return evaluator.summary(request.rig, preview=request.preview)

    def clear(self) -> None:
        """Drop all evaluators."""
        self._kept.clear()


def make_evaluator(problem: Problem) -> pe.RigEvaluator:
    """Return what scores a problem quickly: on a sample of voxels, or few scenes of objects."""
    place = problem.space, problem.prior, problem.vehicle
    rule = problem.targets
    if not rule.are_objects:
        return pe.Evaluator(*place, samples=SAMPLES, model=problem.model)
    few = replace(rule, scenes=min(rule.scenes, MAX_SCENES))
    return pe.ObjectEvaluator(*place, targets=few, model=problem.model)
