"""RequirementChecker: holds rigs to requirements; a sensor that has not moved costs nothing.

All bodies of all requirements are one set of objects, so a sensor that has moved is measured once,
with the kernels of objects. What follows, for every requirement and every lost sensor, is counting.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.grids import PerceptionSpace
from ...metric.entropy import ap_of_entropy
from ...scene.objects import Objects
from ...scene.rig import Rig, Sensor
from ...scene.vehicle import Vehicle
from ...scene.vehicle_description import Reference
from ...sensors import ObjectMeasurementCache, PerceptionModel
from ..targets.object_metric import FusedObjects
from .bodies import Body
from .criteria import (
    Criterion,
    Requirement,
    checked_requirements,
    has_enough,
    placed,
    visible_share,
)
from .ground import GroundCheck
from .planes import VehiclePlanes
from .verdict import Samples, Verdict, verdict
from .zones import INSIDE_M, PlacedZone

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
FULL, INSIDE, PREVIEW = "full", "inside", "preview"
"""Sets of samples: of the zones and the ground round them, of the zones alone, of fewer."""
COARSE = 2.0
"""Factor of the step of a preview."""
PREVIEW_SAMPLES = 400
"""A zone of fewer samples keeps its step in a preview."""


@dataclass(frozen=True, eq=False)
class _BodySet:
    """One body of a requirement: the number of its objects, and where these are among all."""

    body: Body
    number: int
    box: slice
    cells: slice | None


@dataclass(frozen=True, eq=False)
class _CheckedPart:
    """A requirement with its samples and bodies."""

    requirement: Requirement
    samples: Samples
    bodies: tuple[_BodySet, ...]
    ground: GroundCheck | None = None


class RequirementChecker:
    """Holds rigs to requirements round one vehicle.

    It is thread-safe: one thread at a time checks.

    Parameters
    ----------
    requirements : sequence of Requirement
    vehicle : Vehicle or None
    model : PerceptionModel, optional
        AP curves of objects, for criteria of AP.
    reference : Reference, optional
        The vehicle's axles, for zones that are anchored to them.
    space : PerceptionSpace, optional
        The ground on which blind ground is searched.

    Raises
    ------
    InputError
        When a zone cannot be placed, or two requirements have one name.
    """

    def __init__(
        self,
        requirements: Sequence[Requirement],
        vehicle: Vehicle | None,
        *,
        model: PerceptionModel | None = None,
        reference: Reference | None = None,
        space: PerceptionSpace | None = None,
    ) -> None:
        self.requirements = checked_requirements(requirements)
        self.vehicle, self._model = vehicle, model or PerceptionModel()
        self._reference, self._space = reference, space or PerceptionSpace()
        planes: dict[tuple[Any, ...], VehiclePlanes] = {}
        self.zones: tuple[PlacedZone, ...] = tuple(
            each.zone.placed(vehicle, reference, each.name, planes) for each in self.requirements
        )
        for requirement, zone in zip(self.requirements, self.zones, strict=True):
            _check_extent(requirement, zone, self._space)
        self._sets: dict[str, _CheckedSet] = {}
        self._lock = RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: another process makes a checker of its own from them."""
        return _checker_again, (
            *(self.requirements, self.vehicle, self._model),
            *(self._reference, self._space),
        )

    def check_rig(self, rig: Rig) -> None:
        """Raise `InputError` for a requirement on kinds of sensors that the rig lacks."""
        for each in self.requirements:
            each.criterion.check_rig(rig, f"requirement {each.name!r}")

    def check(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = ()
    ) -> tuple[Verdict, ...]:
        """Return a verdict on each requirement.

        Parameters
        ----------
        rig : Rig
        preview : bool
            Only samples inside the zones, with twice the step in large zones: fast, without
            margins of zones that are met.
        cases : sequence of Rig
            The rig with mounting errors, for requirements that have to be met under them.

        Raises
        ------
        InputError
            When a requirement asks for kinds of sensors that the rig lacks.
        """
        self.check_rig(rig)
        if not self.requirements:
            return ()
        with self._lock:
            samples = self._set(PREVIEW if preview else FULL)
            return samples.verdicts(rig, () if preview else cases)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement 0 where it is met, else how far it is off, above 0 to 1.

        For a search: exactly 0 where `check` says met. The number is the share of the samples that
        lacks (weight 0.45), how many sensors and kinds lack at the samples on average (0.45), and
        how far the nearest boresight is turned away from those that fail (0.1): it leads a search
        in where no sensor sees anything yet.
        """
        with self._lock:
            return self._set(INSIDE).shortfalls(rig, cases) if self.requirements else ()

    def _set(self, name: str) -> _CheckedSet:
        if name not in self._sets:
            self._sets[name] = _CheckedSet(self, name, self._space, self._model)
        return self._sets[name]


def _checker_again(
    requirements: Sequence[Requirement],
    vehicle: Vehicle | None,
    model: PerceptionModel,
    reference: Reference | None,
    space: PerceptionSpace,
) -> RequirementChecker:
    """Make a checker from its pickled arguments."""
    return RequirementChecker(requirements, vehicle, model=model, reference=reference, space=space)


class _CheckedSet:
    """The bodies of all requirements as objects, and the sensors measured on them."""

    def __init__(
        self,
        checker: RequirementChecker,
        which: str,
        space: PerceptionSpace,
        model: PerceptionModel,
    ) -> None:
        self._vehicle, self._which, self._space = checker.vehicle, which, space
        self._ground_caches: dict[str, dict[str, Any]] = {}
        self._objects: list[Objects] = []
        self._count = 0
        pairs = zip(checker.requirements, checker.zones, strict=True)
        self._parts = [self._part(requirement, zone) for requirement, zone in pairs]
        joined = _joined(self._objects)
        self._sensors = None if joined is None else ObjectMeasurementCache(joined, self._vehicle)
        self._cases: dict[int, ObjectMeasurementCache] = {}
        self._joined = joined
        self._fused = (
            None if joined is None else FusedObjects(joined, self._asked(len(joined)), model)
        )

    def verdicts(self, rig: Rig, cases: Sequence[Rig]) -> tuple[Verdict, ...]:
        """Return the verdicts on a rig."""
        m = self._measured(rig)
        others = self._measured_cases(cases)
        return tuple(self._verdict(part, rig, m, others) for part in self._parts)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig]) -> tuple[float, ...]:
        """Return how far a rig is off each requirement, 0 where it is met."""
        m = self._measured(rig)
        others = self._measured_cases(cases)
        return tuple(
            self._shortfall(part, rig, m, others)
            if part.ground is None
            else part.ground.shortfall(rig)
            for part in self._parts
        )

    def _measured(self, rig: Rig) -> Mapping[str, Floats]:
        return {} if self._sensors is None else self._sensors.measure(rig)

    def _measured_cases(self, cases: Sequence[Rig]) -> list[tuple[Rig, Mapping[str, Floats]]]:
        """Return the cases with m of their sensors, where any requirement has to survive them."""
        needed = any(p.requirement.under.mounting and p.bodies for p in self._parts)
        return [(c, self._case(k).measure(c)) for k, c in enumerate(cases)] if needed else []

    def _shortfall(
        self,
        part: _CheckedPart,
        rig: Rig,
        m: Mapping[str, Floats],
        others: Sequence[tuple[Rig, Mapping[str, Floats]]],
    ) -> float:
        """Return how far a requirement on bodies is off: see `RequirementChecker.shortfalls`."""
        criterion = part.requirement.criterion
        passed = self._passed(part, rig, m)
        for case, measured in others if part.requirement.under.mounting else ():
            passed &= self._passed(part, case, measured)
        share = float(passed[part.samples.inside].mean())
        if share >= criterion.zone_share:
            return 0.0
        seen = {s.name: self._seen(part, s, m[s.name]) for s in rig}
        counts, kinds = _counted(rig, seen, criterion, [s.name for s in rig])
        spare = int(part.requirement.under.one_lost)
        wanted = criterion.sensors + spare + criterion.kinds
        has = np.minimum(counts, criterion.sensors + spare) + np.minimum(kinds, criterion.kinds)
        lacks = 1.0 - float(has.mean()) / wanted
        away = _turned_away(part, rig, ~passed & part.samples.inside)
        return 0.45 * (1.0 - share / criterion.zone_share) + 0.45 * lacks + 0.1 * away

    def _verdict(
        self,
        part: _CheckedPart,
        rig: Rig,
        m: Mapping[str, Floats],
        others: Sequence[tuple[Rig, Mapping[str, Floats]]],
    ) -> Verdict:
        requirement = part.requirement
        preview = self._which == PREVIEW
        if part.ground is not None:
            return part.ground.verdict(rig, preview)
        seen = {s.name: self._seen(part, s, m[s.name]) for s in rig}
        whole = self._enough(part, rig, seen, m, [s.name for s in rig])
        without = {
            s.name: self._enough(part, rig, seen, m, [o.name for o in rig if o is not s])
            for s in rig
        }
        passed = whole.copy()
        if requirement.under.one_lost:
            passed &= np.logical_and.reduce(list(without.values()))
        for case, measured in others if requirement.under.mounting else ():
            passed &= self._passed(part, case, measured)
        return verdict(
            requirement,
            part.samples,
            rig,
            self._vehicle,
            passed,
            whole,
            without,
            seen,
            preview,
        )

    def _passed(self, part: _CheckedPart, rig: Rig, m: Mapping[str, Floats]) -> Flags:
        """Return the samples (N,) that pass with a rig, and with each one of its sensors lost."""
        seen = {s.name: self._seen(part, s, m[s.name]) for s in rig}
        names = [s.name for s in rig]
        passed = self._enough(part, rig, seen, m, names)
        if part.requirement.under.one_lost:
            for name in names:
                passed &= self._enough(part, rig, seen, m, [n for n in names if n != name])
        return passed

    def _seen(self, part: _CheckedPart, sensor: Sensor, m: Floats) -> Flags:
        """Return the samples and bodies (N, bodies * headings) that a sensor sees."""
        criterion, count = part.requirement.criterion, len(part.samples.points)
        columns = []
        for each in part.bodies:
            seen = has_enough(sensor, self._objects[each.number], m[each.box], criterion)
            if each.cells is not None and criterion.share is not None:
                cells = (m[each.cells] > 0.0).reshape(len(seen), -1)
                seen &= visible_share(each.body, cells) >= criterion.share
            columns.append(seen.reshape(count, -1))
        return np.concatenate(columns, axis=1)

    def _enough(
        self,
        part: _CheckedPart,
        rig: Rig,
        seen: Mapping[str, Flags],
        m: Mapping[str, Floats],
        members: Collection[str],
    ) -> Flags:
        """Return the samples (N,) at which some of the sensors see every body well enough."""
        criterion = part.requirement.criterion
        counts, kinds = _counted(rig, seen, criterion, members)
        enough = (counts >= criterion.sensors) & (kinds >= criterion.kinds)
        if criterion.ap is not None and self._fused is not None:
            entropies, _ = self._fused.entropies(rig, m, members)
            ap = ap_of_entropy(entropies)
            columns = [ap[b.box].reshape(len(enough), -1) for b in part.bodies]
            enough &= np.concatenate(columns, axis=1) >= criterion.ap
        passed: Flags = enough.all(axis=1)
        return passed

    def _part(self, requirement: Requirement, zone: PlacedZone) -> _CheckedPart:
        if requirement.criterion.is_of_ground:
            empty = Samples(zone, np.zeros((0, 2)), np.zeros(0))
            ground = GroundCheck(requirement, zone, self._space, self._vehicle, self._ground_caches)
            return _CheckedPart(requirement, empty, (), ground)
        points, distance = zone.samples(grown=self._which == FULL)
        if self._which == PREVIEW and len(points) > PREVIEW_SAMPLES:
            points, distance = zone.samples(COARSE, grown=False)
        samples = Samples(zone, points, distance)
        low, high = requirement.zone.z
        count = 1 if high == low else int(np.ceil((high - low) / requirement.zone.step)) + 1
        heights = np.linspace(low, high, count)
        feet = np.column_stack([np.repeat(points, count, axis=0), np.tile(heights, len(points))])
        bodies = tuple(self._body_set(each, feet, requirement) for each in requirement.bodies)
        return _CheckedPart(requirement, samples, bodies)

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

    def _case(self, number: int) -> ObjectMeasurementCache:
        assert self._joined is not None
        if number not in self._cases:
            self._cases[number] = ObjectMeasurementCache(self._joined, self._vehicle)
        return self._cases[number]

    def _asked(self, count: int) -> Floats:
        """Return weights (N,) of objects: 1 of those whose AP is asked for."""
        weights = np.zeros(count)
        for part in self._parts:
            if part.requirement.criterion.ap is not None:
                for each in part.bodies:
                    weights[each.box] = 1.0
        return weights


def _check_extent(requirement: Requirement, zone: PlacedZone, space: PerceptionSpace) -> None:
    """Raise `InputError` for a zone outside of the space, or narrower than a body."""
    who = f"requirement {requirement.name!r}"
    low, high = zone.bounds
    (x0, y0), (x1, y1) = low.tolist(), high.tolist()
    if x1 < space.x[0] or x0 > space.x[1] or y1 < space.y[0] or y0 > space.y[1]:
        expected = f"a zone in the space, x = {list(space.x)}, y = {list(space.y)}"
        raise InputError(who, "zone", expected, f"x = {[x0, x1]}, y = {[y0, y1]}")
    for body in requirement.bodies:
        if zone.kind == "area" and min(body.size[:2]) > min(x1 - x0, y1 - y0) + INSIDE_M:
            found = f"{body.name}, {min(body.size[:2]):g} m, in {x1 - x0:g} x {y1 - y0:g} m"
            raise InputError(who, "body", "a body that is not larger than the zone", found)


def _turned_away(part: _CheckedPart, rig: Rig, failing: Flags) -> float:
    """Return the mean angle between failing samples and the nearest boresight, 1 for 180 deg."""
    kinds = part.requirement.criterion.of
    sensors = [s for s in rig if not kinds or s.kind in kinds]
    if not sensors or not failing.any():
        return 1.0
    body = part.bodies[0].body
    points = np.column_stack(
        [part.samples.points[failing], np.full(int(failing.sum()), body.low + body.size[2] / 2.0)]
    )
    cosines = []
    for sensor in sensors:
        offset = points - np.asarray(sensor.pose.position)
        ahead = sensor.pose.ground_from_sensor[:, 0]
        x, y, z = offset.T
        length = np.sqrt(x * x + y * y + z * z)
        along = ahead[0] * x + ahead[1] * y + ahead[2] * z
        cosines.append(along / np.maximum(length, INSIDE_M))
    nearest = np.clip(np.max(cosines, axis=0), -1.0, 1.0)
    angles = [math.acos(c) for c in nearest.tolist()]  # the same bits in all builds
    return sum(angles) / len(angles) / math.pi


def _counted(
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
