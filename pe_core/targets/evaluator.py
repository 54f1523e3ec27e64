"""The Evaluator of objects: what rigs are worth on scenes that stay the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from math import inf
from threading import RLock

import numpy as np
from numpy.typing import NDArray

from ..kinds import ObjectsByName, PerceptionModel, kind_of
from ..metric.entropy import H_BLIND
from ..prior.prior import Prior
from ..scene.sensors import Rig
from ..scene.space import PerceptionSpace
from ..scene.vehicle import Vehicle
from ..scoring.cases import Cases, together
from ..scoring.object_score import ObjectScore
from ..scoring.sampled import Judgement
from ..scoring.score import Glance, Score, ScoreStopped, SensorScore, Watch, rounded
from .drawing import CENTERED, DrawnObjects, drawn_objects
from .fusing import FusedObjects
from .lone import LoneObjects
from .rule import OBJECTS, TargetRule
from .sums import ObjectSums

Floats = NDArray[np.float64]
MByName = Mapping[str, Floats]
"""m of sensors on the objects, (N,) each, by name."""


class ObjectEvaluator:
    """Scores rigs on objects in one space, under one prior, on one vehicle.

    It is asked as `Evaluator` is. One thread at a time: others wait.

    Parameters
    ----------
    space : PerceptionSpace
    prior : Prior
    vehicle : Vehicle, optional
        None: nothing but other objects hides anything, and the room of a car is left free.
    targets : TargetRule, optional
        Without them objects that do not hide each other.
    model : PerceptionModel, optional
        AP curves by class and kind, and the fusion rule.
    shift : float
        A number in [0, 1) that scrambles what is drawn: others give other scenes as good.

    Raises
    ------
    InputError
        When there are no objects, they find no room or have no weight, or memory does not suffice.
    """

    def __init__(
        self,
        space: PerceptionSpace,
        prior: Prior,
        vehicle: Vehicle | None = None,
        *,
        targets: TargetRule | None = None,
        model: PerceptionModel | None = None,
        shift: float = CENTERED,
    ) -> None:
        self.space, self.prior, self.vehicle = space, prior, vehicle
        self.targets = targets or TargetRule(OBJECTS)
        self._model, self._shift = model or PerceptionModel(), shift
        self.drawn: DrawnObjects = drawn_objects(prior, space, vehicle, self.targets, shift)
        self.samples = len(self.drawn.objects)
        self._fused = FusedObjects(self.drawn.objects, self.drawn.weights, self._model)
        self._sums = ObjectSums(self.drawn)
        traffic = self.targets.traffic
        self._sensors = ObjectsByName(self.drawn.objects, vehicle, traffic)
        self._is_free = RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Another process makes its own from what this one was made from."""
        what = self.space, self.prior, self.vehicle
        return _again, (*what, self.targets, self._model, self._shift)

    def entropy(self, rig: Rig, *, draft: bool = False) -> float:
        """Object entropy of a rig [nats]; there are no drafts."""
        with self._is_free:
            self._fused.check(rig)
            return self._entropy(rig, self._sensors.measure(rig))

    def judge(self, rig: Rig, below: float = inf) -> Judgement:
        """Tell a rig's entropy, whatever it is to be below."""
        return Judgement(self.entropy(rig), False)

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Object entropy of each of several rigs [nats]; what they share is measured once."""
        cases = Cases(rigs)
        with self._is_free:
            self._fused.check(cases.all)
            m = self._sensors.measure(cases.all)
            return [self._entropy(part, m) for part in cases.parts]

    def judge_together(self, rigs: Sequence[Rig], below: float, worst: bool = False) -> Judgement:
        """As `judge`, of the mean of several rigs' entropies, or of the highest."""
        return Judgement(together(self.entropies(rigs), worst), False)

    def glance(self, rig: Rig, *, draft: bool = False) -> Glance:
        """Score a rig as a whole, not sensor by sensor."""
        with self._is_free:
            self._fused.check(rig)
            return self._glance(rig, *self._fused.entropies(rig, self._sensors.measure(rig)))

    def score(self, rig: Rig, *, draft: bool = False, watch: Watch | None = None) -> Score:
        """Score a rig in full: as `Evaluator.score`, and what `ObjectScore` tells besides."""
        with self._is_free:
            _go_on(watch, 0.0)
            self._fused.check(rig)
            m = self._sensors.measure(rig)
            entropies, seen = self._fused.entropies(rig, m)
            glance = self._glance(rig, entropies, seen)
            _go_on(watch, 0.5)
            per_sensor = {s.name: self._sensor(s.name, rig, m, glance.entropy) for s in rig}
            _go_on(watch, 0.7)
            return Score(
                glance.entropy,
                glance.coverage,
                glance.stderr,
                glance.per_class,
                glance.per_zone,
                per_sensor,
                0,
                objects=self._told(rig, m, entropies),
                scatter=self._sums.scatter(entropies, seen),
            )

    def _glance(self, rig: Rig, entropies: Floats, seen: NDArray[np.bool_]) -> Glance:
        whole = self._sums.part(entropies, seen)
        return Glance(
            whole.entropy,
            whole.coverage,
            self._sums.standard_error(entropies, len(rig.groups)),
            self._sums.classes(entropies, seen),
            self._sums.zones(entropies, seen),
            0,
        )

    def _entropy(self, rig: Rig, m: MByName) -> float:
        return self._sums.part(*self._fused.entropies(rig, m)).entropy

    def _sensor(self, name: str, rig: Rig, m: MByName, entropy: float) -> SensorScore:
        alone = self._sums.part(*self._fused.entropies(rig, m, [name]))
        others = [s.name for s in rig if s.name != name]
        failed = self._sums.part(*self._fused.entropies(rig, m, others)).entropy
        lost = rounded((failed if others else H_BLIND) - entropy)
        return SensorScore(alone.entropy, alone.coverage, lost, 0, 0, {})

    @cached_property
    def _lone(self) -> LoneObjects:
        return LoneObjects(self.drawn, self.vehicle, self._model)

    def _told(self, rig: Rig, m: MByName, entropies: Floats) -> ObjectScore:
        points = [m[s.name] for s in rig if kind_of(s).counts_points]
        return self._sums.told(
            entropies, points, self._lone, self._lone.ap(rig), self.targets.traffic
        )


def _go_on(watch: Watch | None, share: float) -> None:
    """Tell who watches how far a score is; raise `ScoreStopped` when told to stop."""
    if watch is not None and not watch(share):
        raise ScoreStopped


def _again(
    space: PerceptionSpace,
    prior: Prior,
    vehicle: Vehicle | None,
    targets: TargetRule,
    model: PerceptionModel,
    shift: float,
) -> ObjectEvaluator:
    """Make an evaluator that was pickled: for worker processes."""
    return ObjectEvaluator(space, prior, vehicle, targets=targets, model=model, shift=shift)
