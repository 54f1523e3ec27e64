"""RequirementChecker: holds rigs to requirements; a sensor that has not moved costs nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.errors import InputError
from ...geometry.grids import PerceptionSpace
from ...scene.rig import Rig
from ...scene.vehicle import Vehicle
from ...scene.vehicle_description import Reference
from ...sensors import PerceptionModel
from .body_checks import BodyChecks, SceneCaches
from .criteria import Requirement, checked_requirements, levels_of
from .definition import cautious
from .ground import GroundCheck
from .margins import growth, margin_of
from .planes import VehiclePlanes
from .shortfall import shortfall
from .verdict import Judged, Samples, Verdict, body_verdict
from .zones import INSIDE_M, PlacedZone

Floats = NDArray[np.float64]
FULL, INSIDE, PREVIEW = "full", "inside", "preview"
"""Sets of samples: of the zones and the ground round them, of the zones alone, of fewer."""
COARSE = 2.0
"""Factor of the step of a preview."""
PREVIEW_OBJECTS = 1_000
"""A zone with fewer boxes keeps its step in a preview."""
MAX_GROWN = 30_000
"""A zone is grown as long as no more boxes stand on the ground that is added."""


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
    anchor : Vehicle, optional
        The vehicle to which zones are anchored, where it is not the one that occludes.

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
        anchor: Vehicle | None = None,
    ) -> None:
        self.requirements = checked_requirements(requirements)
        self.vehicle, self._model = vehicle, model or PerceptionModel()
        self._reference, self._space = reference, space or PerceptionSpace()
        self.anchor = anchor or vehicle
        planes: dict[tuple[Any, ...], VehiclePlanes] = {}
        self.zones: tuple[PlacedZone, ...] = tuple(
            each.zone.placed(self.anchor, reference, each.name, planes)
            for each in self.requirements
        )
        for requirement, zone in zip(self.requirements, self.zones, strict=True):
            check_extent(requirement, zone, self._space)
        self._caches = SceneCaches(vehicle)
        self._sets: dict[str, _CheckedSet] = {}
        self._lock = RLock()

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments: another process makes a checker of its own from them."""
        return _checker_again, (
            *(self.requirements, self.vehicle, self._model),
            *(self._reference, self._space, self.anchor),
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
        rig, cases = cautious(rig), [] if preview else [cautious(case) for case in cases]
        with self._lock:
            return self._set(PREVIEW if preview else FULL).verdicts(rig, cases)

    def shortfalls(self, rig: Rig, cases: Sequence[Rig] = ()) -> tuple[float, ...]:
        """Return for each requirement 0 where it is met, else how far it is off, above 0 to 1.

        For a search: exactly 0 where `check` says met. The number is the share of the samples that
        lacks (weight 0.45), how many sensors and kinds lack at the samples on average (0.45), and
        how far the nearest boresight is turned away from those that fail (0.1): it leads a search
        in where no sensor sees anything yet.
        """
        rig, cases = cautious(rig), [cautious(case) for case in cases]
        with self._lock:
            return self._set(INSIDE).shortfalls(rig, cases) if self.requirements else ()

    def _set(self, name: str) -> _CheckedSet:
        if name not in self._sets:
            self._sets[name] = _CheckedSet(self, name, self._space, self._model, self._caches)
        return self._sets[name]


def _checker_again(
    requirements: Sequence[Requirement],
    vehicle: Vehicle | None,
    model: PerceptionModel,
    reference: Reference | None,
    space: PerceptionSpace,
    anchor: Vehicle | None,
) -> RequirementChecker:
    """Make a checker from its pickled arguments."""
    return RequirementChecker(
        requirements, vehicle, model=model, reference=reference, space=space, anchor=anchor
    )


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
        self._vehicle, self._which, self._model = checker.vehicle, which, model
        self._caches, self._grounds, pairs = caches, dict[int, GroundCheck](), []
        self._numbers: list[int] = []
        for number, own in enumerate(checker.requirements):
            zone = checker.zones[number]
            if own.criterion.is_of_ground:
                anchor = checker.anchor
                self._grounds[number] = GroundCheck(own, zone, space, self._vehicle, anchor, caches)
            else:
                self._numbers.append(number)
                pairs.append((own, _samples(own, zone, which)))
        self._pairs = pairs
        self._bodies = BodyChecks(pairs, model, caches)
        self._grown: dict[tuple[int, float], tuple[Samples, BodyChecks] | None] = {}

    def verdicts(self, rig: Rig, cases: Sequence[Rig]) -> tuple[Verdict, ...]:
        """Return the verdicts on a rig."""
        preview = self._which == PREVIEW
        found: dict[int, Verdict] = {}
        for number, judged in enumerate(self._bodies.judged(rig, cases)):
            requirement, samples = self._pairs[number]
            own = body_verdict(requirement, samples, judged, rig, self._vehicle, preview)
            if own.at_least:
                margin, at_least = self._grown_margin(number, judged, rig, cases)
                own = replace(own, margin=margin, at_least=at_least)
            found[self._numbers[number]] = own
        for number, ground in self._grounds.items():
            found[number] = ground.verdict(rig, preview, cases)
        return tuple(found[number] for number in sorted(found))

    def shortfalls(self, rig: Rig, cases: Sequence[Rig]) -> tuple[float, ...]:
        """Return how far a rig is off each requirement, 0 where it is met."""
        found = {k: ground.shortfall(rig, cases) for k, ground in self._grounds.items()}
        for number, judged in enumerate(self._bodies.judged(rig, cases)):
            found[self._numbers[number]] = shortfall(*self._pairs[number], judged, rig)
        return tuple(found[number] for number in sorted(found))

    def _grown_margin(
        self, number: int, judged: Judged, rig: Rig, cases: Sequence[Rig]
    ) -> tuple[float, bool]:
        """Return the margin of a zone that could grow farther than it was sampled at first.

        The zone is grown to twice as far again and again, as long as it does not fail.
        """
        requirement, samples = self._pairs[number]
        distance, passed = samples.distance, judged.passed
        wanted, step = requirement.criterion.zone_share, requirement.zone.step
        inner = samples.zone.grow
        margin = margin_of(distance, passed, wanted, step, inner)
        for outer in growth(samples.zone):
            known = self._grown_checks(number, inner, outer)
            if known is None:
                break
            added, checks = known
            if len(added.points):
                (own,) = checks.judged(rig, cases)
                distance = np.concatenate([distance, added.distance])
                passed = np.concatenate([passed, own.passed])
            margin, inner = margin_of(distance, passed, wanted, step, outer), outer
            if not margin[1]:
                break
        return margin

    def _grown_checks(
        self, number: int, inner: float, outer: float
    ) -> tuple[Samples, BodyChecks] | None:
        """Return the samples round a zone between two distances; None where there are too many."""
        key = number, outer
        if key not in self._grown:
            requirement, samples = self._pairs[number]
            most = MAX_GROWN // _boxes_of(requirement)
            points, distance = samples.zone.ring_of_samples(inner, outer, most)
            added = Samples(samples.zone, points, distance)
            checks = BodyChecks(
                [(requirement, added)] * bool(len(points)), self._model, self._caches
            )
            self._grown[key] = (added, checks) if len(points) <= most else None
        return self._grown[key]


def _samples(requirement: Requirement, zone: PlacedZone, which: str) -> Samples:
    """Return the samples of a zone that one of the sets has."""
    points, distance = zone.samples(grown=which == FULL)
    if which == PREVIEW and len(points) * _boxes_of(requirement) > PREVIEW_OBJECTS:
        points, distance = zone.samples(COARSE, grown=False)
    return Samples(zone, points, distance)


def _boxes_of(requirement: Requirement) -> int:
    """Return how many boxes are measured at each sample."""
    with_cells = (False, True) if requirement.criterion.share is not None else (False,)
    boxes = sum(
        len(body.boxes(cells)[0]) * len(body.headings)
        for body in requirement.bodies
        for cells in with_cells
    )
    return boxes * levels_of(requirement)


def checkable(
    requirements: Sequence[Requirement],
    rig: Rig,
    vehicle: Vehicle | None,
    reference: Reference | None = None,
    space: PerceptionSpace | None = None,
) -> tuple[tuple[Requirement, ...], dict[str, str]]:
    """Return the requirements that a rig on a vehicle can be held to, and why not, by name.

    Others have a zone that cannot be placed, or ask for kinds of sensors that the rig lacks.
    """
    fitting, reasons = [], {}
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
    """Raise `InputError` for a zone outside of the space, or narrower than a body.

    A zone whose blind ground is asked for is wholly in the space.
    """
    who = f"requirement {requirement.name!r}"
    low, high = zone.bounds
    (x0, y0), (x1, y1) = low.tolist(), high.tolist()
    if x1 < space.x[0] or x0 > space.x[1] or y1 < space.y[0] or y0 > space.y[1]:
        expected = f"a zone in the space, x = {list(space.x)}, y = {list(space.y)}"
        raise InputError(who, "zone", expected, f"x = {[x0, x1]}, y = {[y0, y1]}")
    is_of_ground, (x, y) = requirement.criterion.is_of_ground, (space.x, space.y)
    if is_of_ground and not (x[0] <= x0 and x1 <= x[1] and y[0] <= y0 and y1 <= y[1]):
        expected = f"ground in the space, x = {list(x)}, y = {list(y)}: no other is searched"
        raise InputError(who, "zone", expected, f"x = {[x0, x1]}, y = {[y0, y1]}")
    for body in requirement.bodies:
        if zone.kind == "area" and min(body.size[:2]) > min(x1 - x0, y1 - y0) + INSIDE_M:
            found = f"{body.name}, {min(body.size[:2]):g} m, in {x1 - x0:g} x {y1 - y0:g} m"
            raise InputError(who, "body", "a body that is not larger than the zone", found)
