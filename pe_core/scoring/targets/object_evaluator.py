"""ObjectEvaluator: scores rigs on a fixed set of objects."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...base.lazy_threads import threads
from ...base.values import rounded
from ...geometry.grids import PerceptionSpace
from ...metric.entropy import H_BLIND
from ...prior.prior import Prior
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, PerceptionModel, kind_of
from ..checks import require_scene
from ..rig_batch import RigBatch
from ..score import ObjectScore, Score, ScoreProgress, SensorScore, TrafficAp, Watch
from .object_metric import FusedObjects, LoneObjects, ObjectSums
from .object_sampling import CENTERED, OBJECTS, SampledObjects, TargetRule, sample_objects

MByName = Mapping[str, Floats]
"""m of sensors on the objects, (N,) each, by name."""


class ObjectEvaluator:
    """Scores rigs on objects in one space, under one prior, on one vehicle.

    It has the methods of `Evaluator`. It is thread-safe: one thread at a time scores.

    `InputError` when objects are missing, have no room or no weight, or memory does not suffice.

    Parameters
    ----------
    vehicle : Vehicle, optional
        None: only other objects occlude, and the ground of a car is kept free.
    targets : TargetRule, optional
        By default, objects that do not occlude each other.
    model : PerceptionModel, optional
        AP curves by class and kind, and the fusion rule.
    shift : float
        A number in [0, 1) that scrambles the sample: others give other scenes of the same quality.
    kernel_caches : dict, optional
        Caches of kernels by kind, shared with others that measure the same rigs on this vehicle.
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
        kernel_caches: dict[str, Any] | None = None,
    ) -> None:
        require_scene("evaluator", space, prior, vehicle)
        self.space = space
        self.prior = prior
        self.vehicle = vehicle
        self.targets = targets or TargetRule(OBJECTS)
        self._model = model or PerceptionModel()
        self._shift = shift
        self.drawn: SampledObjects = sample_objects(
            prior, space, vehicle, self.targets, shift=shift
        )
        self.samples = len(self.drawn.objects)
        self._fused = FusedObjects(self.drawn.objects, self.drawn.weights, self._model)
        self._sums = ObjectSums(self.drawn)
        traffic = self.targets.traffic
        self._sensors = ObjectMeasurementCache(self.drawn.objects, vehicle, traffic, kernel_caches)
        self._lock = threads().RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: another process makes an evaluator of its own from them."""
        targets = self.targets
        model = self._model
        shift = self._shift
        return partial(
            type(self),
            self.space,
            self.prior,
            self.vehicle,
            targets=targets,
            model=model,
            shift=shift,
        ), ()

    def entropy(self, rig: Rig) -> float:
        """Return the object entropy of a rig [nats]."""
        with self._lock:
            self._fused.check(rig)
            return self._value(rig, self._sensors.measure(rig))

    def entropies(self, rigs: Sequence[Rig]) -> list[float]:
        """Return the object entropy of each of several rigs [nats], as `Evaluator.entropies`."""
        batch = RigBatch(rigs)
        with self._lock:
            self._fused.check(batch.all)
            m = self._sensors.measure(batch.all)
            return [self._value(part, m) for part in batch.parts]

    def residuals(self, rigs: Sequence[Rig]) -> Floats:
        """Return by rig what each batch of scenes adds to the object entropy above its mean."""
        batch = RigBatch(rigs)
        with self._lock:
            self._fused.check(batch.all)
            m = self._sensors.measure(batch.all)
            by_rig = [self._fused.entropies(part, m)[0] for part in batch.parts]
            return np.array([self._residuals(entropies) for entropies in by_rig])

    def summary(self, rig: Rig) -> Score:
        """Return the score of a rig without the part by sensor."""
        with self._lock:
            self._fused.check(rig)
            return self._summary(rig, *self._fused.entropies(rig, self._sensors.measure(rig)))

    def expected_ap(self, rig: Rig) -> TrafficAp:
        """Return the expected AP of a rig, over all objects and by ring."""
        with self._lock:
            self._fused.check(rig)
            entropies, _ = self._fused.entropies(rig, self._sensors.measure(rig))
            return self._sums.by_ring(entropies)

    def score(self, rig: Rig, *, watch: Watch | None = None) -> Score:
        """Score a rig in full: as `Evaluator.score`, with an `ObjectScore`."""
        with self._lock:
            progress = ScoreProgress(watch, 1.0)
            self._fused.check(rig)
            m = self._sensors.measure(rig)
            entropies, visible = self._fused.entropies(rig, m)
            summary = self._summary(rig, entropies, visible)
            progress.add(0.5)
            per_sensor = {s.name: self._sensor(s.name, rig, m, summary.entropy) for s in rig}
            progress.add(0.2)
            objects = self._object_score(rig, m, entropies)
            return replace(summary, per_sensor=per_sensor, objects=objects)

    def _summary(self, rig: Rig, entropies: Floats, visible: NDArray[np.bool_]) -> Score:
        whole = self._sums.part(entropies, visible)
        return Score(
            whole.entropy,
            whole.coverage,
            self._sums.standard_error(entropies, len(rig.groups)),
            self._sums.classes(entropies, visible),
            per_zone=self._sums.zones(entropies, visible),
            per_sensor={},
            voxels=0,
            ap=self._sums.expected_ap(entropies),
            scatter=self._sums.scatter(entropies, visible),
        )

    def _value(self, rig: Rig, m: MByName) -> float:
        """Return what `entropy` and `evaluate` return; a subclass may have another value."""
        return self._sums.part(*self._fused.entropies(rig, m)).entropy

    def _residuals(self, entropies: Floats) -> Sequence[float]:
        """Return the residuals of `_value`."""
        return self._sums.residuals(entropies)

    def _sensor(self, name: str, rig: Rig, m: MByName, entropy: float) -> SensorScore:
        alone = self._sums.part(*self._fused.entropies(rig, m, [name]))
        remaining = [s.name for s in rig if s.name != name]
        failed = self._sums.part(*self._fused.entropies(rig, m, remaining)).entropy
        lost = rounded((failed if remaining else H_BLIND) - entropy)
        return SensorScore(alone.entropy, alone.coverage, lost, beams=0, occluded=0, occluded_by={})

    @cached_property
    def _lone(self) -> LoneObjects:
        return LoneObjects(self.drawn, self.vehicle, self._model)

    def _object_score(self, rig: Rig, m: MByName, entropies: Floats) -> ObjectScore:
        points = [m[s.name] for s in rig if kind_of(s).counts_points]
        reach = partial(self._lone.reach, ap=self._lone.ap(rig))
        return self._sums.object_score(entropies, points, reach, self.targets.traffic)
