"""From a scene to a live score: read in Blender's turn, worked out beside it."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import NamedTuple

import bpy

from .. import body, bridge, roster, simple_bodies
from ..engine import pe

SAMPLES = 32_768
"""Voxels a live score looks at: an error of 0.02 nats on the sedan, and 10 ms a move of a LiDAR.
16,384 would save 2 ms at nearly twice the error, 65,536 cost 5 ms more for 0.017."""


MOST_TRIANGLES = 400_000
"""A body of more is made simpler, once, and how far that moved it is told: a live score is to
follow the hand. Score takes the body as it is."""

DEFAULT_SPACE, VOXELS = pe.PerceptionSpace(), pe.TargetRule()
MOST_SCENES = 64
"""Scenes of objects a live score looks at, for the same reason."""


class Problem(NamedTuple):
    """What an evaluator is made for; `key` tells it from others by plain values."""

    key: Hashable
    prior: pe.Prior
    vehicle: pe.Vehicle | None
    space: pe.PerceptionSpace = DEFAULT_SPACE
    model: pe.PerceptionModel | None = None
    targets: pe.TargetRule = VOXELS


@dataclass(frozen=True)
class ScoreWish:
    """A rig to be scored."""

    problem: Problem
    rig: pe.Rig
    draft: bool
    prior_key: Hashable = None


class KeptPriors:
    """Priors by scene, made again when their settings change: a file of boxes takes long."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Hashable, pe.Prior]] = {}

    def get(self, scene: bpy.types.Scene) -> tuple[Hashable, pe.Prior]:
        """Return a scene's prior, and what it depends on."""
        key = bridge.prior_key(scene)
        known = self._known.get(scene.name)
        if known is None or known[0] != key:
            known = self._known[scene.name] = key, bridge.prior_from_scene(scene)
        return known

    def clear(self) -> None:
        """Forget all."""
        self._known.clear()


priors = KeptPriors()


def read(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, draft: bool) -> ScoreWish:
    """Read what the score needs of a scene; the vehicle only if it has changed.

    Raises
    ------
    InputError
        One line that says what in the scene is wrong.
    """
    bridge.check_scene(scene)
    rig = bridge.rig_from_objects(roster.sensors(scene), depsgraph)
    settings, prior = priors.get(scene)
    vehicle, key = body.shared.read(scene, depsgraph)
    if vehicle is None:
        collection = scene.perception_entropy.vehicle
        vehicle = bridge.vehicle_from_collection(collection, depsgraph)  # says what is wrong
    own = scene.perception_entropy
    space, model = bridge.space_of(own), bridge.perception_of(own)
    targets = bridge.targets_of(own)
    problem = Problem((settings, key, space, model, targets), prior, vehicle, space, model, targets)
    return ScoreWish(problem, rig, draft, (settings, space, model, targets))


class MadeFor(NamedTuple):
    """An evaluator, what it was made for, and how far its body was moved to be simpler [m]."""

    key: Hashable
    evaluator: pe.RigJudge
    moved_m: float


class EvaluatorStore:
    """One evaluator a scene, kept as long as vehicle and prior stay. Used by one thread alone."""

    def __init__(self) -> None:
        self._kept: dict[str, MadeFor] = {}

    def glance(self, scene_name: str, wish: ScoreWish) -> tuple[pe.Glance, float]:
        """Score a wish: only sensors that have moved are measured again.

        Returns
        -------
        glance : Glance
        moved_m : float
            How far the body was moved by making it simpler, at most [m].
        """
        kept = self._of(scene_name, wish.problem)
        return kept.evaluator.glance(wish.rig, draft=wish.draft), kept.moved_m

    def clear(self) -> None:
        """Forget all."""
        self._kept.clear()

    def _of(self, scene_name: str, problem: Problem) -> MadeFor:
        known = self._kept.get(scene_name)
        if known is None or known.key != problem.key:
            self._kept.pop(scene_name, None)  # two of them need not fit in memory
            vehicle, moved_m = light(problem.vehicle)
            made = judge_of(problem, vehicle)
            known = self._kept[scene_name] = MadeFor(problem.key, made, moved_m)
        return known


def judge_of(problem: Problem, vehicle: pe.Vehicle | None) -> pe.RigJudge:
    """Return what scores a problem quickly: on a sample of voxels, or few scenes of objects."""
    asked = problem.space, problem.prior, vehicle
    rule = problem.targets
    if not rule.are_objects:
        return pe.Evaluator(*asked, samples=SAMPLES, model=problem.model)
    few = replace(rule, scenes=min(rule.scenes, MOST_SCENES))
    return pe.ObjectEvaluator(*asked, targets=few, model=problem.model)


def light(vehicle: pe.Vehicle | None) -> tuple[pe.Vehicle | None, float]:
    """Return a vehicle of few enough triangles, and how far that moved its surface, at most [m]."""
    return (
        (None, 0.0) if vehicle is None else simple_bodies.shared.simplified(vehicle, MOST_TRIANGLES)
    )
