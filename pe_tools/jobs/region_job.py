"""The job that finds the free region of a sensor: coarse at once, then fine.

Places cover the sensor's mount, then gather where the loss crosses what is allowed: at the places
that are hardest to tell by their loss and its error (the "straddle" of Bryan et al. 2005). Between
places the loss is kriged. A base that was lucky on its sample would make all other places look
bad: some places are scored again on a larger sample, and all losses are moved by what that says.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import dist, sqrt
from typing import Any

import numpy as np

from pe_core.base.arrays import Flags, Floats
from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.values import Number, rounded
from pe_core.geometry.surfaces import area_of, divided
from pe_core.scene.rig import Rig
from pe_core.scoring.sampling import CENTERED, SEARCHED
from pe_core.scoring.score import SURE, standard_error
from pe_core.search import (
    DEFAULT_METHOD,
    KEPT,
    FeasibilityRule,
    Limit,
    MountArea,
    Objective,
    OwnPlace,
    OwnPlaces,
    SurfaceMount,
    Value,
    as_objective,
    evaluate_all,
    optimize,
)
from pe_core.search.figures import FIGURES, REQUIREMENTS
from pe_core.study.requirement_search import RequirementConstraint, constraints_of
from pe_core.study.study import Study

from ..advice import EDGE, FreeRegion, Kriging, Way, usual_loss
from .candidate_workers import ExecutorSource, candidate_workers
from .job import Job, Progress, ProgressSteps, begun
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
OTHERS = 12
OTHERS_EVALUATIONS = 150
SPREAD = 3
"""At how many places outside the others are searched again, how long each, and which: the first of
every so many, by their loss."""
COVER_SHARE = 0.4
"""Share of the places that cover the mount evenly; the others gather at the region's end."""
BATCH = 30
LENGTHS_M = (0.05, 0.1, 0.2, 0.4, 0.8)
LENGTHS_DEG = (1.0, 3.0, 10.0)
"""Ranges of kriging that are tried, over a surface and over an angle."""
NORMAL_M = 0.3
"""Places whose normals are perpendicular are as far apart as this over the root of 2 [m]."""
FINEST_M = 0.02
CORNERS = 20_000
"""Longest edge of the divided surface [m], unless it would have more triangles than that."""
POOL = 4000  # Corners among which the next places are chosen
NEIGHBOURS = 3
"""A corner is forbidden where one of so many nearest places is."""
STEP_M = 0.02
LENGTH_M = 1.0
"""How far apart a way along the surface is told, and how far it is looked along [m]."""
TURNS_DEG = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
FINE_DEG = 0.25
"""Angles that are evaluated both ways, and how finely the loss between them is told."""
ANGLES = ("yaw", "pitch", "roll")
PLACING = "placing"
LOSS = Number(0.0, above=True)


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
        self.row: PlaceFigure = PLACE_FIGURES[figure]
        usual = usual_loss(self.row.figure)
        self.allowed = LOSS.checked("region", "loss", usual if allowed is None else allowed)
        self.count = count or PLACES
        self._search_others = search_others
        self.found: FreeRegion | None = None
        self._waiting = Progress(PLACING, 0.0)

    @property
    def result(self) -> FreeRegion | None:
        """The region; None where the job was dropped, or stopped before the coarse one."""
        return None if self.dropped else self.found

    def __iter__(self) -> Iterator[Progress]:
        yield self._waiting
        self._held, not_held = held_now(self.study)
        study = self.study
        options: Any = {"limits": self._held.limits}
        options |= {"bounds": study.search.limits.get(self.sensor)}
        mounting = study.search.mounting
        self._places = OwnPlaces(study.rig, self.sensor, study.vehicle, mounting, **options)
        self._not_held = (*not_held, *self._places.broken)
        self._surface()
        constraints = constraints_of(self._held)
        row = self.row
        levels = (SAMPLES,) if row.exact else (COARSE_SAMPLES, SAMPLES)
        measures = [row.measured(study, samples, CENTERED) for samples in levels]
        objectives = [as_objective(each).under(constraints) for each in measures]
        models = {sensor.model.name: sensor.model for sensor in study.rig}.values()
        with candidate_workers(self, objectives, models) as workers:
            for level, objective in enumerate(objectives):
                is_last = level == len(levels) - 1
                evaluation = _Evaluation(measures[level], objective, workers, self.row)
                samples = levels[level]
                steps = self._level(evaluation, samples, is_last=is_last)
                region = yield from steps
                if region is None:
                    return
                self.found = region
                yield self._waiting
            if self._search_others and not self.stopped and len(region.faces):
                gain = yield from self._gain_of_others(objectives[-1], constraints, workers)
                if gain is not None:
                    self.found = region.with_gain(*gain)
        yield Progress("done", 1.0)

    def _gain_of_others(
        self, reported: Objective, constraints: Sequence[FeasibilityRule], workers: ExecutorSource
    ) -> ProgressSteps[tuple[Floats, Floats]]:
        """Search the other sensors again with this one at places outside, the nearest first. Return
        by how much the loss falls at each corner, and the error of that; None where the job ends
        before, or there is nothing to search."""
        study = self.study
        goals = study.search.goals
        fixed = tuple({*goals.fixed, self.sensor} - set(self._places.followers))
        outside = [own for own in self._with_loss if (own.place.value or 0.0) > self.allowed]
        outside.sort(key=lambda own: own.place.value or 0.0)
        chosen = outside[: SPREAD * OTHERS : SPREAD]
        searched = as_objective(self.row.measured(study, SAMPLES, SEARCHED)).under(constraints)
        gains: list[float] = []
        for number, own in enumerate(chosen):
            at_place = replace(study.search, goals=replace(goals, fixed=fixed))
            moved = replace(study, search=at_place).with_rig(own.rig)
            best = own.rig
            steps = optimize(
                searched,
                own.rig,
                moved.search_space(),
                study.search.seed,
                method=DEFAULT_METHOD,
                evaluations=OTHERS_EVALUATIONS,
                executor=workers,
            )
            for step in steps:
                best = step.best
                yield Progress("searching the others", (number + step.fraction) / len(chosen))
                if self.stopped:
                    return None
            value = reported.value(best)
            after = value.objective - self._base.objective if value.is_feasible else np.inf
            gains.append(max((own.place.value or 0.0) - self._offset_now - after, 0.0))
        if not gains:
            return None
        points = _featured([e.place.point for e in chosen], [e.place.normal for e in chosen])
        noise = np.full(len(gains), self._variance)
        kriging = Kriging.fit(points, np.array(gains), noise, LENGTHS_M)
        at, normals, _ = self._seen_by_places(self._corners, self._normals)
        gain, error = kriging.at(_featured(at, normals))
        return np.maximum(gain, 0.0), error

    def _surface(self) -> None:
        """Divide the mount's surface: its corners, faces, and points as kriging sees them."""
        surface = self._places.surface
        self._corners = np.empty((0, 3))
        self._faces = np.empty((0, 3), dtype=np.int64)
        self._normals = np.empty((0, 3))
        if surface is None:
            return
        own = surface.triangles[surface.faces]
        longest = max(FINEST_M, 2.0 * sqrt(area_of(own) / CORNERS))
        fine = divided(own, longest)
        flat = np.round(fine.reshape(-1, 3), 6) + 0.0
        self._corners, place = np.unique(flat, axis=0, return_inverse=True)
        self._faces = place.reshape(-1, 3)
        along = fine[:, 1:] - fine[:, :1]
        across = np.cross(along[:, 0], along[:, 1])
        sums = [
            np.bincount(place.reshape(-1), np.repeat(across[:, k], 3), len(self._corners))
            for k in range(3)
        ]
        normals = np.stack(sums, axis=1)
        size = np.sqrt((normals**2).sum(axis=1, keepdims=True))
        self._normals = normals / np.maximum(size, 1e-12)

    def _level(
        self, evaluation: "_Evaluation", samples: int, is_last: bool
    ) -> ProgressSteps[FreeRegion]:
        """Yield progress; return the region on one level, None where the job ends before."""
        self._evaluation = evaluation
        self._known: list[OwnPlace] = []
        self._values: list[Value] = []
        whole = COARSE if not is_last else self.count
        self._share = 0.1 if not is_last else 0.9
        self._begun = 0.0 if not is_last or self.row.exact else 0.1
        base = begun(lambda: evaluation.objective.value(self.study.rig))
        self._base = yield from self._awaited(base, lambda: self._waiting)
        if self._base is None:
            return None
        covered = whole if not is_last else max(int(COVER_SHARE * whole), 1)
        cover = begun(partial(self._places.covered, covered))
        places = yield from self._awaited(cover, lambda: self._waiting)
        for start in range(0, len(places or ()), BATCH):
            assert places is not None
            yield from self._evaluate(places[start : start + BATCH], whole)
        if self.stopped or places is None:
            return None
        surface = self._places.surface
        while is_last and surface is not None and len(self._known) < whole:
            choose = begun(partial(self._straddling, min(BATCH, whole - len(self._known))))
            chosen = yield from self._awaited(choose, lambda: self._waiting)
            if not chosen:
                break
            yield from self._evaluate(chosen, whole)
        if self.stopped:
            return self.found
        make = begun(partial(self._region, samples, is_last))
        return (yield from self._awaited(make, lambda: self._waiting))

    def _evaluate(self, places: Sequence[OwnPlace], whole: int) -> Iterator[Progress]:
        """Evaluate places that break no rule, and keep all; nothing once the job was stopped."""
        free = [each.rig for each in places if not each.place.reason]
        work = begun(partial(self._evaluation.values, free))
        values = yield from self._awaited(work, lambda: self._waiting)
        if values is None:
            return
        found = iter(values)
        for own in places:
            value = None if own.place.reason else next(found)
            place = own.place
            if value is not None and not value.is_feasible:
                place = replace(place, reason=self._evaluation.reason)
            elif value is not None:
                place = replace(place, value=rounded(value.objective - self._base.objective))
            self._known.append(OwnPlace(place, own.rig))
        fraction = self._begun + self._share * min(len(self._known) / whole, 1.0)
        self._waiting = Progress(PLACING, fraction)
        yield self._waiting

    def _losses(self) -> tuple[Floats, Floats]:
        """Return points (N, 6) with a loss as kriging sees them, and the losses (N,)."""
        known = [own.place for own in self._known if own.place.value is not None]
        points = _featured([p.point for p in known], [p.normal for p in known])
        return points, np.array([p.value for p in known])

    def _noise(self) -> float:
        """Return the variance of one place's value by its sample: half of the difference's."""
        own = [each for each in self._known if each.place.value is not None]
        step = max(len(own) // COMPARED, 1)
        return self._evaluation.noise(self.study.rig, [each.rig for each in own[::step]])

    def _straddling(self, count: int) -> list[OwnPlace]:
        """Return the next places: where loss and error leave open most whether it is allowed."""
        points, losses = self._losses()
        if not len(losses):
            return []
        if not hasattr(self, "_variance"):
            self._variance = self._noise()
        noise = np.full(len(losses), self._variance)
        kriging = Kriging.fit(points, losses, noise, LENGTHS_M)
        pool = np.arange(0, len(self._corners), max(len(self._corners) // POOL, 1))
        at, normals, barred = self._seen_by_places(self._corners[pool], self._normals[pool])
        loss, error = kriging.at(_featured(at, normals))
        open_to_doubt = SURE * error - np.abs(loss - self.allowed)
        open_to_doubt[barred] = -np.inf
        apart = 0.5 * sqrt(area_of(self._corners[self._faces]) / self.count)
        chosen: list[int] = []
        taken = [own.place.point for own in self._known]
        for k in np.argsort(-open_to_doubt, kind="stable").tolist():
            point = tuple(at[k].tolist())
            if len(chosen) == count or not np.isfinite(open_to_doubt[k]):
                break
            if all(dist(point, each) >= apart / 4.0 for each in taken):
                near = any(dist(point, at[j]) < apart for j in chosen)
                if not near:
                    chosen.append(k)
        surface = self._places.surface
        assert surface is not None
        found = []
        for k in chosen:
            foot, face = surface.closest(at[k])
            found.append(self._places.place(foot, face))
        return found

    def _seen_by_places(self, points: Floats, normals: Floats) -> tuple[Floats, Floats, Flags]:
        """Return points (M, 3), their normals turned as those of the nearest place, and whether one
        of the nearest places is forbidden."""
        known = np.array([own.place.point for own in self._known])
        own_normals = np.array([own.place.normal for own in self._known])
        is_forbidden = np.array([bool(own.place.reason) for own in self._known])
        square = (points**2).sum(axis=1)[:, None] + (known**2).sum(axis=1) - 2 * points @ known.T
        count = min(NEIGHBOURS, len(known))
        near = np.argpartition(square, count - 1, axis=1)[:, :count]
        nearest = square.argmin(axis=1)
        agree = (normals * own_normals[nearest]).sum(axis=1)
        turned = normals * np.where(agree < 0.0, -1.0, 1.0)[:, None]
        return points, turned, is_forbidden[near].any(axis=1)

    def _region(self, samples: int, is_last: bool) -> FreeRegion:
        """Return the region from what is known."""
        points, losses = self._losses()
        surface = self._places.surface
        mount = self._places.mount
        variance = self._variance = self._noise()
        sample = (
            ""
            if self.row.exact
            else f"{samples:,} {'voxels' if self.row.of_voxels else 'voxels of scenes'}"
        )
        region = FreeRegion(
            rig=self.study.rig,
            sensor=self.sensor,
            figure=self.row.figure.key,
            allowed=self.allowed,
            base=rounded(self.row.sign * self._base.objective),
            mount_name=self._places.mount_name,
            mount=mount if isinstance(mount, SurfaceMount) else None,
            corners=self._corners,
            faces=self._faces,
            loss=np.full(len(self._corners), np.inf),
            error=np.zeros(len(self._corners)),
            forbidden=np.zeros(len(self._corners), bool),
            places=tuple(own.place for own in self._known),
            ways=(),
            sample=sample,
            not_held=self._not_held,
            is_coarse=not is_last,
        )
        if surface is None or not len(losses):
            return region
        noise = np.full(len(losses), variance)
        kriging = Kriging.fit(points, losses, noise, LENGTHS_M)
        offset, offset_variance = 0.0, variance
        if is_last and not self.row.exact:
            offset, offset_variance = self._offset(kriging)
        roughness = max(float(kriging.noise.min()) - variance, 0.0)
        spread = offset_variance + roughness
        self._offset_now = offset
        losses = losses + offset
        foot = self._places.foot
        base = _featured([foot.point], [foot.normal])
        at_base = roughness + self._evaluation.least_noise
        kriging = Kriging.fit(
            np.concatenate([points, base]),
            np.append(losses, 0.0),
            np.append(noise, at_base),
            LENGTHS_M,
        )
        model = _LossModel(kriging, spread)
        at, normals, barred = self._seen_by_places(self._corners, self._normals)
        loss, error = model.at(_featured(at, normals))
        known = {
            own.place.point: rounded(value)
            for own, value in zip(self._with_loss, losses, strict=True)
        }
        places = tuple(replace(own.place, value=known.get(own.place.point)) for own in self._known)
        ways = tuple(self._along(model)) + (
            tuple(self._turns(offset, spread, variance)) if is_last else ()
        )
        return replace(region, loss=loss, error=error, forbidden=barred, places=places, ways=ways)

    @property
    def _with_loss(self) -> list[OwnPlace]:
        return [own for own in self._known if own.place.value is not None]

    def _offset(self, kriging: Kriging) -> tuple[float, float]:
        """Return by how much losses are too low for the base was lucky, and the variance of that:
        of places near the region's end, on a larger sample."""
        own = self._with_loss
        near = sorted(own, key=lambda each: abs(each.place.value - self.allowed))
        chosen = near[: 4 * CONFIRMED : 4]
        voxels = int(np.prod(self.study.space.shape))
        samples = 0 if voxels <= CONFIRMED_SAMPLES else CONFIRMED_SAMPLES
        larger = self.row.measured(self.study, samples, CENTERED)
        objective = as_objective(larger)
        rigs = [self.study.rig, *(each.rig for each in chosen)]
        base, *found = (value.objective for value in self._evaluation.by_workers(objective, rigs))
        smooth, _ = kriging.at(
            _featured([e.place.point for e in chosen], [e.place.normal for e in chosen])
        )
        off = np.array(found) - base - smooth
        scatter = float(np.var(off, ddof=1)) if len(off) > 1 else 0.0
        own_noise = self._noise_of(larger, rigs)
        self._evaluation.least_noise = own_noise
        return float(off.mean()), scatter / len(off) + own_noise

    def _noise_of(self, measure: Any, rigs: Sequence[Rig]) -> float:
        own, *others = measure.residuals(rigs)
        return float(np.mean([standard_error(each - own) ** 2 for each in others])) / 2.0

    def _along(self, model: "_LossModel") -> Iterator[Way]:
        """Yield the ways along the surface."""
        for name, direction in self._places.directions().items():
            path = [self._places.foot, *self._places.path(direction, STEP_M, LENGTH_M)]
            points = np.array([each.point for each in path])
            normals = np.array([each.normal for each in path])
            _, turned, barred = self._seen_by_places(points, normals)
            loss, error = model.at(_featured(points, turned))
            barred[0] = False
            first = int(barred.argmax()) if barred.any() else len(path)
            end = EDGE if len(path) - 1 < int(LENGTH_M / STEP_M) else ""
            if first < len(path):
                near = min(
                    (own.place for own in self._known if own.place.reason),
                    key=lambda place: dist(place.point, path[first].point),
                )
                end = near.reason
            upper = (loss + SURE * error)[:first]
            steps = np.array([each.distance for each in path])[:first]
            yield Way(name, "m", steps, upper, end)

    def _turns(self, offset: float, spread: float, variance: float) -> Iterator[Way]:
        """Yield the ways of turning."""
        for axis in ANGLES:
            signed = [*(-each for each in reversed(TURNS_DEG)), *TURNS_DEG]
            rigs = [self._places.turned(axis, float(np.radians(each))) for each in signed]
            reasons = [self._places.reason(rig) for rig in rigs]
            free = [k for k, reason in enumerate(reasons) if not reason]
            values = self._evaluation.values([rigs[k] for k in free])
            for k, value in zip(free, values, strict=True):
                if not value.is_feasible:
                    reasons[k] = self._evaluation.reason
            known = [
                (signed[k], value.objective - self._base.objective + offset)
                for k, value in zip(free, values, strict=True)
                if value.is_feasible
            ]
            points = np.array([0.0, *(angle for angle, _ in known)])[:, None]
            losses = np.array([0.0, *(loss for _, loss in known)])
            noise = np.array([self._evaluation.least_noise, *(variance for _ in known)])
            model = _LossModel(Kriging.fit(points, losses, noise, LENGTHS_DEG), spread)
            for sign in (1.0, -1.0):
                barred = [
                    abs(a) for a, why in zip(signed, reasons, strict=True) if why and a * sign > 0
                ]
                last = max(
                    (each for each in TURNS_DEG if each < min(barred, default=99.0)), default=0.0
                )
                end = (
                    ""
                    if not barred
                    else next(
                        why
                        for a, why in zip(signed, reasons, strict=True)
                        if why and a * sign == min(barred)
                    )
                )
                steps = np.arange(0.0, last + FINE_DEG / 2, FINE_DEG)
                loss, error = model.at(sign * steps[:, None])
                yield Way(
                    f"{axis} {'+' if sign > 0 else '-'}", "deg", steps, loss + SURE * error, end
                )


@dataclass(frozen=True, slots=True)
class _LossModel:
    """A kriged loss, and what its error has besides: the variance that all places share."""

    kriging: Kriging
    spread: float

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Return losses (M,) and their standard errors (M,)."""
        loss, error = self.kriging.at(points)
        return loss, np.sqrt(error**2 + self.spread)


class _Evaluation:
    """Evaluates rigs on one level, by workers."""

    reason = "a requirement or a limit"

    def __init__(
        self, measure: Any, objective: Objective, workers: ExecutorSource, row: PlaceFigure
    ) -> None:
        self._measure = measure
        self.objective = objective
        self._workers = workers
        self._row = row
        self.least_noise = 0.0

    def values(self, rigs: Sequence[Rig]) -> list[Value]:
        """Return the values of rigs: their figure, or a violation."""
        return self.by_workers(self.objective, rigs)

    def by_workers(self, objective: Objective, rigs: Sequence[Rig]) -> list[Value]:
        """Return the values of rigs for another objective."""
        return evaluate_all(objective, rigs, executor=self._workers())

    def noise(self, base: Rig, rigs: Sequence[Rig]) -> float:
        """Return the variance of one value by its sample: half of that of differences."""
        if self._row.exact or not rigs:
            return 0.0
        own, *others = self._measure.residuals([base, *rigs])
        return float(np.mean([standard_error(each - own) ** 2 for each in others])) / 2.0


def _featured(points: Any, normals: Any) -> Floats:
    """Return points (N, 6) as kriging sees them: positions, and normals by `NORMAL_M`."""
    return np.concatenate([np.asarray(points), NORMAL_M * np.asarray(normals)], axis=1)


def held_now(study: Study) -> tuple[Study, tuple[str, ...]]:
    """Return a study with those of its requirements and limits that its rig keeps, all of them
    kept by a search; and what it breaks, in words."""
    broken: list[str] = []
    limits = study.limits
    if study.requirements:
        off = RequirementConstraint(study).shortfalls(study.rig)
        broken += [r.name for r, lack in zip(study.requirements, off, strict=True) if lack]
        kept = [r for r, lack in zip(study.requirements, off, strict=True) if not lack]
        study = replace(study, requirements=tuple(kept))
        limits = limits.changed(**{REQUIREMENTS: Limit()})
    figures = study.key_figures() if any(key in KEPT for key, _ in limits) else None
    for key, limit in limits:
        if key not in KEPT or limit.value is None:
            continue
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
    """Return a study whose sensor is on the free region of it: the patch is its mount. `InputError`
    where the region has no area."""
    name = f"{found.sensor} region"
    area = region_mount(found)
    own = study.search.mounting
    mounting = replace(own, mounts={**own.mounts, name: area}, on={**own.on, found.sensor: name})
    return replace(study, search=replace(study.search, mounting=mounting))
