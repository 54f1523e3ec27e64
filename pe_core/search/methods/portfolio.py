"""Portfolio, the default: a survey of each sensor, then several kinds of descents in turn.

No single method is the best on every problem. Surveys find the region: each sensor tries places all
over its range, the others kept. A large budget is for a race of several descents by steps of all
lengths, of which the best goes on to the end. A small one is for a linear descent and surrogate
descents, which move all sensors at once by models, and for block descents, which find what a model
does not show. Sensors on lists of slots try all slots, exchange them, and move two at a time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..domains import SHARE, DesignVariable
from ..parametrization import Candidate
from .block_descent import FINEST, RESTART_STEP, Descent, SlotTurn, to_best_corners
from .method import Given, Incumbent, MethodPart, Phase, QuestionStream, sampled_candidate
from .portfolio_linear import LinearDescent
from .portfolio_steps import MultiscaleDescent
from .portfolio_surrogate import History, SurrogateDescent

FEW, PER_SENSOR = (0, 400, 950, 1275), 400
"""Placements where no budget is given: for none to three sensors that move, and for each of
more."""
COARSENING, MIN_SAMPLES = 4, 2048
"""The first level evaluates a fourth of the voxels, but at least so many."""
BELOW_GRID = 65_536
"""Where the last level is the grid, the first level is as if the last had so many voxels."""
RACING, PLACEMENTS_PER_START = 4, 80
"""Descents that race, and placements for each sensor that each takes: a smaller budget has none."""
FIRST_LEVEL, RACE_SHARE = 0.33, 0.15
"""Share of the budget after which the first level ends; share of what is left then for each descent
of the race."""
SURVEYS, SURVEYED = 2, 6
"""Surveys before the first descent, and places that each of them tries for each sensor,"""
SURVEY_SHARE = 0.3
"""but at most this share of the budget in all."""
NEAR, NEAR_COUNT = 0.3, 3
"""Reach of the surveys between descents, as a share of each range, and places for each sensor."""
RADIUS, LEAST_RADIUS = 1.0 / 6.0, 0.004
"""First radius of the linear descent, and where it ends, in ranges."""
STEP, NEXT_STEP = 0.2, 0.1
"""Deviation of the first steps of the first surrogate descent, and of the next ones, in ranges."""
LINEAR_SHARE, SURROGATE_SHARE, NEXT_SURROGATE_SHARE, BLOCK_SHARE = 0.25, 0.4, 0.5, 0.5
"""Shares of the budget that is left: for the linear descent, the first surrogate descent and the
next ones, and each block descent after them."""
STEP_SHARE, LAST_STEPS = 0.5, 30
"""After a race: share of the budget that is left for steps between two surveys, and the number of
placements a sensor, from which on it is all that is left."""
TWO_MOVED = 16
"""Placements with two sensors in other slots, tried at once."""
STALLED = 8
"""A search of slots alone ends after so many such batches that found nothing better."""


class Survey:
    """Tries places all over the range of each sensor, the others kept.

    Places are those of an additive recurrence, which fills a range more evenly than random numbers
    (M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018). The first survey is
    the same for every seed, so that the seed seldom decides which region is found. With `exact`,
    placements of sensors in ranges are all evaluated to the end, for a model of them.
    """

    def __init__(self, given: Given, exact: bool = False) -> None:
        self._exact = exact
        self._parametrization, blocks = given.parametrization, given.parametrization.blocks
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
                incumbent.told((yield from self._turns[number].evaluate(incumbent.best, phase)))
                continue
            sampled = [self._sampled(incumbent.best, number, block, reach) for _ in range(count)]
            kept = [c for c in sampled if c is not None]
            yield from _evaluate(incumbent, phase, kept, self._exact)
        if len(self._turns) > 1:
            yield from _evaluate(incumbent, phase, list(self._exchanged(incumbent.best)))

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
        yield from _evaluate(incumbent, phase, [c for c in sampled if c is not None])

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
    low, high = max(variable.low, value - width), min(variable.high, value + width)
    return low + share * (high - low)


def _evaluate(
    incumbent: Incumbent, phase: Phase, candidates: list[Candidate], exact: bool = False
) -> MethodPart[None]:
    """Evaluate placements; unless exactly, only those better than the incumbent matter."""
    moved = [c for c in candidates if c.vector != incumbent.best.vector]
    if moved:
        values = yield from phase.evaluate(moved, math.inf if exact else incumbent.entropy)
        incumbent.told(zip(moved, values, strict=True))


def samples(last: int) -> tuple[int, ...]:
    """Return how many voxels each level evaluates.

    The last level has as many as the study sets: a search on a sample overestimates its own result,
    more so with fewer voxels.
    """
    count = last or BELOW_GRID
    return max(count // COARSENING, min(MIN_SAMPLES, count)), last


def ask(given: Given) -> QuestionStream:
    """Survey on few voxels; then descend on all voxels of the search until the budget is spent."""
    history = History(given.start, given.entropy)
    yield from history.follow(_searched(given, history))


def _searched(given: Given, history: History) -> QuestionStream:
    sensors = len(given.parametrization.blocks)
    total = given.evaluations or budget(sensors)
    large = total >= RACING * PLACEMENTS_PER_START * sensors
    incumbent, survey = Incumbent(given.start, given.entropy), Survey(given, exact=not large)
    moves = any(v.low < v.high for v in given.parametrization.variables)
    races = large and moves and not survey.has_slots_alone
    count = max(1, min(SURVEYED, int(SURVEY_SHARE * total / (SURVEYS * sensors))))
    for _ in range(SURVEYS):
        yield from survey.survey(incumbent, Phase(0, total), count)
        survey.reseed()
    steps, ends = None, tuple[float, ...]()
    if races:
        steps, ends = yield from _race(given, incumbent, total)
    elif given.levels > 1:
        last = Phase(1, total, given.levels - 1)
        [incumbent.entropy] = yield from last.evaluate([incumbent.best])
    number, stalled = 1, 0
    while incumbent.count < total and stalled < STALLED:
        before = incumbent.count, incumbent.entropy
        phase = Phase(number, total, given.levels - 1, ends)
        if survey.has_slots_alone:
            yield from survey.two_moved(incumbent, phase)
            stalled = 0 if incumbent.entropy < before[1] else stalled + 1
        elif steps is not None:
            left = total - incumbent.count
            share = STEP_SHARE if left > LAST_STEPS * sensors else 1.0
            yield from steps.descend(incumbent, phase, share * left)
        else:
            yield from _descend(given, incumbent, phase, number, history)
        if not stalled:
            yield from survey.survey(incumbent, phase, NEAR_COUNT, NEAR)
        if incumbent.count == before[0]:
            return  # nothing can move
        number += 1


def budget(sensors: int) -> int:
    """Return how many placements are evaluated where no budget is given."""
    return FEW[sensors] if sensors < len(FEW) else PER_SENSOR * sensors


def _race(
    given: Given, incumbent: Incumbent, total: int
) -> MethodPart[tuple[MultiscaleDescent, tuple[float, ...]]]:
    """Race descents from the best placement so far, after each sensor tried its corners.

    The race goes on on all voxels, where it is decided: a fourth of them cannot tell apart optima
    that differ by less than 0.05 nats. Returns the steps of the winner, and where each ended.
    """
    first, last = Phase(0, total), Phase(1, total, given.levels - 1)
    yield from to_best_corners(given, incumbent, first)
    begun, count = (incumbent.best, incumbent.entropy), incumbent.count
    racing = [(Incumbent(*begun), MultiscaleDescent(given, [given.seed, k])) for k in range(RACING)]
    for descent, steps in racing:
        yield from steps.descend(descent, first, (FIRST_LEVEL * total - count) / RACING)
    descents = [descent for descent, _ in racing]
    if given.levels > 1:
        values = yield from last.evaluate([descent.best for descent in descents])
        for descent, value in zip(descents, values, strict=True):
            descent.entropy = value
    left = total - count - sum(descent.count for descent in descents)
    for descent, steps in racing:
        yield from steps.descend(descent, last, RACE_SHARE * left)
    winner, steps = min(racing, key=lambda each: each[0].entropy)
    incumbent.best, incumbent.entropy = winner.best, winner.entropy
    incumbent.count += sum(descent.count for descent in descents)
    return steps, tuple(descent.entropy for descent in descents)


def _descend(
    given: Given, incumbent: Incumbent, phase: Phase, number: int, history: History
) -> MethodPart[None]:
    """Descend with all sensors at once by models, then one at a time."""
    step, share = NEXT_STEP, NEXT_SURROGATE_SHARE
    if number == 1:
        linear = LinearDescent(given, incumbent.best, incumbent.entropy, RADIUS)
        left = phase.total - incumbent.count
        yield from linear.descend(phase, LINEAR_SHARE * left, LEAST_RADIUS)
        incumbent.descended(linear)
        step, share = STEP, SURROGATE_SHARE
    start, seed = (incumbent.best, incumbent.entropy), [given.seed, number, 2]
    surrogate = SurrogateDescent(given, history, *start, seed, step)
    yield from surrogate.descend(phase, share * (phase.total - incumbent.count))
    incumbent.descended(surrogate)
    block = Descent(given, incumbent.best, incumbent.entropy, [given.seed, number], RESTART_STEP)
    yield from block.descend(phase, BLOCK_SHARE * (phase.total - incumbent.count), FINEST)
    incumbent.descended(block)
