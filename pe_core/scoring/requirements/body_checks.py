"""BodyChecks: test bodies at samples of zones, and which of them a rig sees well enough.

All bodies of some requirements are one set of objects, so a sensor that has moved is measured once,
with the kernels of objects. What follows, for every requirement and every lost sensor, is counting.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...metric.entropy import ap_of_entropy
from ...scene.objects import Objects
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, PerceptionModel
from ..targets.object_metric import FusedObjects
from .bodies import Body
from .criteria import Criterion, Requirement, levels_of
from .definition import body_has_enough, placed, visible_share
from .verdict import Judged, Samples

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
CountsBySensor = Mapping[str, Floats]


class SceneCaches:
    """Caches of kernels by scene, shared by all sets of samples: a beam is cast once.

    Scene 0 is the rig as it stands, the others are the rig with mounting errors.
    """

    def __init__(self, vehicle: Vehicle | None) -> None:
        self.vehicle = vehicle
        self._known: dict[int, dict[str, Any]] = {}

    def by_kernel(self, number: int) -> dict[str, Any]:
        """Return the caches of a scene."""
        return self._known.setdefault(number, {})


@dataclass(frozen=True, eq=False)
class _BodySet:
    """One body of a requirement: the number of its objects, and where these are among all."""

    body: Body
    number: int
    box: slice
    cells: slice | None


class BodyChecks:
    """The bodies of some requirements at samples of their zones, and the sensors measured on them.

    Parameters
    ----------
    wanted : sequence of (Requirement, Samples)
        Requirements on bodies.
    model : PerceptionModel
    caches : SceneCaches
    """

    def __init__(
        self,
        wanted: Sequence[tuple[Requirement, Samples]],
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self._wanted, self._caches = wanted, caches
        self._objects: list[Objects] = []
        self._count = 0
        self._bodies = [self._placed(*pair) for pair in wanted]
        self._joined = _joined(self._objects)
        self._measurers: dict[int, ObjectMeasurementCache] = {}
        weights = None if self._joined is None else self._asked(len(self._joined))
        self._fused = None
        if self._joined is not None and weights is not None and weights.any():
            self._fused = FusedObjects(self._joined, weights, model)

    def judged(self, rig: Rig, cases: Sequence[Rig] = ()) -> list[Judged]:
        """Return for each requirement which samples pass, with the rig as it stands and in all.

        `cases` are the rig with mounting errors, for requirements that ask for them.
        """
        m = self._measured(0, rig)
        found = [self._judged(k, rig, m) for k in range(len(self._wanted))]
        asking = [k for k, (own, _) in enumerate(self._wanted) if own.under.mounting]
        for number, case in enumerate(cases if asking else (), start=1):
            measured = self._measured(number, case)
            for k in asking:
                found[k].passed[:] &= self._judged(k, case, measured).passed
        return found

    def _judged(self, number: int, rig: Rig, m: CountsBySensor) -> Judged:
        requirement, _ = self._wanted[number]
        names = [s.name for s in rig]
        seen = {s.name: self._seen(number, s, m[s.name]) for s in rig}
        whole = self._enough(number, rig, seen, m, names)
        without = {
            lost: self._enough(number, rig, seen, m, [n for n in names if n != lost])
            for lost in names
        }
        passed = whole.copy()
        if requirement.under.one_lost:
            passed &= np.logical_and.reduce(list(without.values()))
        return Judged(passed, whole, without, seen)

    def _measured(self, number: int, rig: Rig) -> CountsBySensor:
        """Return m (N,) of all bodies by sensor, in a scene."""
        if self._joined is None:
            return {}
        if number not in self._measurers:
            vehicle, caches = self._caches.vehicle, self._caches.by_kernel(number)
            self._measurers[number] = ObjectMeasurementCache(
                self._joined, vehicle, kernel_caches=caches
            )
        return self._measurers[number].measure(rig)

    def _seen(self, number: int, sensor: Sensor, m: Floats) -> Flags:
        """Return the samples and bodies (N, bodies * headings) that a sensor sees."""
        requirement, samples = self._wanted[number]
        criterion, columns = requirement.criterion, []
        for each in self._bodies[number]:
            objects = self._objects[each.number]
            seen = body_has_enough(each.body, sensor, objects, m[each.box], criterion)
            if each.cells is not None and criterion.share is not None and seen.any():
                cells = (m[each.cells] > 0.0).reshape(len(seen), -1)
                seen[seen] = visible_share(each.body, cells[seen]) >= criterion.share
            columns.append(seen.reshape(len(samples.points), -1))
        return np.concatenate(columns, axis=1)

    def _enough(
        self,
        number: int,
        rig: Rig,
        seen: Mapping[str, Flags],
        m: CountsBySensor,
        members: Collection[str],
    ) -> Flags:
        """Return the samples (N,) at which some of the sensors see every body well enough."""
        criterion = self._wanted[number][0].criterion
        counts, kinds = counted(rig, seen, criterion, members)
        enough = (counts >= criterion.sensors) & (kinds >= criterion.kinds)
        if criterion.ap is not None and self._fused is not None:
            entropies, _ = self._fused.entropies(rig, m, members)
            ap, columns = ap_of_entropy(entropies), []
            for each in self._bodies[number]:
                best = ap[each.box].reshape(-1, each.body.box_count).max(axis=1)
                columns.append(best.reshape(len(enough), -1))
            enough &= np.concatenate(columns, axis=1) >= criterion.ap
        passed: Flags = enough.all(axis=1)
        return passed

    def _placed(self, requirement: Requirement, samples: Samples) -> tuple[_BodySet, ...]:
        """Put a requirement's bodies at all samples, heights and headings."""
        count = levels_of(requirement)
        heights, points = np.linspace(*requirement.zone.z, count), samples.points
        feet = np.column_stack([np.repeat(points, count, axis=0), np.tile(heights, len(points))])
        return tuple(self._body_set(each, feet, requirement) for each in requirement.bodies)

    def _body_set(self, body: Body, feet: Floats, requirement: Requirement) -> _BodySet:
        number = len(self._objects)
        box = self._added(placed(body, feet, body.headings, False))
        with_cells = requirement.criterion.share is not None
        cells = self._added(placed(body, feet, body.headings, True)) if with_cells else None
        return _BodySet(body, number, box, cells)

    def _added(self, objects: Objects) -> slice:
        self._objects.append(objects)
        self._count += len(objects)
        return slice(self._count - len(objects), self._count)

    def _asked(self, count: int) -> Floats:
        """Return weights (N,) of objects: 1 of those whose AP is asked for."""
        weights = np.zeros(count)
        for (requirement, _), bodies in zip(self._wanted, self._bodies, strict=True):
            if requirement.criterion.ap is not None:
                for each in bodies:
                    weights[each.box] = 1.0
        return weights


def counted(
    rig: Rig,
    seen: Mapping[str, Flags],
    criterion: Criterion,
    members: Collection[str],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return by how many sensors and kinds each body of each sample is seen, (N, bodies)."""
    first = next(iter(seen.values()))
    counts, by_kind = np.zeros(first.shape, np.int64), dict[str, Flags]()
    for sensor in rig:
        if sensor.name not in members or (criterion.of and sensor.kind not in criterion.of):
            continue
        counts += seen[sensor.name]
        none = np.zeros(first.shape, bool)
        by_kind[sensor.kind] = by_kind.get(sensor.kind, none) | seen[sensor.name]
    kinds = np.zeros(first.shape, np.int64)
    for flags in by_kind.values():
        kinds += flags
    return counts, kinds


def _joined(parts: Sequence[Objects]) -> Objects | None:
    """Return all objects as one set; None without any."""
    if not parts:
        return None
    names = sorted({part.class_names[0] for part in parts})
    labels = [np.full(len(part), names.index(part.class_names[0])) for part in parts]
    return Objects(
        np.concatenate([part.centers for part in parts]),
        np.concatenate([part.sizes for part in parts]),
        np.concatenate([part.yaws for part in parts]),
        np.concatenate(labels),
        tuple(names),
    )
