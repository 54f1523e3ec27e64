"""What would fix it: the smallest move of a sensor, or one more sensor.

For each requirement that is not met, `suggestions` looks for the nearest placement that meets it.
One design variable of the search is changed at a time, by small steps first; then one sensor (or
linked pair) is put elsewhere within its range, the nearest places first. What is enough is made
smaller as long as it stays enough, to `FINEST_STEP`. `repairs` looks for one
more sensor, too, of the models that the rig has: it stands all over the vehicle's surface, not too
low and hardly occluded, and looks to where the requirement fails. `with_blind_spot` makes a
requirement of a place on the ground.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from typing import NamedTuple

import numpy as np

from ..base.errors import InputError
from ..base.lazy_threads import threads
from ..base.recent_cache import RecentCache
from ..scene.data_sheet import DataSheet
from ..scene.rig import Rig, Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..scoring.requirements import Criterion, Requirement, RequirementChecker, Zone, checkable
from ..scoring.sampling import SEARCHED
from ..scoring.score import NO_DIFFERENCE, RigEvaluator, ScoreStopped, is_noise, standard_error
from ..scoring.sight import Sight, shown_end
from ..scoring.sight.blind_ground import BLIND_TO_M
from ..search import MountingPlaces, Parametrization
from ..search.build_figures import sheet_of
from ..search.domains import ANGLE_DECIMALS_DEG, METRE, POSITION_DECIMALS, RADIAN, SHARE
from ..search.methods.method import sampled_candidate
from ..search.parametrization import Candidate
from ..search.rig_view import RigView
from ..sensors import kind_of
from .requirement_search import RequirementConstraint
from .study import Study

Watch = Callable[[float], bool]
"""Takes the share of the work that is done, 0 to 1; returns whether it goes on."""
HELP_STEPS = {
    METRE: (0.05, 0.1, 0.2, 0.4, 0.8),
    RADIAN: (0.05, 0.1, 0.2, 0.4, 0.8),
    SHARE: (0.1, 0.2),
}
"""Steps of one design variable that are tried: in metres, radians (3 to 46 deg), and shares."""
FINEST_STEP = 0.01
"""A move is the smallest of its direction to this: in metres, radians, and shares."""
HELP_PLACES = 40
"""Places within its range that are tried for each sensor, after those steps."""
ADD_PLACES = 80
ADD_COMPARED = 4
"""Places of one more sensor of each model, and of those that are enough so many are scored."""
MAX_OCCLUDED = 0.10
MIN_HEIGHT_M = 0.4
OCCLUSION_RAYS = 4096
"""Of one more sensor, if there is such a place: the share of its rays that the vehicle may occlude,
and its smallest height, as lower it is hit by stones and splashed. The share is one of so many rays
at most. Where no place is so good, that which lacks least is taken, and says what it lacks."""
SAMPLES = 2048
"""Voxels on which entropies are compared: their difference is that of one sample."""
SPOT_M = 0.25  # Half the side of the square that a blind spot is
BLIND_SPOT = "blind spot"


class Effect(NamedTuple):
    """Entropy of a rig [nats], on a sample, and its blind ground [m2]; None: not known."""

    entropy: float
    blind_m2: float | None


@dataclass(frozen=True, slots=True)
class Suggestion:
    """The nearest placement found that meets a requirement, or one more sensor that does. Sensors
    in `moved` are elsewhere, or are new if `added`; requirements in `breaks` were met and no longer
    are. `before` and `after` are figures of both rigs, `start` is the rig before. `stderr` is the
    standard error of the change of entropy [nats]. `occluded` is the share of an added sensor's
    rays that the vehicle occludes."""

    rig: Rig
    moved: tuple[str, ...]
    breaks: tuple[str, ...]
    start: Rig
    before: Effect
    after: Effect
    added: bool = False
    stderr: float = 0.0
    occluded: float = 0.0

    @property
    def text(self) -> str:
        """Where the sensors would be: "rear at (-2.5, 0, 1.5) m, roll 0, pitch 30, yaw 180".
        Figures are those of a study file: typed in, they give the placement that was checked."""
        where = []
        for name in self.moved:
            pose = self.rig[name].pose
            x, y, z = (_figure(v, POSITION_DECIMALS) for v in pose.position)
            roll, pitch, yaw = (_figure(v, ANGLE_DECIMALS_DEG) for v in pose.rotation_deg)
            where.append(f"{name} at ({x}, {y}, {z}) m, roll {roll}, pitch {pitch}, yaw {yaw}")
        return "; ".join(where)

    @property
    def sentence(self) -> str:
        """What is done, what it gains, and what it costs, in one sentence."""
        model = self.rig[self.moved[0]].model
        name = ", ".join(self.moved)
        done = f"add a {model.name}{_takes(model)}" if self.added else f"move {name}{self._way}"
        gains = []
        was = self.before.blind_m2
        now = self.after.blind_m2
        if was is not None and now is not None:
            gains.append(f"blind ground {shown_end(was):.1f} to {shown_end(now):.1f} m2")
        by = self.after.entropy - self.before.entropy
        way = "lower" if by < 0.0 else "higher"
        told = NO_DIFFERENCE if is_noise(by, self.stderr) else f"{abs(by):.3f} nats {way}"
        gains.append(f"entropy {told}")
        if self.occluded > MAX_OCCLUDED:
            gains.append(f"{self.occluded:.0%} of its rays occluded")
        height = self.rig[self.moved[0]].pose.position[2]
        if self.added and height < MIN_HEIGHT_M:
            gains.append(f"only {height:.2f} m above the ground")
        broken = f"; breaks {', '.join(self.breaks)}" if self.breaks else ""
        return f"{done}: {', '.join(gains)}{broken}"

    @property
    def is_gain(self) -> bool:
        """Whether less ground is blind: a blind place that moves elsewhere is not fixed."""
        was = self.before.blind_m2
        now = self.after.blind_m2
        return was is None or now is None or now < was

    @property
    def _way(self) -> str:
        """How far the first of the moved sensors is moved and turned."""
        old, new = (rig[self.moved[0]].pose for rig in (self.start, self.rig))
        shift = math.dist(old.position, new.position)
        same = float((old.ground_from_sensor * new.ground_from_sensor).sum() - 1.0) / 2.0
        turn = math.degrees(math.acos(min(max(same, -1.0), 1.0)))
        ways = [f" by {shift:.2f} m"] * (shift >= 0.005) + [f" by {turn:.0f} deg"] * (turn >= 0.5)
        return " and".join(ways)

    def to_dict(self) -> dict[str, object]:
        """Return the suggestion as plain JSON data."""
        poses = {name: self.rig[name].pose for name in self.moved}
        return {
            "added": self.rig[self.moved[0]].model.name if self.added else None,
            "poses": {n: [*pose.position, *pose.rotation_deg] for n, pose in poses.items()},
            "breaks": list(self.breaks),
            "before": self.before._asdict(),
            "after": self.after._asdict(),
            "stderr": self.stderr,
            "text": self.sentence,
        }


def with_blind_spot(study: Study, place: tuple[float, float]) -> Study:
    """Return the study with the place x, y [m] as a requirement, `BLIND_SPOT`: nothing as tall as
    for blind ground is invisible in a square round it, of the same size with voxels of any size."""
    x, y = place
    zone = Zone(x=(x - SPOT_M, x + SPOT_M), y=(y - SPOT_M, y + SPOT_M))
    height = max(BLIND_TO_M, study.space.z[0])
    spot = Requirement(BLIND_SPOT, zone, (), Criterion(blind_m2=0.0, blind_height=height))
    kept = [each for each in study.requirements if each.name != BLIND_SPOT]
    return replace(study, requirements=(*kept, spot))


def suggestions(study: Study) -> dict[str, Suggestion | None]:
    """Return by requirement that is not met the nearest placement found that meets it. None where
    no placement that was tried is enough."""
    repairer = _Repairer(study, (), None)
    repairer.move()
    return {name: repairer.moved.get(name) for name in repairer.names}


def repairs(
    study: Study, names: Sequence[str] = (), watch: Watch | None = None
) -> dict[str, list[Suggestion]]:
    """Return by requirement that is not met what meets it: a move, and one more sensor.

    The move is that of `suggestions`. Of a few places of each model that are enough, the added
    sensor has that with the lowest entropy. Either may be missing, where nothing that was tried is
    enough. Of `names` alone, where there are some. `ScoreStopped` where `watch` says so.
    """
    repairer = _Repairer(study, names, watch)

    def move() -> None:
        with suppress(InputError):  # nothing may move: a sensor may be added
            repairer.move()

    with threads().ThreadPoolExecutor(2) as pool:
        moving = pool.submit(move)
        if study.vehicle is not None:
            repairer.add()
        moving.result()
    return {
        n: [own[n] for own in (repairer.moved, repairer.added) if n in own] for n in repairer.names
    }


def with_free_name(study: Study, sensor: Sensor) -> Sensor:
    """Return a sensor that a study could have, too: with its returns, and a name of its own."""
    name = sensor.name
    taken = [each.name for each in study.rig]
    while name in taken:
        name += "+"
    return study.with_rig(Rig([*study.rig, replace(sensor, name=name)])).rig[name]


class _Repairer:
    """The requirements that a study's rig does not meet, and what was found that meets them."""

    def __init__(self, study: Study, names: Sequence[str], watch: Watch | None) -> None:
        fitting, unchecked = checkable(
            study.requirements, study.rig, study.vehicle, study.reference, space=study.space
        )
        for name in unchecked.keys() & set(names):
            expected = "one that the rig can be held to"
            raise InputError("suggest", f"requirement {name!r}", expected, unchecked[name])
        self._study = study = replace(study, requirements=fitting)
        self._watch = watch or (lambda _: True)
        self._held = self._held_to(study.requirements)
        self._alone = RecentCache[RequirementConstraint](len(study.requirements))
        self._before = self._held.shortfalls(study.rig)
        rows = zip(study.requirements, self._before, strict=True)
        self._left = tuple(r for r, off in rows if off and (not names or r.name in names))
        self.names = [each.name for each in self._left]
        self.moved: dict[str, Suggestion] = {}
        self.added: dict[str, Suggestion] = {}

    def move(self) -> None:
        """Look for the nearest placements."""
        study = self._study
        left = [*self.names]
        coding = study.coding()
        checker = self._checker_of(self._left)
        most = sum(2 * len(HELP_STEPS[v.unit]) for v in coding.variables)
        most += HELP_PLACES * len(coding.blocks)
        number = 0
        for candidates in chain(_steps_of_one(coding), _places_of_one(coding, study.search.seed)):
            if not left:
                break
            enough: dict[str, list[Candidate]] = {}
            for candidate in candidates:
                self._goes_on(number / most)
                number += 1
                for name in self._met_by(candidate.rig, checker, left):
                    enough.setdefault(name, []).append(candidate)
            for name, found in enough.items():
                shortest = [self._shortest(name, each, coding, checker) for each in found]
                for candidate in (min(shortest, key=lambda c: _length(c, coding)), *found):
                    moved = [s.name for s in study.rig if candidate.rig[s.name].pose != s.pose]
                    suggestion = self._suggestion(candidate.rig, moved)
                    if name != BLIND_SPOT or suggestion.is_gain:
                        left.remove(name)
                        self.moved[name] = suggestion
                        break

    def _met_by(self, rig: Rig, checker: RequirementChecker, names: Sequence[str]) -> Iterator[str]:
        """Yield which of the named requirements a rig meets."""
        for each, off in zip(self._left, checker.shortfalls(rig), strict=True):
            if not off and each.name in names and self._is_met_mounted(each, rig):
                yield each.name

    def _shortest(
        self, name: str, candidate: Candidate, coding: Parametrization, checker: RequirementChecker
    ) -> Candidate:
        """Return the shortest part of a move that still meets a requirement, by halving."""
        start = coding.start.vector
        end = candidate.vector
        count = math.ceil(_length(candidate, coding) / FINEST_STEP - 1e-9)
        too_short = 0
        enough = count
        shortest = candidate
        while enough - too_short > 1:
            middle = (too_short + enough) // 2
            share = middle / count
            part = coding.candidate([a + share * (b - a) for a, b in zip(start, end, strict=True)])
            if coding.allowed(part.rig) and [*self._met_by(part.rig, checker, [name])]:
                enough = middle
                shortest = part
            else:
                too_short = middle
        return shortest

    def add(self) -> None:
        """Look for one more sensor."""
        study = self._study
        models = list({each.model.name: each.model for each in study.rig}.values())
        pairs = [(requirement, model) for requirement in self._left for model in models]
        best: dict[str, tuple[float, float, Rig]] = {}
        for number, (requirement, model) in enumerate(pairs):
            checker = self._checker_of((requirement,))
            count = 0
            name = requirement.name
            sensor = with_free_name(study, Sensor(kind_of(model).label, model))
            (verdict,) = checker.check(study.rig, preview=True)
            target = (*verdict.worst, BLIND_TO_M) if verdict.worst else None
            places = MountingPlaces(
                study.rig,
                sensor,
                study.vehicle,
                study.search.mounting.constraints,
                limits=study.limits,
                count=ADD_PLACES,
                look_at=target,
            )
            for at, place in enumerate(places):
                self._goes_on((number + at / ADD_PLACES) / len(pairs))
                rig = places.with_sensor(place.pose)
                if place.reason or checker.shortfalls(rig)[0]:
                    continue
                drawback = self._drawback(rig.sensors[-1])
                if name in best and drawback > best[name][0]:
                    continue
                if self._is_met_mounted(requirement, rig):
                    entropy = 0.0 if drawback else self._searching.entropy(rig)
                    found = drawback, entropy, rig
                    best[name] = min(best.get(name, found), found, key=lambda own: own[:2])
                    if not drawback and (count := count + 1) == ADD_COMPARED:
                        break
        for name, (_, _, rig) in best.items():
            added = self._suggestion(rig, [rig.sensors[-1].name], added=True)
            self.added[name] = replace(added, occluded=self._occluded(rig.sensors[-1]))

    def _drawback(self, sensor: Sensor) -> float:
        """Return by how much one would not mount an added sensor so; 0: one would."""
        low = max(MIN_HEIGHT_M - sensor.pose.position[2], 0.0)
        return max(self._occluded(sensor) - MAX_OCCLUDED, 0.0) + low

    def _occluded(self, sensor: Sensor) -> float:
        vehicle = self._study.vehicle
        return 0.0 if vehicle is None else occluded_share(sensor, vehicle)

    def _checker_of(self, wanted: tuple[Requirement, ...]) -> RequirementChecker:
        return replace(self._study, requirements=wanted).checker()

    def _held_to(self, wanted: tuple[Requirement, ...]) -> RequirementConstraint:
        """Return what holds rigs to requirements with the mounting errors that these ask for."""
        return RequirementConstraint(replace(self._study, requirements=wanted))

    def _is_met_mounted(self, each: Requirement, rig: Rig) -> bool:
        """Whether a requirement that is met is met with the mounting errors that it asks for."""
        if not each.robust_to.mounting:
            return True
        return not self._alone.made(each.name, lambda: self._held_to((each,))).violation(rig)

    def _goes_on(self, share: float) -> None:
        if not self._watch(min(share, 1.0)):
            raise ScoreStopped

    def _suggestion(self, rig: Rig, moved: Sequence[str], added: bool = False) -> Suggestion:
        after = self._held.shortfalls(rig)
        rows = zip(self._study.requirements, self._before, after, strict=True)
        breaks = tuple(each.name for each, was, off in rows if off and not was)
        was, now = self._evaluator.residuals([self._study.rig, rig])
        return Suggestion(
            rig,
            tuple(moved),
            breaks,
            start=self._study.rig,
            before=self._before_figures,
            after=self._effect(rig),
            added=added,
            stderr=standard_error(now - was),
        )

    @cached_property
    def _searching(self) -> RigEvaluator:
        """What chooses among placements; the chosen one is reported on another sample."""
        return self._study.evaluator(SAMPLES, shift=SEARCHED)

    @cached_property
    def _evaluator(self) -> RigEvaluator:
        return self._study.evaluator(SAMPLES)

    @cached_property
    def _sight(self) -> Sight:
        return self._study.sight()

    @cached_property
    def _before_figures(self) -> Effect:
        return self._effect(self._study.rig)

    def _effect(self, rig: Rig) -> Effect:
        blind = None
        with suppress(InputError):  # the ground is not in the space
            blind = RigView(self._sight, rig).blind_m2
        return Effect(self._evaluator.entropy(rig), blind)


def occluded_share(sensor: Sensor, vehicle: Vehicle) -> float:
    """Return the share of a sensor's rays that a vehicle occludes, 0 to 1."""
    rays = kind_of(sensor).rays(sensor, OCCLUSION_RAYS)
    hits = vehicle.first_hit(sensor.pose.position, rays, sensor.model.sees_through_glass)
    reach = getattr(sensor.model, "max_range", math.inf)
    return float(np.mean(hits.distance < reach)) if len(rays) else 0.0


def _takes(model: SensorModel) -> str:
    """What a data sheet says that one sensor takes: " (22 W, 1.5 kg)"."""
    sheet = sheet_of(model, DataSheet())
    known = ((sheet.power, "W"), (sheet.mass, "kg"))
    told = [f"{value:g} {unit}" for value, unit in known if value is not None]
    return f" ({', '.join(told)})" if told else ""


def _length(candidate: Candidate, coding: Parametrization) -> float:
    """Return by how much the variable changes that a candidate changes most [m, rad, share]."""
    pairs = zip(candidate.vector, coding.start.vector, strict=True)
    return max(abs(value - was) for value, was in pairs)


def _steps_of_one(coding: Parametrization) -> Iterator[list[Candidate]]:
    """Yield allowed placements that differ from the start in one variable, by size of the step."""
    start = coding.start.vector
    for rank in range(max(map(len, HELP_STEPS.values()))):
        found = []
        for number, variable in enumerate(coding.variables):
            for step in HELP_STEPS[variable.unit][rank : rank + 1]:
                for shift in (step, -step):
                    vector = list(start)
                    vector[number] = variable.clipped(start[number] + shift)
                    candidate = coding.candidate(vector)
                    if candidate.vector != start and coding.allowed(candidate.rig):
                        found.append(candidate)
        yield found


def _places_of_one(coding: Parametrization, seed: int) -> Iterator[list[Candidate]]:
    """Yield placements with one sensor, or linked pair, anywhere in its range, near ones first."""
    variables = coding.variables
    start = coding.start.vector
    rng = np.random.default_rng(seed)
    sampled = list[tuple[float, Candidate]]()

    def sample(block: range) -> list[float]:
        vector = list(start)
        for k in block:
            vector[k] = float(rng.uniform(variables[k].low, variables[k].high))
        return vector

    for block in coding.blocks:
        for _ in range(HELP_PLACES):
            candidate = sampled_candidate(coding, partial(sample, block))
            if candidate is not None:
                shares = [
                    (candidate.vector[k] - start[k]) / max(v.high - v.low, 1e-9)
                    for k, v in enumerate(variables)
                ]
                sampled.append((math.hypot(*shares), candidate))
    for _, candidate in sorted(sampled, key=lambda pair: pair[0]):
        yield [candidate]


def _figure(value: float, decimals: int) -> str:
    """Return a figure as it is in a study file, without zeros at its end."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
