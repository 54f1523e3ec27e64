"""BodyChecks: test bodies at samples of zones, and which of them a rig sees well enough.

All bodies of some requirements are one set of objects, so a sensor that has moved is measured once,
with the kernels of objects. What follows, for every requirement and every lost sensor, is counting.
"""

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
from ...sensors import ObjectMeasurementCache, PerceptionModel
from ...sensors.boxes import BodyParts
from ..targets.object_metric import FusedObjects
from .bodies import Body
from .criteria import Criterion, Requirement, levels_of
from .definition import has_enough, parts_of, placed, visible_share
from .verdict import Samples, ZoneResult, columns_of

CountsBySensor = Mapping[str, Floats]
NOTHING = np.zeros(0)
PART = ("part",)


class SceneCaches(dict[int, dict[str, Any]]):
    """Caches of kernels by scene, shared by all sets of samples: a beam is cast once. Scene 0 is
    the rig as it stands, the others are the rig with mounting errors."""

    def __init__(self, vehicle: Vehicle | None) -> None:
        self.vehicle = vehicle

    def __missing__(self, number: int) -> dict[str, Any]:
        return self.setdefault(number, {})


@dataclass(frozen=True, eq=False)
class _BodySet:
    """One body of a requirement: its objects, and where these and their cells are among all."""

    body: Body
    objects: Objects
    box: slice
    cells: slice | None


@dataclass(frozen=True, slots=True)
class _PointsByBand:
    """m by sensor: (N,) of all bodies, and (C,) of their cells where the sensor shows parts."""

    m: CountsBySensor
    parts: CountsBySensor


class BodyChecks:
    """The bodies of requirements at samples of their zones, and the sensors measured on them."""

    def __init__(
        self,
        wanted: Sequence[tuple[Requirement, Samples]],
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self._wanted = wanted
        self._caches = caches
        self._bodies = [list[_BodySet]() for _ in wanted]
        all_parts = list[BodyParts]()
        count = cell_count = 0
        for own, (requirement, samples) in zip(self._bodies, wanted, strict=True):
            feet = _feet(requirement, samples)
            for body in requirement.bodies:
                objects = placed(body, feet, body.headings, False)
                box = slice(count, count := count + len(objects))
                cells = None
                if requirement.criterion.share is not None:
                    all_parts.append(parts_of(body, feet, body.headings))
                    cells = slice(cell_count, cell_count := cell_count + len(all_parts[-1].cells))
                own.append(_BodySet(body, objects, box, cells))
        self._joined = _joined([body.objects for own in self._bodies for body in own])
        self._parts = _joined_parts(all_parts)
        self._measurers: dict[int, ObjectMeasurementCache] = {}
        self._part_measurers: dict[int, ObjectMeasurementCache] = {}
        weights = np.zeros(count)  # of the objects whose AP is asked for
        for own, (requirement, _) in zip(self._bodies, wanted, strict=True):
            for body_set in own if requirement.criterion.ap is not None else ():
                weights[body_set.box] = 1.0
        self._fused = None
        if self._joined is not None and weights.any():
            self._fused = FusedObjects(self._joined, weights, model)

    def results(self, rig: Rig, cases: Sequence[Rig] = ()) -> list[ZoneResult]:
        """Return for each requirement which samples pass, with the rig as it stands and in all.
        `cases` are the rig with mounting errors, for requirements that ask for them."""
        measured = self._measured(0, rig)
        found = [self._result(k, rig, measured) for k in range(len(self._wanted))]
        asking = [k for k, (own, _) in enumerate(self._wanted) if own.robust_to.mounting]
        for number, case in enumerate(cases if asking else (), start=1):
            measured = self._measured(number, case)
            for k in asking:
                found[k].passed[:] &= self._result(k, case, measured).passed
        return found

    def measuring(self, rig: Rig, cases: Sequence[Rig] = ()) -> Iterator[None]:
        """Measure what `results` needs; yield after each sensor of each scene."""
        asked = cases if any(own.robust_to.mounting for own, _ in self._wanted) else ()
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
        whole = self._enough(number, rig, seen, measured.m, members=names)
        without = {
            lost: self._enough(
                number, rig, seen, measured.m, members=[n for n in names if n != lost]
            )
            for lost in names
        }
        passed = whole.copy()
        if requirement.robust_to.one_lost:
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
            vehicle = self._caches.vehicle
            caches = self._caches[number]
            self._measurers[number] = ObjectMeasurementCache(
                self._joined, vehicle, kernel_caches=caches
            )
            if self._parts is not None:
                self._part_measurers[number] = ObjectMeasurementCache(
                    self._parts, vehicle, kernel_caches=caches
                )
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
        criterion = requirement.criterion
        columns = []
        if not criterion.counts(sensor.kind):
            width = len(columns_of(requirement))
            return np.zeros((len(samples.points), width), bool)
        m = measured.m[sensor.name]
        parts = measured.parts.get(sensor.name, NOTHING)
        for each in self._bodies[number]:
            seen = has_enough(sensor, each.objects, m[each.box], criterion)
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
            ap = ap_of_entropy(entropies)
            columns = [ap[each.box].reshape(len(enough), -1) for each in self._bodies[number]]
            enough &= np.concatenate(columns, axis=1) >= criterion.ap
        passed: Flags = enough.all(axis=1)
        return passed


def _feet(requirement: Requirement, samples: Samples) -> Floats:
    """Return where bodies stand (N, 3): at all samples and heights."""
    count = levels_of(requirement)
    points = samples.points
    heights = np.linspace(*requirement.zone.z, count)
    return np.column_stack([np.repeat(points, count, axis=0), np.tile(heights, len(points))])


def counted(
    rig: Rig, seen: Mapping[str, Flags], criterion: Criterion, members: Collection[str]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return by how many sensors and kinds each body of each sample is seen, (N, bodies)."""
    first = next(iter(seen.values()))
    counts = np.zeros(first.shape, np.int64)
    by_kind = dict[str, Flags]()
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
    cells = list[Objects]()
    shells = list[Objects]()
    first = 0
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
