"""Methods of other libraries on our problems: Nevergrad's NGOpt, and pycma with restarts.

Both minimise the entropy over the design variables of a search, scaled so that 1 is 1 m, 30 degrees
or a whole list of slots, within the variables' bounds, from the study's placement. A placement that
breaks a rule is not evaluated and does not count: pycma draws it anew, NGOpt is told a value worse
than all others.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.search import Parametrization

SCALE = {"m": 1.0, "rad": math.radians(30.0), "share": 1.0}
STEP = 0.15
"""First standard deviation of CMA-ES, as in the engine's own."""
MAX_BROKEN = 20
"""Placements that break a rule are at most so many times those that are evaluated."""
Floats = NDArray[np.float64]
ReportPlacement = Callable[[pe.Rig, float], None]


class Spent(Exception):
    """The budget is spent."""


class Landscape:
    """The entropy of a placement as a function of a scaled vector.

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
        self._broken = 0
        each = enumerate(self._coding.variables)
        self._free = {k: v for k, v in each if v.low < v.high}
        start = np.array([self._coding.start.vector[k] for k in self._free])
        self._scale = np.array([SCALE[v.unit] for v in self._free.values()])
        self.low = np.array([v.low for v in self._free.values()]) / self._scale
        self.high = np.array([v.high for v in self._free.values()]) / self._scale
        self.start = np.clip(start / self._scale, self.low, self.high)
        self._budget = evaluations
        self.worst = -math.inf
        self._evaluate(study.rig)

    def __call__(self, point: Floats) -> float:
        """Return the entropy at a point, NaN where the placement breaks a rule."""
        vector = list(self._coding.start.vector)
        values = zip(self._free.items(), (point * self._scale).tolist(), strict=True)
        for (number, variable), value in values:
            vector[number] = variable.clipped(value)
        candidate = self._coding.candidate(vector)
        if not self._coding.allowed(candidate.rig):
            self._broken += 1
            if self._broken > MAX_BROKEN * self._budget:
                raise Spent
            return math.nan
        return self._evaluate(candidate.rig)

    def _evaluate(self, rig: pe.Rig) -> float:
        if self._left == 0:
            raise Spent
        self._left -= 1
        value = self._evaluator.entropy(rig)
        self.worst = max(self.worst, value)
        self._told(rig, value)
        return value


def ngopt(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by NGOpt; return the name of the method that it chose."""
    import nevergrad

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        array = nevergrad.p.Array(init=landscape.start)
        array.set_bounds(landscape.low, landscape.high)
        array.random_state.seed(seed)
        optimizer = nevergrad.optimizers.NGOpt(array, budget=evaluations, num_workers=1)
        try:
            while True:
                asked = optimizer.ask()
                value = landscape(np.asarray(asked.value))
                optimizer.tell(asked, landscape.worst + 1.0 if math.isnan(value) else value)
        except Spent:
            pass
        chosen = getattr(optimizer, "optim", optimizer)
        return str(getattr(chosen, "name", type(chosen).__name__))


def pycma(landscape: Landscape, seed: int, evaluations: int) -> str:
    """Minimise by pycma, restarted with populations twice as large; return its name."""
    import cma

    options = {
        "bounds": [landscape.low.tolist(), landscape.high.tolist()],
        "maxfevals": 100 * evaluations,
        "seed": seed + 1,
        "verbose": -9,
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            while True:
                cma.fmin2(landscape, landscape.start, STEP, options, restarts=9)
        except Spent:
            return "pycma"


YARDSTICKS = {"ngopt": ngopt, "pycma": pycma}
