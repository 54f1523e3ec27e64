"""Methods of other libraries on our problems: CMA-ES, lq-CMA-ES, Nevergrad, Py-BOBYQA, Optuna.

All minimise the entropy over the design variables of a search, from the study's placement. Each
range is scaled to 0 to 1, so first steps are shares of ranges; a list of slots is an integer, or a
category where the method has such.

Constraints: a placement that breaks a rule is not evaluated and does not count. CMA-ES draws it
anew; the others are told a penalty, the worst entropy so far plus the number of broken rules.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.search import Parametrization

FIRST_STEP = 0.2
"""First standard deviation of CMA-ES, and first radius of Py-BOBYQA, as a share of each range."""
MAX_RESTARTS = 9
MAX_BROKEN = 20
"""Placements that break a rule are at most so many times those that are evaluated."""
GP_SECONDS = 120.0
"""Optuna's Gaussian process gets no more processor time than that for a run [s]."""
Floats = NDArray[np.float64]
ReportPlacement = Callable[[pe.Rig, float], None]


class Spent(Exception):
    """The budget is spent."""


class Landscape:
    """The entropy of a placement as a function of a scaled point.

    Attributes
    ----------
    low, high, start : (N,) float
        Bounds and start of the variables that can vary: from 0 to 1, or the number of a slot.
    slots : (N,) int
        How many slots the variable chooses from; 0 where it is a range.

    Parameters
    ----------
    study : Study
    evaluator : RigEvaluator
    evaluations : int
        After so many, the start included, `Spent` is raised.
    told : callable
        Told each placement and its entropy.
    """

    def __init__(
        self, study: pe.Study, evaluator: pe.RigEvaluator, evaluations: int, told: ReportPlacement
    ) -> None:
        self._coding = Parametrization(study.rig, study.search_space())
        self._evaluator = evaluator
        self._told = told
        self._left = evaluations
        self._budget = evaluations
        self.broken = 0
        self.worst = -math.inf
        pairs = zip(self._coding.variables, self._coding.positions, strict=True)
        self._free = [k for k, (variable, _) in enumerate(pairs) if variable.low < variable.high]
        self.slots = np.array([self._slot_count(study, k) for k in self._free])
        is_slot = self.slots > 0
        self.low = np.zeros(len(self._free))
        self.high = np.where(is_slot, self.slots - 1.0, 1.0)
        self.start = np.array(
            [self._scaled(k, n) for k, n in zip(self._free, self.slots, strict=True)]
        )
        self._evaluate(study.rig)

    def __call__(self, point: Floats) -> float:
        """Return the entropy at a point, NaN where the placement breaks a rule."""
        return self._value(point, penalised=False)

    def penalised(self, point: Floats) -> float:
        """Return the entropy at a point, or a penalty where the placement breaks rules."""
        return self._value(point, penalised=True)

    def random_point(self, rng: np.random.Generator) -> Floats:
        """Return a point (N,) anywhere within the bounds."""
        return rng.uniform(self.low, self.high)

    def _slot_count(self, study: pe.Study, number: int) -> int:
        name, axis = self._coding.positions[number]
        return len(study.search.mounting.mount_of(name).slots) if axis == "slot" else 0

    def _scaled(self, number: int, slots: int) -> float:
        value = self._coding.start.vector[number]
        variable = self._coding.variables[number]
        if slots:
            return float(int(value * slots))
        return min(max((value - variable.low) / (variable.high - variable.low), 0.0), 1.0)

    def _vector(self, point: Floats) -> list[float]:
        vector = list(self._coding.start.vector)
        for number, slots, value in zip(
            self._free, self.slots.tolist(), point.tolist(), strict=True
        ):
            variable = self._coding.variables[number]
            if slots:
                vector[number] = (min(max(round(value), 0), slots - 1) + 0.5) / slots
            else:
                width = variable.high - variable.low
                vector[number] = variable.clipped(variable.low + value * width)
        return vector

    def _value(self, point: Floats, penalised: bool) -> float:
        rig = self._coding.candidate(self._vector(np.asarray(point, dtype=float))).rig
        if self._coding.allowed(rig):
            return self._evaluate(rig)
        self.broken += 1
        if self.broken > MAX_BROKEN * self._budget:
            raise Spent
        return self.worst + len(self._coding.broken(rig)) if penalised else math.nan

    def _evaluate(self, rig: pe.Rig) -> float:
        if self._left == 0:
            raise Spent
        self._left -= 1
        value = self._evaluator.entropy(rig)
        self.worst = max(self.worst, value)
        self._told(rig, value)
        return value


def cma_es(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by pycma; restarts begin anywhere, with populations twice as large."""
    import cma

    while True:
        options = _cma_options(landscape, seed, evaluations)
        start = _first_start_then_any(landscape, seed)
        cma.fmin2(landscape, start, FIRST_STEP, options, restarts=MAX_RESTARTS)
        seed += 1000


def lq_cma_es(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by pycma with a linear or quadratic model of the values so far."""
    import cma

    while True:
        options = _cma_options(landscape, seed, evaluations)
        start = _first_start_then_any(landscape, seed)
        cma.fmin_lq_surr2(landscape.penalised, start, FIRST_STEP, options, restarts=MAX_RESTARTS)
        seed += 1000


def _cma_options(landscape: Landscape, seed: int, evaluations: int) -> dict[str, Any]:
    half = np.where(landscape.slots > 0, 0.5, 0.0)  # an integer owns half a step on each side
    return {
        "bounds": [(landscape.low - half).tolist(), (landscape.high + half).tolist()],
        "CMA_stds": (landscape.high - landscape.low + 2.0 * half).tolist(),
        "integer_variables": np.flatnonzero(landscape.slots).tolist(),
        "maxfevals": 100 * evaluations,
        "seed": seed + 1,
        "verbose": -9,
    }


def _first_start_then_any(landscape: Landscape, seed: int) -> Callable[[], Floats]:
    """Return a function that gives the study's placement once, then points anywhere."""
    rng = np.random.default_rng(seed)
    points = [landscape.start]
    return lambda: points.pop() if points else landscape.random_point(rng)


def nevergrad_by_name(name: str, turned: bool = False) -> Callable[[Landscape, int, int], str]:
    """Return the search by a method of Nevergrad; it returns which one that chose in turn.

    `turned`: It searches in the range in another order of the variables, some of them mirrored, by
    the seed. The problem and its start are the same; a method without chance finds another path.
    """

    def search(landscape: Landscape, seed: int, evaluations: int) -> str:
        import nevergrad

        count = len(landscape.start)
        rng = np.random.default_rng(seed)
        order = rng.permutation(count) if turned else np.arange(count)
        mirrored = rng.random(count) < 0.5 if turned else np.zeros(count, dtype=bool)

        def mirror(point: Floats) -> Floats:
            return np.where(mirrored, landscape.low + landscape.high - point, point)

        start = mirror(landscape.start)
        parameters = [_nevergrad_parameter(landscape, k, start[k]) for k in order]
        asked = nevergrad.p.Tuple(*parameters)
        asked.random_state.seed(seed)
        method = nevergrad.optimizers.registry[name]
        optimizer = method(asked, budget=evaluations, num_workers=1)
        chosen = getattr(optimizer, "optim", optimizer)
        point = np.empty(count)
        try:
            while True:
                asked = optimizer.ask()
                point[order] = asked.value
                optimizer.tell(asked, landscape.penalised(mirror(point)))
        except Spent as spent:
            raise Spent(str(getattr(chosen, "name", type(chosen).__name__))) from spent

    return search


def _nevergrad_parameter(landscape: Landscape, number: int, start: float) -> Any:
    import nevergrad

    low = float(landscape.low[number])
    high = float(landscape.high[number])
    scalar = nevergrad.p.Scalar(init=float(start), lower=low, upper=high)
    return scalar.set_integer_casting() if landscape.slots[number] else scalar


def py_bobyqa(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by Py-BOBYQA, with its own restarts; then again from anywhere. Its first directions
    are random: else all seeds would search alike."""
    import pybobyqa

    np.random.seed(seed)  # noqa: NPY002 (it draws from that generator)
    start = _first_start_then_any(landscape, seed)
    while True:
        pybobyqa.solve(
            landscape.penalised,
            start(),
            bounds=(landscape.low, landscape.high),
            maxfun=100 * evaluations,
            rhobeg=FIRST_STEP,
            rhoend=1e-4,
            scaling_within_bounds=True,
            seek_global_minimum=True,
            user_params={"init.random_initial_directions": True},
            do_logging=False,
        )


def optuna_gp(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by Optuna's Gaussian process, as long as its time allows."""
    import time

    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.GPSampler(seed=seed, deterministic_objective=True)
    study = optuna.create_study(sampler=sampler)
    numbers = range(len(landscape.start))
    study.enqueue_trial({f"x{k}": _optuna_value(landscape, k) for k in numbers})
    end = time.process_time() + GP_SECONDS
    while time.process_time() < end:
        trial = study.ask()
        point = np.array([_optuna_asked(landscape, trial, k) for k in numbers])
        study.tell(trial, landscape.penalised(point))
    raise Spent("out of time")


def _optuna_value(landscape: Landscape, number: int) -> float | int:
    value = float(landscape.start[number])
    return round(value) if landscape.slots[number] else value


def _optuna_asked(landscape: Landscape, trial: Any, number: int) -> float:
    name = f"x{number}"
    if landscape.slots[number]:
        return float(trial.suggest_categorical(name, list(range(landscape.slots[number]))))
    return float(trial.suggest_float(name, landscape.low[number], landscape.high[number]))


YARDSTICKS: dict[str, Callable[[Landscape, int, int], str]] = {
    "cma": cma_es,
    "lq-cma": lq_cma_es,
    "ngioh": nevergrad_by_name("NgIohTuned", turned=True),
    "lengler": nevergrad_by_name("DiscreteLenglerOnePlusOne"),
    "bobyqa": py_bobyqa,
    "gp": optuna_gp,
}


def search_by(name: str, landscape: Landscape, seed: int, evaluations: int) -> str:
    """Search until the budget is spent; return the name of the method that was chosen, if any."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return YARDSTICKS[name](landscape, seed, evaluations)
        except Spent as spent:
            return str(spent)
