"""Surveys, a part of the portfolio: places of one sensor at a time, the other sensors kept.

A sensor in ranges tries places all over them, or their corners; one on a list of slots tries all
slots. Sensors in slots exchange them, and move two at a time.
"""

from collections.abc import Iterable, Iterator
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from ..domains import METRE, SHARE, DesignVariable
from ..parametrization import Candidate
from .method import Given, Incumbent, MethodPart, Phase, sampled_candidate
from .portfolio_steps import alike

TWO_MOVED = 16  # Placements with two sensors in other slots, tried at once
MAX_SLOTS = 16  # Slots evaluated in one turn; of a longer list, so many are sampled
IMAGES = 8
IMAGE_SHARE = 0.02
"""Places beside images that each sensor tries at once; all sensors at most this share of all."""
BESIDE = (-1 / 16, 1 / 16, -1 / 32, 1 / 32, -1 / 64, 1 / 64)
"""How far beside an image, as shares of a range."""


class SlotTurn:
    """A turn of a sensor on a list of slots: all slots, the other sensors fixed."""

    def __init__(self, given: Given, index: int, seed: list[int]) -> None:
        self._parametrization = given.parametrization
        self._index = index
        self._rng = np.random.default_rng(seed)
        first = self._at_share(given.start, 0.0).vector[index]  # middle of the first slot's share
        self._count = round(0.5 / first)

    def evaluate(self, incumbent: Incumbent, phase: Phase) -> MethodPart[None]:
        """Try the slots that are free."""
        moved = [self._at_share(incumbent.best, share) for share in self._shares()]
        allowed = (c for c in moved if self._parametrization.allowed(c.rig))
        yield from _evaluate(incumbent, phase, allowed)

    def _shares(self) -> list[float]:
        """Return the middles of the shares of the slots to evaluate."""
        numbers = np.arange(self._count)
        if self._count > MAX_SLOTS:
            numbers = np.sort(self._rng.choice(self._count, MAX_SLOTS, replace=False))
        return [(number + 0.5) / self._count for number in numbers.tolist()]

    def _at_share(self, base: Candidate, share: float) -> Candidate:
        """Return a candidate in which the sensor takes the slot at a share."""
        vector = list(base.vector)
        vector[self._index] = share
        return self._parametrization.candidate(vector)


class Survey:
    """Tries places all over the range of each sensor, the others kept.

    Places are those of an additive recurrence, which fills a range more evenly than random numbers
    (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018). The first survey is
    the same for every seed, so that the seed seldom decides which region is found.
    """

    def __init__(self, given: Given) -> None:
        self._parametrization = given.parametrization
        blocks = given.parametrization.blocks
        self._rng = np.random.default_rng([given.seed, len(blocks)])
        first = [given.parametrization.variables[block[0]] for block in blocks]
        self._turns = {
            k: SlotTurn(given, blocks[k][0], [given.seed, k])
            for k, variable in enumerate(first)
            if variable.unit == SHARE
        }
        self._shares = {
            k: Recurrence(len(block)) for k, block in enumerate(blocks) if k not in self._turns
        }
        like = enumerate(alike(given.parametrization))
        self._alike = [[] if k in self._turns else others for k, others in like]

    @property
    def has_slots_alone(self) -> bool:
        """Whether every sensor takes one of a list of slots."""
        return not self._shares

    def reseed(self) -> None:
        """Go on with places that depend on the seed."""
        for shares in self._shares.values():
            shares.shift(self._rng)

    def survey(
        self, incumbent: Incumbent, phase: Phase, count: int, reach: float = 1.0
    ) -> MethodPart[None]:
        """Try `count` places for each sensor, within a share of its range on each side."""
        for number, block in enumerate(self._parametrization.blocks):
            if number in self._turns:
                yield from self._turns[number].evaluate(incumbent, phase)
                continue
            sampled = [self._sampled(incumbent.best, number, block, reach) for _ in range(count)]
            yield from _evaluate(incumbent, phase, sampled)
        if len(self._turns) > 1:
            yield from _evaluate(incumbent, phase, self._exchanged(incumbent.best))

    def images(self, incumbent: Incumbent, phase: Phase) -> MethodPart[None]:
        """Try each sensor beside images of others of its model, mirrored where it is on the other
        side. Two LiDARs have their optima together, where beams of one fall between those of the
        other: no step of one of them leads there."""
        count = min(IMAGES, int(IMAGE_SHARE * phase.total / len(self._alike)))
        for number, others in enumerate(self._alike):
            if others:
                sampled = [self._image(incumbent.best, number, others) for _ in range(count)]
                yield from _evaluate(incumbent, phase, sampled)

    def _image(self, base: Candidate, number: int, others: list[int]) -> Candidate | None:
        variables = self._parametrization.variables
        block = self._parametrization.blocks[number]

        def sample() -> list[float]:
            vector = list(base.vector)
            away = others[int(self._rng.integers(len(others)))]
            for k in block:
                own = vector[k]
                other = vector[k + away]
                image = variables[k].mirrored * other
                vector[k] = image if abs(own - image) < abs(own - other) else other
            k = block[int(self._rng.integers(len(block)))]
            width = variables[k].high - variables[k].low
            vector[k] += width * BESIDE[int(self._rng.integers(len(BESIDE)))]
            return vector

        return sampled_candidate(self._parametrization, sample)

    def two_moved(self, incumbent: Incumbent, phase: Phase) -> MethodPart[None]:
        """Try placements with two sensors in other slots."""
        at = [self._parametrization.blocks[k][0] for k in self._turns]
        if len(at) < 2:
            return

        def sample() -> list[float]:
            vector = list(incumbent.best.vector)
            for k in self._rng.choice(at, 2, replace=False).tolist():
                vector[k] = self._rng.random()
            return vector

        sampled = [sampled_candidate(self._parametrization, sample) for _ in range(TWO_MOVED)]
        yield from _evaluate(incumbent, phase, sampled)

    def _exchanged(self, base: Candidate) -> Iterator[Candidate]:
        """Yield the placements in which two sensors exchange their slots."""
        at = [self._parametrization.blocks[k][0] for k in self._turns]
        for one, other in combinations(at, 2):
            vector = list(base.vector)
            vector[one], vector[other] = vector[other], vector[one]
            candidate = self._parametrization.candidate(vector)
            if vector[one] != vector[other] and self._parametrization.allowed(candidate.rig):
                yield candidate

    def _sampled(
        self, base: Candidate, number: int, block: range, reach: float
    ) -> Candidate | None:
        variables = self._parametrization.variables

        def sample() -> list[float]:
            vector = list(base.vector)
            for k, share in zip(block, self._shares[number].next(), strict=True):
                vector[k] = _within(variables[k], vector[k], reach, share)
            return vector

        return sampled_candidate(self._parametrization, sample)


class Recurrence:
    """Points of the unit cube, each the one before plus the same irrational step, modulo 1."""

    def __init__(self, count: int) -> None:
        root = 2.0
        for _ in range(64):
            root = (1.0 + root) ** (1.0 / (count + 1))
        self._step: NDArray[np.float64] = root ** -np.arange(1.0, count + 1.0)
        self._at = np.full(count, 0.5)

    def next(self) -> list[float]:
        """Return the next point (N,)."""
        self._at = (self._at + self._step) % 1.0
        return [float(value) for value in self._at]

    def shift(self, rng: np.random.Generator) -> None:
        """Go on from a random point."""
        self._at = rng.random(len(self._at))


def _within(variable: DesignVariable, value: float, reach: float, share: float) -> float:
    """Return the value at a share of the range within a reach of a value."""
    width = reach * (variable.high - variable.low)
    low = max(variable.low, value - width)
    high = min(variable.high, value + width)
    return low + share * (high - low)


def _evaluate(
    incumbent: Incumbent, phase: Phase, candidates: Iterable[Candidate | None]
) -> MethodPart[None]:
    """Evaluate placements; only those better than the incumbent matter."""
    moved = [c for c in candidates if c is not None and c.vector != incumbent.best.vector]
    if moved:
        yield from incumbent.tried(moved, phase)


def to_best_corners(given: Given, incumbent: Incumbent, phase: Phase) -> MethodPart[None]:
    """Try each sensor in all corners of its bounds."""
    for block in given.parametrization.blocks:
        corners = _corners(given, incumbent.best, block)
        allowed = [c for c in corners if given.parametrization.allowed(c.rig)]
        yield from incumbent.tried(allowed, phase)


def _corners(given: Given, base: Candidate, block: range) -> Iterator[Candidate]:
    """Yield the corners of one sensor's bounds, the other sensors as in the base."""
    variables = given.parametrization.variables
    ends = [
        (variables[k].low, variables[k].high) if variables[k].unit == METRE else (base.vector[k],)
        for k in block
    ]
    for values in product(*ends):
        vector = list(base.vector)
        vector[block.start : block.stop] = values
        yield given.parametrization.candidate(vector)
