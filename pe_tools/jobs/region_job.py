"""The job that finds the free region of a sensor: coarse at once, then fine.

Places cover the sensor's mount, then gather where the loss crosses what is allowed: at the places
that are hardest to tell by their loss and its error (the "straddle" of Bryan et al. 2005). Between
places the loss is kriged. A base that was lucky on its sample would make all other places look
bad: some places are scored again on a larger sample, and all losses are moved by what that says.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.values import Number, rounded
from pe_core.scene.rig import Rig
from pe_core.scoring.sampling import CENTERED, SEARCHED
from pe_core.scoring.score import standard_error
from pe_core.search import (
    DEFAULT_METHOD,
    KEPT,
    Limit,
    MountArea,
    Objective,
    OwnPlaces,
    PlacedRig,
    SurfaceMount,
    Value,
    as_objective,
    evaluate_all,
    optimize,
)
from pe_core.search.figures import FIGURES, REQUIREMENTS
from pe_core.study.requirement_search import RequirementConstraint, constraints_of
from pe_core.study.study import Study

from ..advice import FreeRegion, Kriging, Way, usual_loss
from .candidate_workers import ExecutorSource, candidate_workers
from .job import Job, Progress, ProgressSteps, begun
from .region_model import (
    LENGTHS_DEG,
    LENGTHS_M,
    LossModel,
    MountCorners,
    at_known,
    featured,
    features_of,
    hardest_to_tell,
    ways_along,
    ways_of_turn,
)
from .where_job import PLACE_FIGURES, PlaceFigure

COARSE_SAMPLES = 4096
SAMPLES = 32_768
CONFIRMED_SAMPLES = 262_144
"""Voxels of the coarse places, of all others, and of those that tell how lucky the base was: all of
a space that has fewer."""
COARSE = 40
PLACES = 300
CONFIRMED = 8
COMPARED = 8
"""How many places each has, and how many tell the error of all."""
COARSE_SHARE = 0.1  # About which share of the time the coarse places take
OTHERS = 12
OTHERS_EVALUATIONS = 150
SPREAD = 3
"""At how many places outside the others are searched again, how long each, and which: the first of
every so many, by their loss; of fewer where there are few."""
CLOSE = 4  # Of the places nearest to the allowed loss, each so many is confirmed
COVER_SHARE = 0.4
"""Share of the places that cover the mount evenly; the others gather at the region's end."""
BATCH = 30
TURNS_DEG = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Angles that are evaluated, both ways."""
ANGLES = ("yaw", "pitch", "roll")
PLACING = "placing"
BY_LIMIT = "a requirement or a limit"
LOSS = Number(0.0, above=True)


def region_places(study: Study, sensor: str) -> OwnPlaces:
    """Return the places of which a free region is a part: on the mount of a sensor, else over the
    body."""
    return OwnPlaces(
        study.rig,
        sensor,
        study.vehicle,
        study.search.mounting,
        limits=study.limits,
        bounds=study.search.limits.get(sensor),
    )


class RegionJob(Job):
    """Finds the free region of a sensor (`FreeRegion`). `InputError` when there is no such figure
    or sensor; once it runs, as `OwnPlaces`.

    Parameters
    ----------
    study : Study
        Its other sensors stay, but for those that follow this one. All its requirements and limits
        that it keeps now forbid places that break them.
    sensor : str
    figure : str
        A key of `PLACE_FIGURES`.
    allowed : float, optional
        How much the figure may lose, in its own unit; by default `usual_loss`.
    count : int, optional
        How many places are evaluated; by default as many as take about 20 s.
    search_others : bool
        Whether the other sensors are searched again at `OTHERS` places outside, which takes
        minutes: the region is then where the rig could be as good again.
    """

    shown = ("found",)

    def __init__(
        self,
        study: Study,
        sensor: str,
        figure: str = "entropy",
        *,
        allowed: float | None = None,
        count: int | None = None,
        search_others: bool = False,
        workers: int | None = None,
    ) -> None:
        super().__init__(study, workers)
        if figure not in PLACE_FIGURES:
            raise InputError("region", "figure", one_of(PLACE_FIGURES, figure), shown(figure))
        names = [each.name for each in study.rig]
        if sensor not in names:
            raise InputError("region", "sensor", one_of(names, sensor), shown(sensor))
        self.sensor = sensor
        self.figure = figure
        usual = usual_loss(self.row.figure)
        self.allowed = LOSS.checked("region", "loss", usual if allowed is None else allowed)
        self.count = count or PLACES
        self._search_others = search_others
        self.found: FreeRegion | None = None
        self._waiting = Progress(PLACING, 0.0)

    @property
    def row(self) -> PlaceFigure:
        """How the figure is measured; by its name, as a job is sent to another process."""
        return PLACE_FIGURES[self.figure]

    @property
    def result(self) -> FreeRegion | None:
        """The region; None where the job was dropped, or stopped before the coarse one."""
        return None if self.dropped else self.found

    def __iter__(self) -> Iterator[Progress]:
        yield self._waiting
        study = self.study
        held, not_held = held_now(study)
        self._places = region_places(held, self.sensor)
        self._not_held = (*not_held, *self._places.broken)
        self._mount = MountCorners.of(self._places)
        self._constraints = constraints_of(held)
        levels = (SAMPLES,) if self.row.exact else (COARSE_SAMPLES, SAMPLES)
        measures = [self.row.measured(study, samples, CENTERED) for samples in levels]
        objectives = [as_objective(each).under(self._constraints) for each in measures]
        with candidate_workers(self, self._evaluated(objectives)) as workers:
            for number, samples in enumerate(levels):
                is_last = number == len(levels) - 1
                level = _Level(self, measures[number], objectives[number], workers, samples=samples)
                region = yield from self._region_on(level, is_last=is_last)
                if region is None:
                    return
                self.found = region
                yield self._waiting
            if self._search_others and not self.stopped and len(self._mount.faces):
                estimate = yield from self._gain_of_others(level)
                if estimate is not None and self.found is not None:
                    gain, error = estimate
                    self.found = self.found.with_gain(gain, error)
        yield Progress("done", 1.0)

    def _evaluated(self, objectives: Sequence[Objective]) -> Iterator[Objective]:
        """Yield what workers will evaluate, on all levels and after them."""
        yield from objectives
        if not self.row.exact:
            yield self._confirming
        if self._search_others:
            yield self._searching

    @cached_property
    def _larger(self) -> Any:
        """What measures the figure on the sample that tells how far off the region's losses are."""
        is_small = int(np.prod(self.study.space.shape)) <= CONFIRMED_SAMPLES
        samples = 0 if is_small else CONFIRMED_SAMPLES
        return self.row.measured(self.study, samples, CENTERED)

    @cached_property
    def _confirming(self) -> Objective:
        return as_objective(self._larger)

    @cached_property
    def _searching(self) -> Objective:
        """What the search of the other sensors minimises."""
        measured = self.row.measured(self.study, SAMPLES, SEARCHED)
        return as_objective(measured).under(self._constraints)

    def _region_on(self, level: "_Level", is_last: bool) -> ProgressSteps[FreeRegion]:
        """Yield progress; return the region on one level, None where the job ends before."""
        whole = self.count if is_last else COARSE
        shares = (COARSE_SHARE, 1.0 - COARSE_SHARE) if is_last else (0.0, COARSE_SHARE)
        if self.row.exact:
            shares = (0.0, 1.0)
        self._shares = shares
        base = begun(lambda: level.objective.value(self.study.rig))
        value = yield from self._awaited(base, lambda: self._waiting)
        if value is None:
            return None
        level.base = value.objective
        covered = max(int(COVER_SHARE * whole), 1) if is_last else whole
        cover = begun(partial(self._places.covered, covered))
        places = yield from self._awaited(cover, lambda: self._waiting)
        for start in range(0, len(places or ()), BATCH):
            yield from self._evaluate(level, (places or [])[start : start + BATCH], whole)
        most = len(level.known) + whole  # rules may forbid all that are chosen
        while (
            is_last and len(self._mount.faces) and level.scored < whole and len(level.known) < most
        ):
            choose = begun(partial(self._next_places, level, whole))
            chosen = yield from self._awaited(choose, lambda: self._waiting)
            if not chosen:
                break
            yield from self._evaluate(level, chosen, whole)
        if self.stopped:
            return self.found
        make = begun(partial(self._region, level, is_last))
        return (yield from self._awaited(make, lambda: self._waiting))

    def _evaluate(
        self, level: "_Level", places: Sequence[PlacedRig], whole: int
    ) -> Iterator[Progress]:
        """Evaluate places, and have the level know them; nothing once the job was stopped."""
        work = begun(partial(level.evaluated, places))
        found = yield from self._awaited(work, lambda: self._waiting)
        level.known += found or []
        level.scored += sum(not each.place.reason for each in places)
        begin, share = self._shares
        done = min(level.scored / whole, 1.0)
        self._waiting = Progress(PLACING, begin + share * done)
        yield self._waiting

    def _next_places(self, level: "_Level", whole: int) -> list[PlacedRig]:
        """Return the next places: those that are hardest to tell."""
        if len(level.with_loss) < 2:
            return []
        corners = hardest_to_tell(
            level.kriging(),
            self._mount,
            level.known,
            self.allowed,
            count=min(BATCH, whole - level.scored),
            whole=whole,
        )
        surface = self._places.surface
        assert surface is not None  # a list of slots has no corners
        return [self._places.place(*surface.closest(corner)) for corner in corners]

    def _region(self, level: "_Level", is_last: bool) -> FreeRegion:
        """Return the region from what a level knows."""
        mount = self._places.mount
        count = len(self._mount.corners)
        unit = "voxels" if self.row.of_voxels else "voxels' share of scenes"
        region = FreeRegion(
            rig=self.study.rig,
            sensor=self.sensor,
            figure=self.row.figure.key,
            allowed=self.allowed,
            base=rounded(self.row.sign * level.base),
            mount_name=self._places.mount_name,
            mount=mount if isinstance(mount, SurfaceMount) else None,
            corners=self._mount.corners,
            faces=self._mount.faces,
            loss=np.full(count, np.inf),
            error=np.zeros(count),
            forbidden=np.zeros(count, bool),
            places=tuple(each.place for each in level.known),
            ways=(),
            sample="" if self.row.exact else f"{level.samples:,} {unit}",
            not_held=self._not_held,
            is_coarse=not is_last,
            foot=None if self._places.surface is None else self._places.foot.point,
        )
        if not count or len(level.with_loss) < 2:
            return region
        offset, spread = self._offset(level, is_last)
        foot = self._places.foot
        points = np.concatenate([level.points, featured([foot.point], [foot.normal])])
        losses = np.append(level.losses + offset, 0.0)
        roughness = max(spread - level.shared_noise, 0.0)
        noise = np.append(np.full(len(losses) - 1, level.noise), roughness)
        model = LossModel(Kriging.fit(points, losses, noise, LENGTHS_M), spread)
        at, forbidden = at_known(level.known, self._mount.corners, self._mount.normals)
        loss, error = model.at(at)
        places = (
            each.place if each.place.value is None else level.moved(each.place, offset)
            for each in level.known
        )
        ways = [*ways_along(model, self._places, level.known)]
        if is_last:
            ways += self._turns(level, offset, spread)
        return replace(
            region,
            loss=loss,
            error=error,
            forbidden=forbidden > 0.0,
            places=tuple(places),
            ways=tuple(ways),
        )

    def _offset(self, level: "_Level", is_last: bool) -> tuple[float, float]:
        """Return by how much losses are too low as the base was lucky, and the variance that all
        losses share: of the base, and of what is rougher than the noise."""
        kriging = level.kriging()
        rough = max(float(kriging.noise.min()) - level.noise, 0.0)
        level.shared_noise = level.noise
        if self.row.exact or not is_last:
            return 0.0, level.shared_noise + rough
        close = sorted(
            level.with_loss, key=lambda each: abs((each.place.value or 0.0) - self.allowed)
        )
        chosen = close[: CLOSE * CONFIRMED : CLOSE]
        rigs = [self.study.rig, *(each.rig for each in chosen)]
        base, *values = level.values(self._confirming, rigs)
        smooth, _ = kriging.at(features_of(chosen))
        off = np.array([value.objective - base.objective for value in values]) - smooth
        scatter = float(np.var(off, ddof=1)) if len(off) > 1 else 0.0
        level.shared_noise = scatter / len(off) + paired_noise(self._larger, rigs)
        return float(off.mean()), level.shared_noise + rough

    def _turns(self, level: "_Level", offset: float, spread: float) -> Iterator[Way]:
        """Yield the ways of turning about each axis of the mount's frame."""
        signed = [*(-each for each in reversed(TURNS_DEG)), *TURNS_DEG]
        for axis in ANGLES:
            rigs = [self._places.turned(axis, float(np.radians(each))) for each in signed]
            barred = {
                angle: reason
                for angle, rig in zip(signed, rigs, strict=True)
                if (reason := self._places.reason(rig))
            }
            free = [angle for angle in signed if angle not in barred]
            values = level.values(
                level.objective,
                [rig for angle, rig in zip(signed, rigs, strict=True) if angle not in barred],
            )
            losses = {0.0: 0.0}
            for angle, value in zip(free, values, strict=True):
                if value.is_feasible:
                    losses[angle] = value.objective - level.base + offset
                else:
                    barred[angle] = BY_LIMIT
            noise = np.array([level.noise if angle else 0.0 for angle in losses])
            points = np.array([*losses])[:, None]
            kriging = Kriging.fit(points, np.array([*losses.values()]), noise, LENGTHS_DEG)
            yield from ways_of_turn(LossModel(kriging, spread), axis, barred, TURNS_DEG[-1])

    def _gain_of_others(self, level: "_Level") -> ProgressSteps[tuple[Floats, Floats]]:
        """Search the other sensors again with this one at places outside, the nearest first. Return
        by how much the loss falls at each corner, and the error of that; None where the job ends
        before, or there is nothing to search."""
        study = self.study
        goals = study.search.goals
        fixed = tuple({*goals.fixed, self.sensor} - set(self._places.followers))
        held = replace(study, search=replace(study.search, goals=replace(goals, fixed=fixed)))
        outside = [each for each in level.with_loss if (each.place.value or 0.0) > self.allowed]
        outside.sort(key=lambda each: each.place.value or 0.0)
        spread = min(max(len(outside) // OTHERS, 1), SPREAD)
        chosen = outside[: spread * OTHERS : spread]
        gains: list[float] = []
        for number, placed in enumerate(chosen):
            best = placed.rig
            for step in optimize(
                self._searching,
                placed.rig,
                held.with_rig(placed.rig).search_space(),
                study.search.seed,
                method=DEFAULT_METHOD,
                evaluations=OTHERS_EVALUATIONS,
                executor=level.workers,
            ):
                best = step.best
                yield Progress("searching the others", (number + step.fraction) / len(chosen))
                if self.stopped:
                    return None
            value = level.objective.value(best)
            lost = value.objective - level.base if value.is_feasible else np.inf
            gains.append(max((placed.place.value or 0.0) - lost, 0.0))
        if len(gains) < 2:
            return None
        noise = np.full(len(gains), level.noise)
        kriging = Kriging.fit(features_of(chosen), np.array(gains), noise, LENGTHS_M)
        at, _ = at_known(level.known, self._mount.corners, self._mount.normals)
        gain, error = kriging.at(at)
        return np.maximum(gain, 0.0), error


class _Level:
    """What is known on one number of voxels. `base` is the value of the rig as it is, `scored` how
    many places were: rules forbid the others."""

    def __init__(
        self,
        job: RegionJob,
        measure: Any,
        objective: Objective,
        workers: ExecutorSource,
        samples: int,
    ) -> None:
        self.objective = objective
        self.workers = workers
        self.samples = samples
        self.base = 0.0
        self.known: list[PlacedRig] = []
        self.scored = 0
        self.shared_noise = 0.0
        self._rig = job.study.rig
        self._exact = job.row.exact
        self._measure = measure
        self._noise: float | None = None

    @property
    def with_loss(self) -> list[PlacedRig]:
        """The places whose loss is known."""
        return [each for each in self.known if each.place.value is not None]

    @property
    def points(self) -> Floats:
        """(N, 6) The places whose loss is known, as kriging sees them."""
        return features_of(self.with_loss)

    @property
    def losses(self) -> Floats:
        """(N,) Their losses."""
        return np.array([each.place.value for each in self.with_loss])

    @property
    def noise(self) -> float:
        """The variance of one place's value by its sample: half of that of differences."""
        if self._noise is None:
            own = self.with_loss
            some = [each.rig for each in own[:: max(len(own) // COMPARED, 1)]]
            exact = self._exact or not some
            self._noise = 0.0 if exact else paired_noise(self._measure, [self._rig, *some])
        return self._noise

    def kriging(self) -> Kriging:
        """Return the losses between the places."""
        noise = np.full(len(self.losses), self.noise)
        return Kriging.fit(self.points, self.losses, noise, LENGTHS_M)

    def values(self, objective: Objective, rigs: Sequence[Rig]) -> list[Value]:
        """Return the values of rigs, which workers evaluate."""
        return evaluate_all(objective, rigs, executor=self.workers())

    def evaluated(self, places: Sequence[PlacedRig]) -> list[PlacedRig]:
        """Return places with their losses; where a limit is broken, with that as the reason."""
        free = [each.rig for each in places if not each.place.reason]
        values = iter(self.values(self.objective, free))
        return [each if each.place.reason else self._told(each, next(values)) for each in places]

    def _told(self, placed: PlacedRig, value: Value) -> PlacedRig:
        if not value.is_feasible:
            return placed._replace(place=replace(placed.place, reason=BY_LIMIT))
        loss = rounded(value.objective - self.base)
        return placed._replace(place=replace(placed.place, value=loss))

    @staticmethod
    def moved(place: Any, offset: float) -> Any:
        """Return a place whose loss is moved by an offset."""
        return replace(place, value=rounded(place.value + offset))


def paired_noise(measure: Any, rigs: Sequence[Rig]) -> float:
    """Return the variance of one rig's value by the sample of an evaluator: half of the mean square
    of the standard errors of differences from the first one."""
    own, *others = measure.residuals(rigs)
    return float(np.mean([standard_error(each - own) ** 2 for each in others])) / 2.0


def held_now(study: Study) -> tuple[Study, tuple[str, ...]]:
    """Return a study with those of its requirements and limits that its rig keeps, all of them
    kept by a search; and what it breaks, in words. Limits without a number on what a rig sees are
    left out: no worse than now in every figure would leave no place but this one."""
    broken: list[str] = []
    limits = study.limits
    if study.requirements:
        off = RequirementConstraint(study).shortfalls(study.rig)
        both = [*zip(study.requirements, off, strict=True)]
        broken += [requirement.name for requirement, lack in both if lack]
        kept = tuple(requirement for requirement, lack in both if not lack)
        study = replace(study, requirements=kept)
        limits = limits.changed(**{REQUIREMENTS: Limit()})
    seen = [(key, limit) for key, limit in limits if key in KEPT]
    limits = limits.changed(**{key: None for key, limit in seen if limit.value is None})
    numbered = [(key, limit) for key, limit in seen if limit.value is not None]
    figures = study.key_figures() if numbered else None
    for key, limit in numbered:
        assert limit.value is not None
        value = FIGURES[key].value(figures)
        if value is not None and FIGURES[key].is_met(value, limit.value):
            limits = limits.changed(**{key: replace(limit, kept=True)})
        else:
            limits = limits.changed(**{key: None})
            broken.append(f"limits.{key}")
    return replace(study, limits=limits), tuple(broken)


def region_mount(found: FreeRegion) -> SurfaceMount:
    """Return the mount that a free region is: its patch, with stand-off and orientation of the
    sensor's mount. `InputError` where the region has no area."""
    if found.mount is None or not len(found.patch):
        raise InputError("region", "patch", "a region with an area", "none")
    return replace(found.mount, parts=(), area=MountArea(found.patch))


def study_on_region(study: Study, found: FreeRegion) -> Study:
    """Return a study whose sensor is on the free region of it: the patch is its mount. A sensor
    that is just outside, as a region errs to the safe side, is moved onto it. `InputError` where
    the region has no area."""
    name = f"{found.sensor} region"
    area = region_mount(found)
    own = study.search.mounting
    mounting = replace(own, mounts={**own.mounts, name: area}, on={**own.on, found.sensor: name})
    return replace(study, search=replace(study.search, mounting=mounting)).on_mounts()
