"""Scores that the engine's process makes for the add-on: of a rig, and of a sensor that is held.

A score as quick as a move of the mouse is made on a sample of voxels. On a sedan of 400,000
triangles, a move of a Pandar64 takes 17 ms of processor time on the roof, 60 ms low over the
bonnet, one of 128 channels there 110 ms.
"""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from ..engine import catalog, pe, requirements, scoring, text

SAMPLES = 32_768
"""Voxels that a live score evaluates: an error of 0.02 nats on the sedan, 10 ms a move of a LiDAR.
16,384 would save 2 ms at nearly twice the error; 65,536 cost 5 ms more for an error of 0.017."""
MAX_SCENES = 64  # Scenes of objects that a live score evaluates at most
HELD_SAMPLES = 16_384
"""Voxels for a sensor that is held under the mouse, and for known rigs."""
DEFAULT_SPACE = pe.PerceptionSpace()
VOXELS = pe.TargetRule()


def rig_key(rig: pe.Rig) -> Hashable:
    """Return plain values that identify a rig; the catalogue has one object a model."""
    return tuple((s.name, id(s.model), s.pose, s.group, s.curve) for s in rig)


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
    """A rig to be scored. `changes` and `vehicle_version` count changes of its scene until then."""

    problem: Problem
    rig: pe.Rig
    prior_key: Hashable = None
    changes: int = 0
    vehicle_version: int = 0


_evaluators: dict[str, text.RecentCache[pe.RigEvaluator]] = {}
"""One a scene, kept as long as vehicle and prior stay; used by one lane alone."""


def live_score(
    scene_name: str, request: ScoreRequest, baseline: pe.Rig | None
) -> tuple[pe.Score, pe.Score | None]:
    """Return the summary score of a rig, and that of the baseline where it is asked for; only
    sensors that have moved are measured again."""
    kept = _evaluators.setdefault(scene_name, text.RecentCache())
    evaluator = kept.made(request.problem.key, lambda: make_evaluator(request.problem))
    before = None if baseline is None else evaluator.summary(baseline)
    return evaluator.summary(request.rig), before


def make_evaluator(problem: Problem) -> pe.RigEvaluator:
    """Return what scores a problem quickly: on a sample of voxels, or few scenes of objects."""
    rule = problem.targets
    if not rule.are_objects:
        return pe.Evaluator(
            problem.space, problem.prior, problem.vehicle, samples=SAMPLES, model=problem.model
        )
    few = replace(rule, scenes=min(rule.scenes, MAX_SCENES))
    return pe.ObjectEvaluator(
        problem.space, problem.prior, problem.vehicle, targets=few, model=problem.model
    )


class Gain(NamedTuple):
    """Entropy [nats] and coverage without (None if it is the only one) and with a sensor, and the
    standard error of the change of entropy."""

    before: float | None
    after: float
    coverage: float
    stderr: float = 0.0

    def __str__(self) -> str:
        """Return the gain as one line of text."""
        seen = f"coverage {self.coverage:.1%}, {HELD_SAMPLES:,} voxels"
        if self.before is None:
            return f"{self.after:.3f} nats, {seen}"
        change = self.after - self.before
        if scoring.is_noise(change, self.stderr):
            return f"{self.after:.3f} nats, {scoring.NO_DIFFERENCE}, {seen}"
        return f"{self.before:.3f} to {self.after:.3f} nats ({change:+.3f}), {seen}"


_held: text.RecentCache[tuple[pe.RigEvaluator, pe.Score | None]] = text.RecentCache()


def gain(number: int, study: pe.Study, name: str, pose: pe.Pose) -> Gain:
    """Score one sensor of a study at a pose, together with the others. These are measured once for
    each `number`, which identifies the study."""
    others = [each for each in study.rig if each.name != name]

    def make() -> tuple[pe.RigEvaluator, pe.Score | None]:
        evaluator = study.evaluator(samples=HELD_SAMPLES)
        return evaluator, evaluator.summary(pe.Rig(others)) if others else None

    evaluator, before = _held.made(number, make)
    score = evaluator.summary(pe.Rig([*others, study.rig[name].moved(pose)]))
    if before is None:
        return Gain(None, score.entropy, score.coverage)
    error = scoring.paired_error(before.scatter, score.scatter, ("rig", "", "entropy"))
    return Gain(before.entropy, score.entropy, score.coverage, error or 0.0)


def known_entropies(study: pe.Study) -> dict[str, tuple[float, float]]:
    """Return the entropies [nats] of the known rigs on a study's vehicle, by key, with their
    standard errors."""
    evaluator = study.evaluator(samples=HELD_SAMPLES)
    found = {}
    for key, rig in catalog.known_rigs().items():
        on_vehicle = catalog.rig_on(rig, study.vehicle)
        score = evaluator.summary(study.with_unrelated_rig(on_vehicle).rig)
        found[key] = score.entropy, score.stderr
    return found


_checkers: text.RecentCache[requirements.RequirementChecker] = text.RecentCache(2)
"""The 3D view, Check Requirements and scores share them: who asks second measures nothing."""


def checker(
    wanted: Sequence[requirements.Requirement],
    vehicle: pe.Vehicle | None,
    model: pe.PerceptionModel | None,
    reference: pe.Reference | None,
    space: pe.PerceptionSpace | None,
) -> requirements.RequirementChecker:
    """Return what holds rigs to some requirements as drawn, round a vehicle."""
    return _checkers.made(
        (tuple(wanted), vehicle, model, reference, space),
        lambda: requirements.RequirementChecker(
            wanted, vehicle, model=model, reference=reference, space=space
        ),
    )


def checker_of_study(study: pe.Study) -> requirements.RequirementChecker:
    """Return what holds rigs to the requirements of a study."""
    return checker(
        study.requirements, study.vehicle, study.model, study.reference, space=study.space
    )


def clear() -> None:
    """Drop all that is kept: where the engine has no process, another file is opened."""
    _evaluators.clear()
    _held.clear()
    _checkers.clear()
