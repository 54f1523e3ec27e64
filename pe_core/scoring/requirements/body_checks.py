"""BodyChecks: test bodies at samples of zones, and which of them a rig sees well enough.

All bodies of some requirements are one set of objects, so a sensor that has moved is measured once,
with the kernels of objects. What follows, for every requirement and every lost sensor, is counting.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Flags, Floats
from ...metric.entropy import ap_of_entropy
from ...scene.objects import Objects
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...sensors import ObjectMeasurementCache, PartMeasurementCache, PerceptionModel
from ...sensors.boxes import BodyParts
from ..targets.object_metric import FusedObjects
from .bodies import Body
from .criteria import Criterion, Requirement, levels_of
from .definition import body_has_enough, parts_of, placed, visible_share
from .reasons import columns_of
from .verdict import Samples, ZoneResult

CountsBySensor = Mapping[str, Floats]
NOTHING = np.zeros(0)
PART = ("part",)


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


@dataclass(frozen=True, slots=True)
class _PointsByBand:
    """m by sensor: (N,) of all bodies, and (C,) of their cells where the sensor shows parts."""

    m: CountsBySensor
    parts: CountsBySensor


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
        self._all_parts: list[BodyParts] = []
        self._count = self._cell_count = 0
        self._bodies = [self._placed(*pair) for pair in wanted]
        self._joined = _joined(self._objects)
        self._parts = _joined_parts(self._all_parts)
        self._measurers: dict[int, ObjectMeasurementCache] = {}
        self._part_measurers: dict[int, PartMeasurementCache] = {}
        weights = None if self._joined is None else self._asked(len(self._joined))
        self._fused = None
        if self._joined is not None and weights is not None and weights.any():
            self._fused = FusedObjects(self._joined, weights, model)

    def results(self, rig: Rig, cases: Sequence[Rig] = ()) -> list[ZoneResult]:
        """Return for each requirement which samples pass, with the rig as it stands and in all.

        `cases` are the rig with mounting errors, for requirements that ask for them.
        """
        measured = self._measured(0, rig)
        found = [self._result(k, rig, measured) for k in range(len(self._wanted))]
        asking = [k for k, (own, _) in enumerate(self._wanted) if own.under.mounting]
        for number, case in enumerate(cases if asking else (), start=1):
            measured = self._measured(number, case)
            for k in asking:
                found[k].passed[:] &= self._result(k, case, measured).passed
        return found

    def measuring(self, rig: Rig, cases: Sequence[Rig] = ()) -> Iterator[None]:
        """Measure what `results` needs; yield after each sensor of each scene."""
        asked = cases if any(own.under.mounting for own, _ in self._wanted) else ()
        for number, case in enumerate((rig, *asked)):
            for sensor in case if self._joined is not None else ():
                for measurer in self._measurers_of(number, sensor):
                    if measurer.cached(sensor) is None:
                        measurer.measure_again(sensor)
                yield

    def seen_by(self, number: int, sensor: Sensor) -> Flags:
        """Return the samples and bodies (N, bodies * headings) of the first requirement that a
        sensor sees in a scene."""
        found = [
            {sensor.name: each.measure_again(sensor)} for each in self._measurers_of(number, sensor)
        ]
        return self._seen(0, sensor, _PointsByBand(found[0], found[-1] if len(found) > 1 else {}))

    def _result(self, number: int, rig: Rig, measured: _PointsByBand) -> ZoneResult:
        requirement, _ = self._wanted[number]
        names = [s.name for s in rig]
        seen = {s.name: self._seen(number, s, measured) for s in rig}
        whole = self._enough(number, rig, seen, measured.m, names)
        without = {
            lost: self._enough(number, rig, seen, measured.m, [n for n in names if n != lost])
            for lost in names
        }
        passed = whole.copy()
        if requirement.under.one_lost:
            passed &= np.logical_and.reduce(list(without.values()))
        return ZoneResult(passed, whole, without, seen)

    def _measured(self, number: int, rig: Rig) -> _PointsByBand:
        """Return m of all bodies, and of their cells where a share is asked for, in a scene."""
        if self._joined is None:
            return _PointsByBand({}, {})
        m = self._measurer(number).measure(rig)
        parts: CountsBySensor = {}
        if number in self._part_measurers:
            parts = self._part_measurers[number].measure(filter(self._shows_parts, rig))
        return _PointsByBand(m, parts)

    def _measurer(self, number: int) -> ObjectMeasurementCache:
        """Return what measures bodies in a scene; what measures their cells is made, too."""
        if number not in self._measurers:
            assert self._joined is not None
            vehicle, caches = self._caches.vehicle, self._caches.by_kernel(number)
            self._measurers[number] = ObjectMeasurementCache(
                self._joined, vehicle, kernel_caches=caches
            )
            if self._parts is not None:
                self._part_measurers[number] = PartMeasurementCache(self._parts, vehicle, caches)
        return self._measurers[number]

    def _measurers_of(self, number: int, sensor: Sensor) -> list[ObjectMeasurementCache]:
        """Return what measures a sensor on bodies, and on their cells where it shows parts."""
        found = [self._measurer(number)]
        if number in self._part_measurers and self._shows_parts(sensor):
            found.append(self._part_measurers[number])
        return found

    def _shows_parts(self, sensor: Sensor) -> bool:
        """Whether cells of bodies are asked of a sensor."""
        asking = (own.criterion for own, _ in self._wanted if own.criterion.share is not None)
        return any(each.counts(sensor.kind) for each in asking)

    def _seen(self, number: int, sensor: Sensor, measured: _PointsByBand) -> Flags:
        """Return the samples and bodies (N, bodies * headings) that a sensor sees."""
        requirement, samples = self._wanted[number]
        criterion, columns = requirement.criterion, []
        if not criterion.counts(sensor.kind):
            width = len(columns_of(requirement))
            return np.zeros((len(samples.points), width), bool)
        m, parts = measured.m[sensor.name], measured.parts.get(sensor.name, NOTHING)
        for each in self._bodies[number]:
            objects = self._objects[each.number]
            seen = body_has_enough(each.body, sensor, objects, m[each.box], criterion)
            if each.cells is not None and criterion.share is not None and seen.any():
                cells = (parts[each.cells] > 0.0).reshape(len(seen), -1)
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
            counting = [s.name for s in rig if s.name in members and criterion.counts(s.kind)]
            entropies, _ = self._fused.entropies(rig, m, counting)
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
        cells = None
        if requirement.criterion.share is not None:
            parts = parts_of(body, feet, body.headings)
            self._all_parts.append(parts)
            self._cell_count += len(parts.cells)
            cells = slice(self._cell_count - len(parts.cells), self._cell_count)
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
        if sensor.name not in members or not criterion.counts(sensor.kind):
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
    names = tuple(sorted({part.class_names[0] for part in parts}))
    return Objects.joined(
        [
            replace(part, labels=part.labels + names.index(part.class_names[0]), class_names=names)
            for part in parts
        ]
    )


def _joined_parts(parts: Sequence[BodyParts]) -> BodyParts | None:
    """Return all parts as one set, first the cells, then the shells; None without any."""
    if not parts:
        return None
    cells, shells, first = list[Objects](), list[Objects](), 0
    for each in parts:
        for own, objects in ((cells, each.cells), (shells, each.shells)):
            if objects is not None:
                own.append(replace(objects, scenes=objects.scenes + first, class_names=PART))
        first += int(each.cells.scenes.max()) + 1
    order = np.argsort(
        np.concatenate([np.arange(len(p.bands)) >= len(p.cells) for p in parts]), kind="stable"
    )
    bands, layers = (
        np.concatenate([getattr(p, key) for p in parts])[order] for key in ("bands", "layers")
    )
    return BodyParts(
        Objects.joined(cells), Objects.joined(shells) if shells else None, bands, layers
    )
