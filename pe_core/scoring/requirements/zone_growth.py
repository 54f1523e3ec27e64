"""ZoneGrowth: how far a zone could grow before a requirement fails, with as few measurements as
decide that.

The ground round a zone is looked at from the zone outwards, part by part, until the requirement
fails. In a part the sensors are asked one after the other, those first that saw most so far, and
only about samples that the ones before leave undecided. A sensor more that sees a body makes no
sample fail, so the samples that pass are those of `BodyChecks.results`.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...scene.rig import Rig, Sensor
from ...sensors import PerceptionModel
from .body_checks import BodyChecks, SceneCaches, counted
from .criteria import Requirement, levels_of
from .verdict import Samples, ZoneResult, columns_of, growth, margin_of
from .zones import INSIDE_M

MAX_GROWN = 30_000
"""A zone is grown as long as no more boxes stand on the ground that is added."""
PART_BOXES = 8_000
"""The boxes that are measured at once, about: after each part it may be clear that it fails."""


class ZoneGrowth:
    """Grows the zone of one requirement on bodies. Samples are given `inside` the zone, and
    `around` it up to `zone.grow`."""

    def __init__(
        self,
        requirement: Requirement,
        inside: Samples,
        around: Samples,
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self._requirement = requirement
        self._inside = inside
        self._model = model
        self._caches = caches
        self._rings: dict[float, list[RingPart] | None] = {
            inside.zone.grow: self._parts(around.points, around.distance)
        }

    def margins(
        self, result: ZoneResult, rig: Rig, cases: Sequence[Rig]
    ) -> Iterator[tuple[float, bool]]:
        """Yield the margin of a zone that meets its requirement, and whether it could grow more.
        The zone is grown to twice as far again and again, as long as it does not fail, and a margin
        is yielded after each part that is measured: the last one counts."""
        wanted = self._requirement.criterion.zone_share
        step = self._requirement.zone.step
        distance = self._inside.distance
        passed = result.passed
        inner = 0.0
        saw = {name: int(np.count_nonzero(flags)) for name, flags in result.seen.items()}
        for outer in (self._inside.zone.grow, *growth(self._inside.zone)):
            parts = self._ring(inner, outer)
            if parts is None:
                return
            for part in parts:
                distance = np.concatenate([distance, part.samples.distance])
                passed = np.concatenate([passed, part.passed(rig, cases, saw)])
                margin = margin_of(distance, passed, wanted, step, looked=outer)
                yield margin
                if not margin[1]:
                    return
            inner = outer
            yield margin_of(distance, passed, wanted, step, looked=outer)

    def _ring(self, inner: float, outer: float) -> "list[RingPart] | None":
        """Return the ground round the zone between two distances; None where it is too much."""
        if outer not in self._rings:
            most = MAX_GROWN // boxes_of(self._requirement)
            points, distance = self._inside.zone.ring_of_samples(inner, outer, most)
            parts = self._parts(points, distance) if len(points) <= most else None
            self._rings[outer] = parts
        return self._rings[outer]

    def _parts(self, points: Floats, distance: Floats) -> "list[RingPart]":
        """Return samples from the zone outwards; those at one distance stay together."""
        order = np.argsort(distance, kind="stable")
        size = PART_BOXES // boxes_of(self._requirement)
        away = distance[order]
        cuts = []
        last = 0
        for cut in (np.flatnonzero(np.diff(away) > INSIDE_M) + 1).tolist():
            if cut - last >= size:
                cuts.append(last := cut)
        return [
            RingPart(
                Samples(self._inside.zone, points[own], distance[own]),
                self._requirement,
                self._model,
                self._caches,
            )
            for own in np.split(order, cuts)
            if len(own)
        ]


class RingPart:
    """Some samples round a zone, and what is known of the sensors that see bodies there."""

    def __init__(
        self,
        samples: Samples,
        requirement: Requirement,
        model: PerceptionModel,
        caches: SceneCaches,
    ) -> None:
        self.samples = samples
        self._requirement = requirement
        self._model = model
        self._caches = caches
        self._whole: BodyChecks | None = None
        self._known: dict[tuple[int, str], tuple[Sensor, Flags, Flags]] = {}

    def passed(self, rig: Rig, cases: Sequence[Rig], saw: dict[str, int]) -> Flags:
        """Return which samples (N,) pass, as `ZoneResult.passed`. `saw` is what each sensor saw so
        far, by name; what is measured here is added."""
        own = self._requirement
        if own.criterion.ap is not None:  # all sensors count together
            self._whole = self._whole or self._checks(own, self.samples.points)
            return self._whole.results(rig, cases)[0].passed
        passing = np.arange(len(self.samples.points))
        for number, case in enumerate((rig, *(cases if own.robust_to.mounting else ()))):
            passing = self._passing(number, case, passing, saw)
        passed = np.zeros(len(self.samples.points), bool)
        passed[passing] = True
        return passed

    def _passing(self, number: int, rig: Rig, among: Ints, saw: dict[str, int]) -> Ints:
        """Return those of some samples that pass in a scene."""
        counts = self._requirement.criterion.counts
        unsure = among
        seen = dict[str, Flags]()
        asked = [sensor for sensor in rig if counts(sensor.kind)]
        for sensor in sorted(asked, key=lambda s: self._rank(number, s, saw)):
            if not len(unsure):
                break
            seen[sensor.name] = self._seen(number, sensor, unsure, saw)
            unsure = unsure[~self._enough(rig, {n: flags[unsure] for n, flags in seen.items()})]
        return np.setdiff1d(among, unsure, assume_unique=True)

    def _rank(self, number: int, sensor: Sensor, saw: Mapping[str, int]) -> tuple[int, int]:
        """Return what orders sensors: known ones cost nothing, and one that moved may move on."""
        of, known, _ = self._known.get((number, sensor.name), (sensor, None, None))
        seen = saw.get(sensor.name, 0)
        if of.model is not sensor.model or of.pose != sensor.pose:
            return 2 if seen else 3, -seen
        return 0 if known is not None else 1 if seen else 3, -seen

    def _enough(self, rig: Rig, seen: Mapping[str, Flags]) -> Flags:
        """Whether the sensors that were asked are enough, whatever the others see."""
        criterion = self._requirement.criterion

        def met(members: Iterable[str]) -> Flags:
            counts, kinds = counted(rig, seen, criterion, list(members))
            enough = (counts >= criterion.sensors) & (kinds >= criterion.kinds)
            return np.asarray(enough.all(axis=1))

        enough = met(seen)
        for lost in seen if self._requirement.robust_to.one_lost else ():
            enough &= met(name for name in seen if name != lost)
        return enough

    def _seen(self, number: int, sensor: Sensor, which: Ints, saw: dict[str, int]) -> Flags:
        """Return the bodies (N, bodies * headings) that a sensor sees at some of the samples."""
        key = number, sensor.name
        of, known, seen = self._known.get(key, (sensor, None, None))
        if known is None or seen is None or of.model is not sensor.model or of.pose != sensor.pose:
            known = np.zeros(len(self.samples.points), bool)
            seen = np.zeros((len(known), len(columns_of(self._requirement))), bool)
        asked = which[~known[which]]
        if len(asked):
            seen[asked] = self._measured(number, sensor, asked)
            known[asked] = True
            saw[sensor.name] = saw.get(sensor.name, 0) + int(np.count_nonzero(seen[asked]))
        self._known[key] = sensor, known, seen
        return seen

    def _measured(self, number: int, sensor: Sensor, which: Ints) -> Flags:
        """Measure a sensor; cells of bodies only where the whole body is seen well enough."""
        own = self._requirement
        points = self.samples.points[which]
        if own.criterion.share is None:
            return self._checks(own, points).seen_by(number, sensor)
        whole = replace(own, criterion=replace(own.criterion, share=None))
        seen = self._checks(whole, points).seen_by(number, sensor)
        hit = np.flatnonzero(seen.any(axis=1))
        if len(hit):
            seen[hit] = self._checks(own, points[hit]).seen_by(number, sensor)
        return seen

    def _checks(self, requirement: Requirement, points: Floats) -> BodyChecks:
        samples = Samples(self.samples.zone, points, np.zeros(len(points)))
        return BodyChecks([(requirement, samples)], self._model, self._caches)


def boxes_of(requirement: Requirement) -> int:
    """Return how many boxes are measured at each sample."""
    with_cells = (False, True) if requirement.criterion.share is not None else (False,)
    boxes = sum(
        len(body.boxes(cells)[0]) * len(body.headings)
        for body in requirement.bodies
        for cells in with_cells
    )
    return boxes * levels_of(requirement)
