"""CMA-ES, a part of the portfolio: covariance matrix adaptation over some design variables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.arrays import Floats
from .._vendor.cmaes._cma import CMA
from ..domains import METRE, RADIAN, SHARE
from ..parametrization import Candidate
from .method import Evaluated, Given, MethodPart, Phase, sampled_candidate

SCALE = {METRE: 1.0, RADIAN: math.radians(30.0), SHARE: 1.0}
"""The scale of each unit: the first reach of Algorithm 1, and all of a list."""
STEP = 0.15
"""First standard deviation: 0.15 m and 4.5 deg."""


class SymmetricCma(CMA):
    """CMA-ES whose samples do not depend on the choice of eigenvectors by LAPACK.

    Samples are drawn by the symmetric root of C, which is unique. Eigenvectors are not unique where
    eigenvalues are equal, as they all are at first, and builds of NumPy differ in them.
    """

    def _sample_solution(self) -> Floats:
        vectors, roots = self._eigen_decomposition()
        steps = (vectors * roots).dot(vectors.T).dot(self._rng.randn(self._n_dim))
        return self._mean + self._sigma * steps

    @property
    def spread(self) -> float:
        """Standard deviation in the widest direction."""
        return float(self._sigma * self._eigen_decomposition()[1].max())


class Evolution:
    """CMA-ES over some design variables, from generation to generation.

    `free` has the numbers of the variables; those with a range of one point stay fixed. `step` is
    the first standard deviation: 1 is 1 m and 30 deg.
    """

    def __init__(
        self,
        given: Given,
        free: Sequence[int],
        start: Candidate,
        seed: Sequence[int],
        step: float = STEP,
    ) -> None:
        self._parametrization, variables = given.parametrization, given.parametrization.variables
        self._free = [k for k in free if variables[k].low < variables[k].high]
        self._scale = np.array([SCALE[variables[k].unit] for k in self._free])
        mean = np.array([start.vector[k] for k in self._free]) / self._scale
        cma_seed = int(np.random.default_rng(seed).integers(2**32))
        self._cma = SymmetricCma(mean, step, seed=cma_seed) if self._free else None

    @property
    def spread(self) -> float:
        """Largest standard deviation of the samples: 1 is 1 m and 30 deg."""
        return 0.0 if self._cma is None else self._cma.spread

    def evaluate(self, base: Candidate, phase: Phase) -> MethodPart[Evaluated]:
        """Evaluate a generation, the other variables as in the base, and update the distribution.

        The update uses the better half of a generation. So the first half is evaluated without a
        cutoff, and the second half with the worst of these values as the cutoff: no lower bound is
        ever ranked before an entropy.
        """
        if self._cma is None:
            return []
        half = self._cma.population_size // 2
        first = [self._sampled(base) for _ in range(half)]
        values = yield from phase.evaluate([candidate for candidate, _ in first])
        rest = [self._sampled(base) for _ in range(self._cma.population_size - half)]
        values += yield from phase.evaluate([candidate for candidate, _ in rest], max(values))
        both = list(zip([*first, *rest], values, strict=True))
        self._cma.tell([(point, value) for (_, point), value in both])
        return [(candidate, value) for (candidate, _), value in both if candidate is not None]

    def _sampled(self, base: Candidate) -> tuple[Candidate | None, Floats]:
        """Return a feasible candidate, or None, and the point that CMA-ES sampled for it."""
        cma, point = self._cma, np.zeros(0)
        assert cma is not None

        def sample() -> list[float]:
            nonlocal point
            vector = list(base.vector)
            for k, value in zip(self._free, (cma.ask() * self._scale).tolist(), strict=True):
                variable = self._parametrization.variables[k]  # a share is cyclic: it stays
                vector[k] = value if variable.unit == SHARE else variable.clipped(value)
            point = np.array([vector[k] for k in self._free])
            return vector

        candidate = sampled_candidate(self._parametrization, sample)
        return candidate, point / self._scale
