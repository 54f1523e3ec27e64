"""From a scene to a live score: the scene is read on the main thread and scored on another.

A score as quick as a move of the mouse is made on a sample of voxels, and of a vehicle of limited
detail.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import NamedTuple

import bpy

from .. import bridge, sensor_cache, simplified_vehicles, vehicle_cache
from ..engine import pe
from .state import live_state

SAMPLES = 32_768
"""Voxels that a live score evaluates: an error of 0.02 nats on the sedan, 10 ms a move of a LiDAR.
16,384 would save 2 ms at nearly twice the error; 65,536 cost 5 ms more for an error of 0.017."""


MAX_TRIANGLES = 400_000
"""A vehicle of more is simplified once, and the read-out says how far its surface moved. *Score*
evaluates the vehicle as it is."""

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
    """A rig to be scored; approximately, as a preview, where `draft`."""

    problem: Problem
    rig: pe.Rig
    draft: bool
    prior_key: Hashable = None


def read_prior(scene: bpy.types.Scene) -> tuple[Hashable, pe.Prior]:
    """Return what identifies a scene's prior, and the prior; made anew when settings change."""
    state, key = live_state(scene.name), bridge.prior_key(scene)
    if state.prior is None or state.prior[0] != key:
        state.prior = key, bridge.prior_from_scene(scene)
    return state.prior


def read_request(
    scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, draft: bool
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
    return ScoreRequest(problem, rig, draft, (prior_key, space, model, targets))


class CachedEvaluator(NamedTuple):
    """An evaluator, its problem's key, and how far simplifying moved the vehicle's surface [m]."""

    key: Hashable
    evaluator: pe.RigJudge
    moved_m: float


class EvaluatorCache:
    """One evaluator a scene, kept as long as vehicle and prior stay. Used by one thread alone."""

    def __init__(self) -> None:
        self._kept: dict[str, CachedEvaluator] = {}

    def summary(self, scene_name: str, request: ScoreRequest) -> tuple[pe.Glance, float]:
        """Score a rig; only sensors that have moved are measured again.

        Returns
        -------
        summary : Glance
            The score without its part by sensor.
        moved_m : float
            How far simplifying moved the vehicle's surface, at most [m].
        """
        cached = self._evaluator_of(scene_name, request.problem)
        return cached.evaluator.glance(request.rig, draft=request.draft), cached.moved_m

    def clear(self) -> None:
        """Drop all evaluators."""
        self._kept.clear()

    def _evaluator_of(self, scene_name: str, problem: Problem) -> CachedEvaluator:
        cached = self._kept.get(scene_name)
        if cached is None or cached.key != problem.key:
            self._kept.pop(scene_name, None)  # two of them need not fit in memory
            vehicle, moved_m = simplified(problem.vehicle)
            evaluator = make_evaluator(problem, vehicle)
            cached = self._kept[scene_name] = CachedEvaluator(problem.key, evaluator, moved_m)
        return cached


def make_evaluator(problem: Problem, vehicle: pe.Vehicle | None) -> pe.RigJudge:
    """Return what scores a problem quickly: on a sample of voxels, or few scenes of objects."""
    place = problem.space, problem.prior, vehicle
    rule = problem.targets
    if not rule.are_objects:
        return pe.Evaluator(*place, samples=SAMPLES, model=problem.model)
    few = replace(rule, scenes=min(rule.scenes, MAX_SCENES))
    return pe.ObjectEvaluator(*place, targets=few, model=problem.model)


def simplified(vehicle: pe.Vehicle | None) -> tuple[pe.Vehicle | None, float]:
    """Return a vehicle of few enough triangles, and how far its surface moved, at most [m]."""
    if vehicle is None:
        return None, 0.0
    return simplified_vehicles.shared.simplified(vehicle, MAX_TRIANGLES)
