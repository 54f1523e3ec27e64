"""CMA-ES over some of a placement's unknowns, the others held."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._vendor.cmaes._cma import CMA
from ..coding import Candidate
from ..unknown import METRE, RADIAN, SHARE
from .drawing import drawn
from .method import Given
from .phase import Asks, Phase, Tried

Floats = NDArray[np.float64]

SCALE = {METRE: 1.0, RADIAN: math.radians(30.0), SHARE: 1.0}
"""What counts as one in each unit: as far as Algorithm 1 looks first, and all of a list."""
STEP = 0.15
"""First standard deviation: 0.15 m and 4.5 deg."""
SEEDS = 2**32


class SymmetricCma(CMA):
    """CMA-ES whose samples do not depend on which eigenvectors LAPACK gives.

    They are drawn by the symmetric root of C, of which there is one. Where eigenvalues are equal,
    as they all are at first, eigenvectors may be any, and builds of NumPy differ in them.
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
    """CMA-ES over some unknowns, from generation to generation.

    Parameters
    ----------
    given : Given
    free : sequence of int
        Which unknowns; of those with a range of one point nothing is asked.
    start : Candidate
    seed : sequence of int
    step : float
        First standard deviation: 1 is 1 m and 30 deg.
    """

    def __init__(
        self,
        given: Given,
        free: Sequence[int],
        start: Candidate,
        seed: Sequence[int],
        step: float = STEP,
    ) -> None:
        self._coding, unknowns = given.coding, given.coding.unknowns
        self._free = [k for k in free if unknowns[k].low < unknowns[k].high]
        self._scale = np.array([SCALE[unknowns[k].unit] for k in self._free])
        mean = np.array([start.vector[k] for k in self._free]) / self._scale
        own = int(np.random.default_rng(seed).integers(SEEDS))
        self._cma = SymmetricCma(mean, step, seed=own) if self._free else None

    @property
    def spread(self) -> float:
        """How wide it still looks: 1 is 1 m and 30 deg."""
        return 0.0 if self._cma is None else self._cma.spread

    def asks(self, base: Candidate, phase: Phase) -> Asks[Tried]:
        """Ask for a generation, the other unknowns as in a base, and learn from it.

        The better half of a generation says where to go. So its first half is judged in full, and
        of the others only those that are better than the worst of these: no lower bound is ever
        ranked before an entropy.
        """
        if self._cma is None:
            return []
        half = self._cma.population_size // 2
        first = [self._drawn(base) for _ in range(half)]
        values = yield from phase.asks([candidate for candidate, _ in first])
        rest = [self._drawn(base) for _ in range(self._cma.population_size - half)]
        values += yield from phase.asks([candidate for candidate, _ in rest], max(values))
        both = list(zip([*first, *rest], values, strict=True))
        self._cma.tell([(point, value) for (_, point), value in both])
        return [(candidate, value) for (candidate, _), value in both if candidate is not None]

    def _drawn(self, base: Candidate) -> tuple[Candidate | None, Floats]:
        """Return a candidate that all rules allow, or None, and the point that stands for it."""
        cma, point = self._cma, np.zeros(0)
        assert cma is not None

        def sample() -> list[float]:
            nonlocal point
            vector = list(base.vector)
            asked = cma.ask() * self._scale
            point = np.array([self._held(k, v) for k, v in zip(self._free, asked, strict=True)])
            for k, value in zip(self._free, point.tolist(), strict=True):
                vector[k] = value
            return vector

        candidate = drawn(self._coding, sample)
        return candidate, point / self._scale

    def _held(self, number: int, value: float) -> float:
        """Return a value brought into its range; a share may go round its ring."""
        unknown = self._coding.unknowns[number]
        return float(value if unknown.unit == SHARE else unknown.brought(float(value)))
