"""What a study's rigs are evaluated by in a search, and under all its conditions.

Conditions are states by weathers; the table has each with each sensor lost, too. What they share is
computed once: each state has one evaluator, and each of its sensors is measured once for all
weathers that only shorten its range (`sensors.measurement_cache`). A study that scores all voxels
has its conditions scored on a sample, of which the standard error is known.

A search minimises one value. With `[optimize] objective = "expected_ap"` it is minus the expected
AP of objects in traffic, so that bounds and cutoffs work as for entropy. With `conditions = "mean"`
or `"worst"` it is the weighted mean of a placement's entropies in all states and weathers, or the
highest of those with a weight. With a tolerance, each of these is the mean (or the worst) of its
cases. Requirements wrap either.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

from ..base.arrays import Floats
from ..base.errors import InputError
from ..base.values import rounded
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from ..scene.vehicle_state import State
from ..scoring import Score
from ..scoring.rig_batch import mean_or_worst
from ..scoring.sampling import SEARCHED, Shift
from ..scoring.score import RigEvaluator, Watch
from ..scoring.targets import OBJECTS, ObjectEvaluator
from ..scoring.targets.object_evaluator import MByName
from ..search import Objective, objective_of
from .conditions import AS_DRAWN, CLEAR, StateInWeather
from .study import DEFAULT_SEARCH_SAMPLES, EXPECTED_AP, Study

COVERS = 0.01
"""A part that occludes more of a sensor than as drawn, by this share of its rays, is told."""
WORST = "worst"


class ExpectedApEvaluator(ObjectEvaluator):
    """An `ObjectEvaluator` whose value of a rig is minus its expected AP; scores are the same."""

    def _value(self, rig: Rig, m: MByName) -> float:
        return -self._sums.expected_ap(self._fused.entropies(rig, m)[0])

    def _residuals(self, entropies: Floats) -> Sequence[float]:
        return [-each for each in self._sums.residuals_of_ap(entropies)]


def is_by_ap(study: Study) -> bool:
    """Whether a study's search maximises the expected AP of objects in traffic."""
    return study.search.objective == EXPECTED_AP


def on_objects(study: Study) -> type[ObjectEvaluator]:
    """Return what evaluates candidates of a study's search on objects."""
    return ExpectedApEvaluator if is_by_ap(study) else ObjectEvaluator


def searched_study(study: Study) -> Study:
    """Return the study that a search evaluates candidates of: by expected AP, one in traffic."""
    if not is_by_ap(study):
        return study
    return replace(study, targets=replace(study.targets, targets=OBJECTS, traffic=True), samples=0)


def search_evaluator(
    study: Study, samples: int | None = None, workers: int | None = None, shift: Shift = SEARCHED
) -> RigEvaluator:
    """Return what evaluates candidates of a study's search; arguments are those of
    `Study.evaluator`."""
    return searched_study(study).evaluator(samples, workers, on_objects(study), shift)


@dataclass(frozen=True, slots=True)
class ConditionScore:
    """The score of a rig under one condition.

    `state, weather`: Names; "as drawn" and "clear" where the study has none.
    `entropy, stderr`: Entropy under the condition and its standard error [nats].
    `per_class`: Entropy by class [nats].
    `without`: Entropy without each sensor, by name [nats].
    `ap`: Expected AP; only for scores on objects, as the next two.
    `reach`: By class and direction, the distance to which a lone object is found [m].
    `covered`: By sensor and part of the vehicle, the share of its rays that the part occludes
        beyond what it occludes as drawn; parts of the state alone.
    """

    state: str
    weather: str
    weight: float
    entropy: float
    stderr: float
    coverage: float
    per_class: dict[str, float]
    without: dict[str, float]
    ap: float | None = None
    ap_per_class: dict[str, float] | None = None
    reach: dict[str, dict[str, float]] | None = None
    covered: dict[str, dict[str, float]] | None = None

    @property
    def name(self) -> str:
        """Both names, "door open, fog"."""
        return f"{self.state}, {self.weather}"


@dataclass(frozen=True, slots=True)
class ConditionTable:
    """Scores of a rig under all conditions of a study, on `samples` voxels or objects.
    `below_ground` has parts that a state drives into the ground, by state: depth by part [m]."""

    rows: tuple[ConditionScore, ...]
    samples: int
    sensors: tuple[str, ...]
    below_ground: dict[str, dict[str, float]]

    @property
    def mean(self) -> float:
        """Mean entropy by the weights of the conditions [nats]."""
        return weighted_mean([r.entropy for r in self.rows], [r.weight for r in self.rows])

    @property
    def worst(self) -> ConditionScore:
        """The condition with the highest entropy, of those with a weight."""
        return max((r for r in self.rows if r.weight > 0.0), key=lambda row: row.entropy)

    def mean_without(self, sensor: str) -> float:
        """Mean entropy without a sensor [nats]."""
        return weighted_mean([r.without[sensor] for r in self.rows], [r.weight for r in self.rows])

    @property
    def worst_loss(self) -> tuple[str, ConditionScore]:
        """The lost sensor and the condition with the highest entropy, of those with a weight."""
        cells = ((s, r) for r in self.rows if r.weight > 0.0 for s in self.sensors)
        return max(cells, key=lambda cell: cell[1].without[cell[0]])

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        worst = self.worst
        return {
            "samples": self.samples,
            "mean": self.mean,
            "worst": {"state": worst.state, "weather": worst.weather, "entropy": worst.entropy},
            "mean_without": {name: self.mean_without(name) for name in self.sensors},
            "below_ground": self.below_ground,
            "rows": [{k: v for k, v in asdict(r).items() if v is not None} for r in self.rows],
        }


def weighted_mean(values: Sequence[float], weights: Sequence[float]) -> float:
    """Return the mean of values by weights."""
    total = sum(weights)
    return rounded(sum(v * w for v, w in zip(values, weights, strict=True)) / total)


def condition_table(
    study: Study, workers: int | None = None, watch: Watch | None = None
) -> ConditionTable | None:
    """Return the scores of a study's rig under all its conditions; None without conditions.
    `ScoreStopped` when `watch` returned False."""
    if not study.conditions:
        return None
    samples = study.samples or DEFAULT_SEARCH_SAMPLES
    rows: list[ConditionScore] = []
    evaluators = EvaluatorsByState(study, samples, workers)
    conditions = study.conditions.all
    as_drawn = evaluators.in_state(None)[0].score(study.rig) if study.conditions.states else None
    drawn = {} if as_drawn is None else _occluded(as_drawn)
    for number, condition in enumerate(conditions):
        evaluator, _ = evaluators.in_state(condition.state)
        rig = condition.rig(study.rig, study.vehicle)
        part = None if watch is None else partial(_part_of, watch, number, len(conditions))
        known = as_drawn if condition.is_as_drawn else None
        score = known or evaluator.score(rig, watch=part)
        rows.append(_row(condition, score, drawn))
        if part is not None:
            part(1.0)
    below = {s.name: d for s in study.conditions.states if (d := s.below_ground(study.vehicle))}
    names = tuple(sensor.name for sensor in study.rig)
    return ConditionTable(tuple(rows), evaluators.in_state(None)[0].samples, names, below)


class EvaluatorsByState:
    """The evaluators of a study by state of the vehicle; each is made once. `make` returns one of a
    study, a number of samples and a number of workers."""

    def __init__(
        self,
        study: Study,
        samples: int,
        workers: int | None = None,
        make: Callable[[Study, int, int | None], RigEvaluator] = Study.evaluator,
    ) -> None:
        self._study = study
        self._samples = samples
        self._workers = workers
        self._make = make
        self._made: dict[str, tuple[RigEvaluator, Vehicle | None]] = {}

    def in_state(self, state: State | None) -> tuple[RigEvaluator, Vehicle | None]:
        """Return the evaluator on the vehicle in a state, and that vehicle."""
        key = "" if state is None or state.is_as_drawn else state.name
        if key not in self._made:
            study = self._study.under(StateInWeather(state if key else None))
            made = self._make(study, self._samples, self._workers), study.vehicle
            self._made[key] = made
        return self._made[key]


def _part_of(watch: Callable[[float], bool], number: int, count: int, share: float) -> bool:
    return watch((number + share) / count)


def _row(
    condition: StateInWeather, score: Score, drawn: dict[str, dict[str, float]]
) -> ConditionScore:
    objects = score.objects
    return ConditionScore(
        state=AS_DRAWN if condition.state is None else condition.state.name,
        weather=CLEAR if condition.weather is None else condition.weather.name,
        weight=condition.weight,
        entropy=score.entropy,
        stderr=score.stderr,
        coverage=score.coverage,
        per_class={name: part.entropy for name, part in score.per_class.items()},
        without={name: rounded(score.entropy + s.lost) for name, s in score.per_sensor.items()},
        ap=None if objects is None else objects.ap,
        ap_per_class=None if objects is None else {n: c.ap for n, c in objects.per_class.items()},
        reach=None if objects is None else {n: dict(c.reach) for n, c in objects.per_class.items()},
        covered=_covered(score, drawn) if condition.state is not None else None,
    )


def _occluded(score: Score) -> dict[str, dict[str, float]]:
    """Return the share of each sensor's rays that each part occludes."""
    return {
        name: {part: count / s.beams for part, count in s.occluded_by.items()}
        for name, s in score.per_sensor.items()
        if s.beams
    }


def _covered(
    score: Score, drawn: dict[str, dict[str, float]]
) -> dict[str, dict[str, float]] | None:
    """Return what parts occlude beyond what they occlude as drawn; None for nothing."""
    found: dict[str, dict[str, float]] = {}
    for name, parts in _occluded(score).items():
        for part, share in parts.items():
            more = share - drawn.get(name, {}).get(part, 0.0)
            if more >= COVERS:
                found.setdefault(name, {})[part] = round(more, 4)
    return found or None


class ConditionFigure:
    """What a search over a study's conditions minimises, evaluated on `samples` voxels of a
    `shift`."""

    def __init__(
        self, study: Study, samples: int, workers: int | None = None, shift: Shift = SEARCHED
    ) -> None:
        self._given = study, samples, workers, shift
        self._study = study
        self._worst = study.search.conditions == WORST
        self._conditions = [c for c in study.conditions.all if c.weight > 0.0]
        make = partial(search_evaluator, shift=shift)
        self._evaluators = EvaluatorsByState(study, samples, workers, make)

    def __reduce__(self) -> tuple[object, ...]:
        return ConditionFigure, self._given

    def __call__(self, rig: Rig) -> float:
        """Return the mean or the worst of a rig's entropies under all conditions [nats]."""
        return self.below(rig, math.inf)

    def below(self, rig: Rig, cutoff: float) -> float:
        """Return that value; inf once one of the conditions whose worst counts is not below."""
        search = self._study.search
        cases = search.tolerance.cases(rig, search.seed) if search.tolerance.is_on else [rig]
        values = list[float]()
        weights = list[float]()
        for state in dict.fromkeys(c.state for c in self._conditions):
            own = [c for c in self._conditions if c.state == state]
            rigs = [c.rig(case, self._study.vehicle) for c in own for case in cases]
            found = self._evaluators.in_state(state)[0].entropies(rigs)
            for number, condition in enumerate(own):
                part = found[number * len(cases) : (number + 1) * len(cases)]
                values.append(mean_or_worst(part, search.tolerance.worst))
                weights.append(condition.weight)
            if self._worst and max(values) >= cutoff:
                return math.inf
        return max(values) if self._worst else weighted_mean(values, weights)


def study_objective(
    study: Study,
    evaluator: RigEvaluator,
    samples: int,
    workers: int | None = None,
    shift: Shift = SEARCHED,
) -> Objective:
    """Return what a study's search minimises, without its requirements, on the sample of a `shift`,
    which is the evaluator's. `InputError` when conditions are to be searched over and the study has
    none."""
    search = study.search
    if search.conditions is None:
        return objective_of(evaluator, search.tolerance, search.seed)
    if not study.conditions:
        expected = "[[state]] or [[weather]] with it"
        raise InputError("optimize", "conditions", expected, "neither")
    return Objective(ConditionFigure(study, samples, workers, shift))
