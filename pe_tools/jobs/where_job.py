"""The job that scores one more sensor all over a vehicle's surface, coarse to fine."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from math import dist, inf, sqrt
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.values import rounded
from pe_core.scene.rig import Rig, Sensor
from pe_core.scoring import RigEvaluator
from pe_core.scoring.sampling import CENTERED, SEARCHED, Shift
from pe_core.scoring.score import NO_DIFFERENCE, is_noise, standard_error
from pe_core.scoring.sight import Sight
from pe_core.search import (
    FIGURES,
    KEPT,
    Figure,
    MountingPlaces,
    Objective,
    RigView,
    SurfaceMount,
    SurfacePlace,
    as_objective,
    evaluate_all,
)
from pe_core.search.figures import BLIND_SECTOR, ENTROPY, REQUIREMENTS, TRAFFIC_AP
from pe_core.study.condition_table import search_evaluator
from pe_core.study.requirement_search import RequirementConstraint
from pe_core.study.study import DEFAULT_SEARCH_SAMPLES, EXPECTED_AP, Study
from pe_core.study.suggestion import with_free_name

from .candidate_workers import ExecutorSource, candidate_workers
from .job import Job, Progress, begun

SAMPLES = 2048  # Voxels on which places are scored
BATCH = 32
COMPARED = 8
"""Places that are scored between two looks at the progress; and that are scored on a larger sample,
too, from the best to the worst: they tell the error."""
BEST = 5
APART_M = 0.5
"""How many places are named as the best, and how far apart they are at least. They fit the sample
that they were chosen on: their changes are reported on the larger one."""
PlaceMeasure = RigEvaluator | Callable[[Rig], float]
SEEN_PLACES = 200  # As many as other figures of what a rig sees score in about 20 s
CONFIRMED = 40  # Places that are scored on the larger sample at most, until the best ones are


@dataclass(frozen=True, slots=True)
class _SeenFigure:
    """Minimises a figure that a rig's sight tells: it, or minus it where higher is better."""

    sight: Sight
    key: str

    def __call__(self, rig: Rig) -> float:
        """Return the value of a rig; inf where it is not known."""
        row = FIGURES[self.key]
        value = row.worst(row.values(RigView(self.sight, rig)))
        return inf if value is None else row.signed(value)


@dataclass(frozen=True, slots=True)
class _NotMet:
    """Minimises minus the number of requirements met."""

    of: RequirementConstraint

    def __call__(self, rig: Rig) -> float:
        """Return the value of a rig."""
        return -float(sum(not off for off in self.of.shortfalls(rig)))


def _by_entropy(study: Study, samples: int, shift: Shift) -> PlaceMeasure:
    return study.evaluator(samples, shift=shift)


def _by_ap(study: Study, samples: int, shift: Shift) -> PlaceMeasure:
    by_ap = replace(study, search=replace(study.search, objective=EXPECTED_AP))
    return search_evaluator(by_ap, samples, shift=shift)


def _seen(key: str) -> Callable[[Study, int, Shift], PlaceMeasure]:
    def measured(study: Study, _samples: int, _shift: Shift) -> PlaceMeasure:
        return _SeenFigure(study.sight(), key)

    return measured


def _met(study: Study, _samples: int, _shift: Shift) -> PlaceMeasure:
    if study.requirements:
        return _NotMet(RequirementConstraint(study))
    raise InputError("where", "requirements", "at least one, to count verdicts", "none")


@dataclass(frozen=True, slots=True)
class PlaceFigure:
    """A row of `FIGURES` by which places are compared. `measured` returns what is minimised, of a
    study, a number of voxels and their shift: the figure, or minus it where higher is better.
    `places` is how many are scored in about 20 s. `exact` is whether it does not depend on a
    sample, `of_voxels` whether that sample is one of voxels."""

    figure: Figure
    measured: Callable[[Study, int, Shift], PlaceMeasure]
    places: int
    exact: bool = False
    of_voxels: bool = False

    @property
    def sign(self) -> float:
        """The figure is so many times the value that is minimised."""
        return self.figure.signed(1.0)

    def change(self, by: float) -> str:
        """Return a difference with its sign and its unit."""
        return f"{by:+.{self.figure.decimals}f} {self.figure.unit}".strip()


PLACE_FIGURES = {
    row.figure.key: row
    for row in (
        PlaceFigure(FIGURES[ENTROPY], _by_entropy, places=2000, of_voxels=True),
        PlaceFigure(FIGURES[TRAFFIC_AP], _by_ap, places=600),
        PlaceFigure(FIGURES[BLIND_SECTOR], _seen(BLIND_SECTOR), places=350, exact=True),
        PlaceFigure(FIGURES[REQUIREMENTS], _met, places=700, exact=True),
        *(
            PlaceFigure(FIGURES[key], _seen(key), places=SEEN_PLACES, exact=True)
            for key in KEPT
            if key not in (BLIND_SECTOR, TRAFFIC_AP)
        ),
    )
}  # Figures of places, by name


@dataclass(frozen=True, slots=True)
class PlaceMap:
    """Places of one more sensor, the coarse cover of the surface first. `rig`, `sensor`: the other
    sensors, and the placed one: its model and its name. `figure`: A key of `PLACE_FIGURES`.
    `mount`: name of the mount that is covered; empty for the body or parts of it. `count`: how many
    places there will be. `surface` (F, 3, 3): the surface that they cover [m]. `base`: the figure
    without the sensor. `error`: standard error of a change on that sample, of
    places from the best to the worst: by its batches, or by what a larger sample says where that is
    more; None where it is not known yet, 0 where places are scored exactly. Then `base` and the
    best places have the values of the larger sample, that of the study's scores."""

    rig: Rig
    sensor: Sensor
    figure: str
    mount: str
    count: int
    surface: Floats = field(repr=False, compare=False)
    base: float
    places: tuple[SurfacePlace, ...]
    error: float | None

    @property
    def row(self) -> PlaceFigure:
        """How the figure is read."""
        return PLACE_FIGURES[self.figure]

    def best(self, count: int = 1, apart: float = 0.0) -> list[SurfacePlace]:
        """Return the best places, the best first; those that break a rule are left out. Of places
        that are nearer to each other than `apart` [m] only the best is named."""
        free = [each for each in self.places if each.value is not None]
        found: list[SurfacePlace] = []
        for each in sorted(free, key=lambda each: self.row.sign * (each.value or 0.0)):
            if len(found) < count and all(dist(each.point, o.point) >= apart for o in found):
                found.append(each)
        return found

    def reasons(self) -> dict[str, int]:
        """Return how many places break a rule first, by rule, the most frequent first."""
        texts = [each.reason for each in self.places if each.reason]
        return {t: texts.count(t) for t in sorted(set(texts), key=lambda t: (-texts.count(t), t))}

    def change(self, value: float) -> str:
        """Return by how much a place changes the figure; within its standard error no difference
        is shown."""
        by = value - self.base
        return NO_DIFFERENCE if self.error and is_noise(by, self.error) else self.row.change(by)

    def text(self, value: float) -> str:
        """Return the figure of a place, with its change and how sure that is."""
        sure = f" ± {self.row.figure.text(self.error)}" if self.error else ""
        change = self.change(value)
        sample = f", on {SAMPLES:,} voxels" if self.row.of_voxels else ""
        return f"{self.row.figure.label} {self.row.figure.text(value)} ({change}{sure}{sample})"

    def rows(self) -> list[dict[str, Any]]:
        """Return the places as flat tables."""
        axes = (*"xyz", "normal_x", "normal_y", "normal_z", "sensor_x", "sensor_y", "sensor_z")
        names = (*axes, "roll_deg", "pitch_deg", "yaw_deg")
        rows = []
        for place in self.places:
            pose = *place.pose.position, *place.pose.rotation_deg
            row = dict(zip(names, (*place.point, *place.normal, *pose), strict=True))
            change = None if place.value is None else rounded(place.value - self.base)
            row |= {"value": place.value, "change": change, "forbidden_by": place.reason}
            rows.append(row)
        return rows

    def to_dict(self) -> dict[str, Any]:
        """Return the map as plain JSON data."""
        own = {"figure": self.figure, "base": self.base, "error": self.error}
        return {"model": self.sensor.model.name, **own, "places": self.rows()}


class WhereJob(Job):
    """Scores a rig with one more sensor at places all over the surface. `InputError` when there is
    no such figure or mount; once it runs, as `MountingPlaces`. `study`: its other sensors stay as
    they are; its constraints forbid places. `sensor`, `parts`, `mount`, `count`: as of
    `MountingPlaces`; `mount` is the name of one of the study's. By default there are as many places
    as the figure scores in about 20 s. `figure`: A key of `PLACE_FIGURES`. `workers`: number of
    processes; all processors by default. The result does not depend on it."""

    shown = ("places", "base", "error", "surface")

    def __init__(
        self,
        study: Study,
        sensor: Sensor,
        figure: str = "entropy",
        *,
        parts: tuple[str, ...] = (),
        mount: str = "",
        count: int | None = None,
        workers: int | None = None,
    ) -> None:
        super().__init__(study, workers)
        every = study.search.mounting.mounts
        mounts = [name for name, each in every.items() if isinstance(each, SurfaceMount)]
        if figure not in PLACE_FIGURES:
            raise InputError("where", "figure", one_of(PLACE_FIGURES, figure), shown(figure))
        if mount and mount not in mounts:
            expected = one_of(mounts, mount) if mounts else "a study with a mount on a surface"
            raise InputError("where", "mount", expected, shown(mount))
        self.sensor = with_free_name(study, sensor)
        self.figure = figure
        self._parts = parts
        self._mount = mount
        self.count = self.row.places if count is None else count
        self.places: list[SurfacePlace] = []
        self.base: float = 0.0
        self.error: float | None = None
        self._moved_by = 0.0
        self.surface = np.empty((0, 3, 3))
        self._waiting = Progress("placing", 0.0)

    @property
    def row(self) -> PlaceFigure:
        """The figure by which places are compared."""
        return PLACE_FIGURES[self.figure]

    @property
    def found(self) -> PlaceMap | None:
        """What is known so far; None before the first place, and where the job was dropped."""
        if self.dropped or not self.places:
            return None
        return PlaceMap(
            rig=self.study.rig,
            sensor=self.sensor,
            figure=self.figure,
            mount=self._mount,
            count=self.count,
            surface=self.surface,
            base=self.base,
            places=tuple(self.places),
            error=self.error,
        )

    def __iter__(self) -> Iterator[Progress]:
        row = self.row
        study = self.study
        yield self._waiting
        mount: Any = study.search.mounting.mounts.get(self._mount)
        own: Any = {"parts": self._parts, "mount": mount, "count": self.count}
        self._places = MountingPlaces(
            study.rig,
            self.sensor,
            study.vehicle,
            study.search.mounting.constraints,
            limits=study.limits,
            **own,
        )
        self.surface = self._places.surface.triangles
        measured = row.measured(study, SAMPLES, SEARCHED)
        objective = as_objective(measured)
        self.base = rounded(row.sign * objective.figure(study.rig))
        steps = iter(self._places)
        ahead = begun(lambda: list(islice(steps, BATCH)))
        with candidate_workers(self, [objective], [self.sensor.model]) as workers:
            while some := (yield from self._awaited(ahead, lambda: self._waiting)):
                ahead = begun(lambda: list(islice(steps, BATCH)))  # while these are scored
                work = begun(partial(self._scored, some, objective, workers))
                if (batch := (yield from self._awaited(work, lambda: self._waiting))) is None:
                    break
                self.places += batch
                self._waiting = Progress("placing", len(self.places) / self.count)
                yield self._waiting
            if not self.stopped:
                last = begun(partial(self._error, measured))
                self.error = yield from self._awaited(last, lambda: self._waiting)
        yield Progress("done", 1.0)

    def _scored(
        self, some: list[SurfacePlace], objective: Objective, workers: ExecutorSource
    ) -> list[SurfacePlace]:
        rigs = [self._places.with_sensor(each.pose) for each in some if not each.reason]
        found = evaluate_all(objective, rigs, executor=workers())
        sign = self.row.sign
        values = iter([rounded(sign * each.objective) for each in found])
        return [each if each.reason else replace(each, value=next(values)) for each in some]

    def _error(self, sampled: Any) -> float:
        """Return the standard error of the changes on the sample (`PlaceMap.error`), which
        `sampled` evaluates."""
        row = self.row
        ranked = [] if self.found is None else self.found.best(len(self.places))
        if row.exact or not ranked:
            return 0.0
        steps = np.linspace(0, len(ranked) - 1, COMPARED).astype(int)
        compared = [ranked[k] for k in np.unique(steps).tolist()]
        rigs = [self._places.with_sensor(place.pose) for place in compared]
        own, *by_place = sampled.residuals([self.study.rig, *rigs])
        errors = [standard_error(each - own) for each in by_place]
        samples = self.study.samples or DEFAULT_SEARCH_SAMPLES
        larger = as_objective(row.measured(self.study, samples, CENTERED))
        self._move_to(rounded(row.sign * larger.figure(self.study.rig)))
        off = [
            (place.value or 0.0) + self._moved_by - row.sign * larger.figure(rig)
            for place, rig in zip(compared, rigs, strict=True)
        ]
        self._confirm_best(larger)
        return rounded(max(_root_mean_square(errors), _root_mean_square(off)))

    def _move_to(self, base: float) -> None:
        """Have the figure without the sensor on the larger sample, and move all values along: their
        changes stay."""
        self._moved_by = base - self.base
        self.base = base
        for at, place in enumerate(self.places):
            if place.value is not None:
                self.places[at] = replace(place, value=rounded(place.value + self._moved_by))

    def _confirm_best(self, larger: Objective) -> None:
        """Give the best places their values on the larger sample: until those that are best have
        them, as a place may fall behind another."""
        done = set[tuple[float, ...]]()
        for _ in range(CONFIRMED):
            best = () if self.found is None else self.found.best(BEST, APART_M)
            place = next((each for each in best if each.point not in done), None)
            if place is None:
                return
            done.add(place.point)
            value = self.row.sign * larger.figure(self._places.with_sensor(place.pose))
            at = self.places.index(place)
            self.places[at] = replace(place, value=rounded(value))


def _root_mean_square(values: Sequence[float]) -> float:
    return sqrt(float(np.mean(np.square(values))))
