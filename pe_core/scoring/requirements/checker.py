"""RequirementChecker: holds rigs to requirements; a sensor that has not moved costs nothing."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError
from ...base.lazy_threads import threads
from ...geometry.grids import PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...scene.vehicle_description import Reference
from ...sensors import PerceptionModel
from .body_checks import BodyChecks, SceneCaches, counted
from .criteria import Requirement, checked_requirements
from .definition import cautious
from .ground import GroundCheck
from .planes import VehiclePlanes
from .verdict import Samples, Verdict, ZoneResult, body_verdict
from .zone_growth import ZoneGrowth, boxes_of
from .zones import INSIDE_M, PlacedZone

FULL = "full"
INSIDE = "inside"
PREVIEW = "preview"
"""Sets of samples: of the zones and the ground round them, of the zones alone, of fewer."""
COARSE = 2.0  # Factor of the step of a preview
PREVIEW_OBJECTS = 1_000  # A zone with fewer boxes keeps its step in a preview
SHARE_WEIGHT = 0.45
LACKING_WEIGHT = 0.45
AWAY_WEIGHT = 0.1
"""Weights of the samples that fail, of sensors and kinds that lack, and of the angle."""


class CheckStep(NamedTuple):
    """A step of a check: the part that is done, 0 to 1, and the verdict that it found, if any.
    `is_early`: the verdict comes again, once its margin is known."""

    fraction: float
    verdict: Verdict | None = None
    is_early: bool = False


class RequirementChecker:
    """Holds rigs to requirements round one vehicle. Zones are placed round the vehicle as drawn.

    It is thread-safe: one thread at a time checks.

    `InputError` when a zone cannot be placed, or two requirements have one name.

    `model`: AP curves of objects, for criteria of AP.
    `reference`: The vehicle's axles, for zones that are anchored to them.
    `space`: The ground on which blind ground is searched.
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
        self.vehicle = vehicle
        self._model = model or PerceptionModel()
        self._reference = reference
        self._space = space or PerceptionSpace()
        self.anchor = None if vehicle is None else vehicle.as_drawn
        planes: dict[tuple[Any, ...], VehiclePlanes] = {}
        self.zones: tuple[PlacedZone, ...] = tuple(
            each.zone.placed(self.anchor, reference, each.name, planes)
            for each in self.requirements
        )
        for requirement, zone in zip(self.requirements, self.zones, strict=True):
            check_extent(requirement, zone, self._space)
        self._caches = SceneCaches(vehicle)
        self._sets: dict[str, _CheckedSet] = {}
        self._lock = threads().RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: another process makes a checker of its own from them."""
        again = partial(RequirementChecker, self.requirements, self.vehicle, model=self._model)
        return partial(again, reference=self._reference, space=self._space), ()

    def check_rig(self, rig: Rig) -> None:
        """Raise `InputError` for a requirement on kinds of sensors that the rig lacks."""
        for each in self.requirements:
            each.criterion.check_rig(rig, f"requirement {each.name!r}")

    def check(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = ()
    ) -> tuple[Verdict, ...]:
        """Return a verdict on each requirement.

        `InputError` when a requirement asks for kinds of sensors that the rig lacks.

        `preview`: Only samples inside the zones, with twice the step in large zones: fast, without
            margins of zones that are met.
        `cases`: The rig with mounting errors, for requirements that have to be met under them.
        """
        steps = self.steps(rig, preview=preview, cases=cases)
        return tuple(step.verdict for step in steps if step.verdict is not None)

    def steps(
        self, rig: Rig, *, preview: bool = False, cases: Sequence[Rig] = (), early: bool = False
    ) -> Iterator[CheckStep]:
        """Yield the verdicts of `check` one after the other, in its order, with steps in between.

        `early`: First yield whether each requirement is met, with a margin of at least 0 where it
        is: how far a zone of bodies could grow takes several times as long.

        Whoever takes no more steps ends the work. Several threads may take steps of one checker:
        what one of them has measured, the others do not measure again.
        """
        self.check_rig(rig)
        if not self.requirements:
            return
        rig = cautious(rig)
        cases = [] if preview else [cautious(case) for case in cases]
        with self._lock:
            steps = self._set(PREVIEW if preview else FULL).steps(rig, cases, early)
        while True:
            with self._lock:  # not while others have what was yielded
                taken = list(islice(steps, 1))
                while taken and taken[-1].is_early:  # all at once: no margin of others in between
                    taken += islice(steps, 1)
            if not taken:
                return
            yield from taken

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement 0 where it is met, else how far it is off, above 0 to 1.

        For a search: exactly 0 where `check` says met. The number is the share of the samples that
        lacks (weight 0.45), how many sensors and kinds lack at the samples on average (0.45), and
        how far the nearest boresight is turned away from those that fail (0.1): it leads a search
        in where no sensor sees anything yet.
        """
        rig = cautious(rig)
        cases = [cautious(case) for case in cases]
        with self._lock:
            return self._set(INSIDE).shortfalls(rig, cases) if self.requirements else ()

    def _set(self, name: str) -> "_CheckedSet":
        if name not in self._sets:
            self._sets[name] = _CheckedSet(
                self, name, self._space, self._model, caches=self._caches
            )
        return self._sets[name]


class _CheckedSet:
    """Samples of all zones: those of bodies as one set, and blind ground zone by zone."""

    def __init__(
        self,
        checker: RequirementChecker,
        which: str,
        space: PerceptionSpace,
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self._vehicle = checker.vehicle
        self._which = which
        self._grounds = dict[int, GroundCheck]()
        self._growths = dict[int, ZoneGrowth]()
        pairs: list[tuple[Requirement, Samples]] = []
        self._numbers: list[int] = []
        for number, own in enumerate(checker.requirements):
            zone = checker.zones[number]
            if own.criterion.is_of_ground:
                anchor = checker.anchor
                self._grounds[number] = GroundCheck(
                    own, zone, space, self._vehicle, anchor=anchor, caches=caches
                )
            else:
                inside, around = _samples(own, zone, which)
                self._growths[number] = ZoneGrowth(own, inside, around, model, caches=caches)
                self._numbers.append(number)
                pairs.append((own, inside))
        self._pairs = pairs
        self._bodies = BodyChecks(pairs, model, caches)

    def steps(self, rig: Rig, cases: Sequence[Rig], early: bool) -> Iterator[CheckStep]:
        """Yield the verdicts on a rig, and steps without one in between."""
        preview = self._which == PREVIEW
        done = 0
        scenes = 1 + len(cases) * any(own.robust_to.mounting for own, _ in self._pairs)
        total = len(self._pairs) + len(self._grounds) + len(rig) * scenes * bool(self._pairs)
        for _ in self._bodies.measuring(rig, cases):
            done += 1
            yield CheckStep(done / total)
        results = dict(zip(self._numbers, self._bodies.results(rig, cases), strict=True))
        pairs = dict(zip(self._numbers, self._pairs, strict=True))
        numbers = sorted([*pairs, *self._grounds])

        def verdict_at_once(number: int) -> Verdict:
            """How far a zone of bodies could grow is not known yet."""
            if number not in pairs:
                return self._grounds[number].verdict(rig, preview, cases)
            requirement, samples = pairs[number]
            result = results[number]
            return body_verdict(
                requirement, samples, result, rig, vehicle=self._vehicle, preview=preview
            )

        verdicts: dict[int, Verdict] = {}
        for number in numbers if early else ():
            verdicts[number] = verdict_at_once(number)
            yield CheckStep(done / total, verdicts[number], is_early=True)
        for number in numbers:
            verdict = verdicts.get(number) or verdict_at_once(number)
            if number in pairs and verdict.at_least:
                for grown in self._growths[number].margins(results[number], rig, cases):
                    margin, at_least = grown
                    yield CheckStep(done / total)
                verdict = replace(verdict, margin=margin, at_least=at_least)
            done += 1
            yield CheckStep(done / total, verdict)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig]) -> tuple[float, ...]:
        """Return how far a rig is off each requirement, 0 where it is met."""
        found = {k: ground.shortfall(rig, cases) for k, ground in self._grounds.items()}
        for number, result in enumerate(self._bodies.results(rig, cases)):
            found[self._numbers[number]] = shortfall(*self._pairs[number], result, rig)
        return tuple(found[number] for number in sorted(found))


def _samples(requirement: Requirement, zone: PlacedZone, which: str) -> tuple[Samples, Samples]:
    """Return the samples in a zone that one of the sets has, and those of the ground round it."""
    points, distance = zone.samples(grown=which == FULL)
    if which == PREVIEW and len(points) * boxes_of(requirement) > PREVIEW_OBJECTS:
        points, distance = zone.samples(COARSE, grown=False)
    inside = distance <= INSIDE_M
    return (
        Samples(zone, points[inside], distance[inside]),
        Samples(zone, points[~inside], distance[~inside]),
    )


def checkable(
    requirements: Sequence[Requirement],
    rig: Rig,
    vehicle: Vehicle | None,
    reference: Reference | None = None,
    space: PerceptionSpace | None = None,
) -> tuple[tuple[Requirement, ...], dict[str, str]]:
    """Return the requirements that a rig on a vehicle can be held to, and why not, by name. Others
    have a zone that cannot be placed, or ask for kinds of sensors that the rig lacks."""
    fitting = []
    reasons = {}
    planes: dict[tuple[Any, ...], VehiclePlanes] = {}
    for each in requirements:
        try:
            each.criterion.check_rig(rig, each.name)
            zone = each.zone.placed(vehicle, reference, each.name, planes)
            check_extent(each, zone, space or PerceptionSpace())
            fitting.append(each)
        except InputError as error:
            reasons[each.name] = f"{error.field}: expected {error.expected}, found {error.found}"
    return tuple(fitting), reasons


def check_extent(requirement: Requirement, zone: PlacedZone, space: PerceptionSpace) -> None:
    """Raise `InputError` for a zone outside of the space, or narrower than a body. A zone whose
    blind ground is asked for is wholly in the space."""
    who = f"requirement {requirement.name!r}"
    low, high = zone.bounds
    x0, y0 = low.tolist()
    x1, y1 = high.tolist()
    if x1 < space.x[0] or x0 > space.x[1] or y1 < space.y[0] or y0 > space.y[1]:
        expected = f"a zone in the space, x = {list(space.x)}, y = {list(space.y)}"
        raise InputError(who, "zone", expected, f"x = {[x0, x1]}, y = {[y0, y1]}")
    is_of_ground = requirement.criterion.is_of_ground
    x = space.x
    y = space.y
    if is_of_ground and not (x[0] <= x0 and x1 <= x[1] and y[0] <= y0 and y1 <= y[1]):
        expected = f"ground in the space, x = {list(x)}, y = {list(y)}: no other is searched"
        raise InputError(who, "zone", expected, f"x = {[x0, x1]}, y = {[y0, y1]}")
    for body in requirement.bodies:
        if zone.kind == "area" and min(body.size[:2]) > min(x1 - x0, y1 - y0) + INSIDE_M:
            found = f"{body.name}, {min(body.size[:2]):g} m, in {x1 - x0:g} x {y1 - y0:g} m"
            raise InputError(who, "body", "a body that is not larger than the zone", found)


def shortfall(requirement: Requirement, samples: Samples, result: ZoneResult, rig: Rig) -> float:
    """Return 0 where a requirement is met, else how far it is off, above 0 to 1."""
    criterion = requirement.criterion
    inside = samples.inside
    share = float(result.passed[inside].mean())
    if share >= criterion.zone_share:
        return 0.0
    counts, kinds = counted(rig, result.seen, criterion, [s.name for s in rig])
    spare = int(requirement.robust_to.one_lost)
    wanted = criterion.sensors + spare + criterion.kinds
    has = np.minimum(counts, criterion.sensors + spare) + np.minimum(kinds, criterion.kinds)
    lacks = 1.0 - float(has.mean()) / wanted
    fails = 1.0 - share / criterion.zone_share
    away = _turned_away(requirement, samples.points[~result.passed & inside], rig)
    return SHARE_WEIGHT * fails + LACKING_WEIGHT * lacks + AWAY_WEIGHT * away


def _turned_away(requirement: Requirement, points: Floats, rig: Rig) -> float:
    """Return the mean angle between points (N, 2) and the nearest boresight, 1 for 180 deg."""
    sensors = [s for s in rig if requirement.criterion.counts(s.kind)]
    if not sensors or not len(points):
        return 1.0
    body = requirement.bodies[0]
    cosines = []
    places = np.column_stack([points, np.full(len(points), body.low + body.size[2] / 2.0)])
    for sensor in sensors:
        x, y, z = (places - np.asarray(sensor.pose.position)).T
        ahead = sensor.pose.ground_from_sensor[:, 0]
        length = np.sqrt(x * x + y * y + z * z)
        along = ahead[0] * x + ahead[1] * y + ahead[2] * z
        cosines.append(along / np.maximum(length, INSIDE_M))
    nearest = np.clip(np.max(cosines, axis=0), -1.0, 1.0)
    angles = [math.acos(c) for c in nearest.tolist()]  # the same bits in all builds
    return sum(angles) / len(angles) / math.pi
