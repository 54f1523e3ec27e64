"""Steps of all lengths: one or two variables of one sensor at a time, from the best so far.

The share of beams that meet an object jumps where a LiDAR rises by a centimetre or tilts by a tenth
of a degree, so the entropy has many small valleys beside each other. A step whose logarithm of
length is uniform finds the small ones and leaps over the large ones; nothing has to be tuned
(J. E. Rowe, D. Hidovic, An evolution strategy using a continuous version of the Gray-code
neighbourhood distribution, 2004). Variables whose steps gained lately are moved more often.

Sensors of one model have optima in common: where beams of one LiDAR fall between those of another,
both have the same pitch to a tenth of a degree. So a step may give a sensor values of another one,
or move both alike: a valley that no step of one sensor follows.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..domains import SHARE
from ..parametrization import Candidate, Parametrization
from .method import Given, Incumbent, MethodPart, Phase, sampled_candidate

BATCH = 8  # Placements that are tried at once
SECOND = 0.7  # Probability that a second variable of the same sensor moves, too
EVEN = 0.1  # Probability that a variable is chosen whatever its steps gained
FULL_GAIN = 0.02
MEMORY = 0.1
"""The gain of a step counts up to this [nats], with this weight beside those of earlier steps."""


class Stride(NamedTuple):
    """How descents step. The longest step is half a variable's range; a step is halved less than
    `halvings` times. Where there is another sensor of the same model: probability that a sensor
    takes its values (`copied`), and that both move by the same steps (`together`). `hope`: what the
    steps of each variable are taken to gain at first, as a share of `FULL_GAIN`."""

    halvings: int
    copied: float
    together: float
    hope: float


EXPLORING = Stride(9, 0.2, 0.2, 1.0)
REFINING = Stride(10, 0.1, 0.4, 0.1)
"""Of small budgets and of large ones: once beams of a LiDAR fall between those of another, steps of
both gain several times as much as those of one."""


class MultiscaleDescent:
    """Steps of all lengths, the more of a variable the more its steps gained."""

    def __init__(self, given: Given, seed: Sequence[int], stride: Stride = EXPLORING) -> None:
        self._parametrization = given.parametrization
        variables = given.parametrization.variables
        self._rng = np.random.default_rng(seed)
        self._stride = stride
        movable = [v.low < v.high and v.unit != SHARE for v in variables]
        blocks = given.parametrization.blocks
        self._free = [
            ([k for k in block if movable[k]], number, others)
            for block, others in zip(blocks, alike(given.parametrization), strict=True)
            for number in block
            if movable[number]
        ]
        self._gains = np.full(len(self._free), stride.hope)

    def descend(self, incumbent: Incumbent, phase: Phase, count: float) -> MethodPart[None]:
        """Try about `count` placements; each batch starts from the best of those before."""
        end = incumbent.count + count
        while self._free and incumbent.count < end:
            tried = self._batch(incumbent.best)
            if not tried:
                return
            before = incumbent.value
            candidates = [candidate for _, candidate in tried]
            values = yield from incumbent.tried(candidates, phase)
            for (number, _), value in zip(tried, values, strict=True):
                gain = min(max(before.rise_from(value), 0.0) / FULL_GAIN, 1.0)
                self._gains[number] += MEMORY * (gain - self._gains[number])

    def _batch(self, base: Candidate) -> list[tuple[int, Candidate]]:
        """Return placements a step away that break no rule, each with its variable's number."""
        shares = self._gains / np.cumsum(self._gains)[-1]
        ends = np.cumsum((1.0 - EVEN) * shares + EVEN / len(shares))
        tried = []
        for _ in range(BATCH):
            number = min(int(np.searchsorted(ends, self._rng.random())), len(ends) - 1)
            candidate = self._stepped(base, *self._free[number])
            if candidate is not None and candidate.vector != base.vector:
                tried.append((number, candidate))
        return tried

    def _stepped(
        self, base: Candidate, sensor: list[int], first: int, alike: list[int]
    ) -> Candidate | None:
        others = [k for k in sensor if k != first]
        copied = self._stride.copied
        together = self._stride.together

        def sample() -> list[float]:
            vector = list(base.vector)
            moved = [first]
            if others and self._rng.random() < SECOND:
                moved.append(others[int(self._rng.integers(len(others)))])
            # from a variable to that of the other sensor
            way = 1.0
            away = 0
            if alike:
                way = self._rng.random()
                away = alike[int(self._rng.integers(len(alike)))]
            for k in moved:
                variable = self._parametrization.variables[k]
                step = (variable.high - variable.low) * self._step()
                vector[k] += step
                if copied <= way < copied + together:
                    vector[k + away] += step
                if way < copied:
                    vector[k] = base.vector[k + away]
            return vector

        return sampled_candidate(self._parametrization, sample)

    def _step(self) -> float:
        """Return a step, as a share of a range: each halving of its length is as probable."""
        halved = int(self._rng.integers(1, self._stride.halvings + 1))
        length = 0.5**halved * (0.5 + 0.5 * self._rng.random())
        return length if self._rng.random() < 0.5 else -length


def alike(parametrization: Parametrization) -> Iterator[list[int]]:
    """Yield, for each sensor, how far away the variables of those of the same model are."""
    variables = parametrization.variables
    blocks = parametrization.blocks
    units = ([variables[k].unit for k in block] for block in blocks)
    kinds = list(zip(parametrization.models, units, strict=True))
    for block, kind in zip(blocks, kinds, strict=True):
        same = (other for other, its in zip(blocks, kinds, strict=True) if its == kind)
        yield [other.start - block.start for other in same if other != block]
