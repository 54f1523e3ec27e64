"""Surrogate descent: all sensors at once, by a model of every placement that was evaluated so far.

The model is a cubic radial basis function with a linear tail. Each question has four placements,
sampled round the best one: steps that the model expects to be low, and that lead away from what is
known. Steps become shorter where nothing better is found, and move ever fewer variables (R. G.
Regis, C. A. Shoemaker, Combining radial basis function surrogates and dynamic coordinate search in
high-dimensional expensive black-box optimization, 2013).

A few hundred placements tell such a model more than a simplex of the last ones tells a linear one,
and a model of many placements looks beyond the small valleys between them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.arrays import Floats
from ..domains import SHARE
from ..parametrization import Candidate
from .method import MAX_SAMPLED, Given, Incumbent, MethodPart, Phase, QuestionStream
from .portfolio_linear import UnitRanges

SAMPLED = 500
"""Placements sampled for each question."""
MODEL_WEIGHTS = (0.5, 0.8, 0.95, 1.0)
"""Weight of the model's value for each placement of a question; the rest is for its distance from
known placements."""
MOVED = 20
"""Variables that a step moves at first, on average, where there are more."""
MAX_GAINS, MIN_FAILURES = 3, 5
"""Questions with a gain until steps are doubled; placements without one until they are halved, but
as many as there are variables."""
SHORTEST = 64
"""The shortest steps are this many times shorter than the first ones."""
GAIN = 1e-4
"""What counts as a gain [nats]."""
NOISE, TAIL_NOISE = 1e-3, 1e-4
"""Added to the diagonal of the model's equations: values are not met exactly, because the entropy
has many small valleys; the tail is not quite free, so few placements are enough for it."""
MAX_KNOWN = 200
"""A model begins with at most so many known placements, those nearest to the best; with twice as
many it is begun anew."""


class History:
    """The vectors and values of all placements that a search evaluated."""

    def __init__(self, start: Candidate, entropy: float) -> None:
        self.vectors, self.values = [start.vector], [entropy]

    def follow(self, questions: QuestionStream) -> QuestionStream:
        """Pass questions and answers on; keep all values that are no lower bounds."""
        answers = None
        while True:
            try:
                question = next(questions) if answers is None else questions.send(answers)
            except StopIteration:
                return
            answers = yield question
            for candidate, answer in zip(question.candidates, answers, strict=True):
                if candidate and answer and answer.entropy < question.cutoff:
                    self.vectors.append(candidate.vector)
                    self.values.append(answer.entropy)


class CubicModel:
    """A cubic radial basis function with a linear tail, to which points (D,) are added.

    The inverse of its equations is kept, and bordered with each point, by operations that have the
    same bits on every system.
    """

    def __init__(self, dimensions: int) -> None:
        self._points = np.empty((dimensions, 0))
        self._values = np.empty(0)
        self._inverse = np.eye(dimensions + 1) / -TAIL_NOISE

    def add(self, point: Floats, value: float) -> None:
        """Add a point (D,) and its value."""
        row = np.concatenate([[1.0], point, _cubed(self.distances(point[:, None])[:, 0])])
        across = (row[:, None] * self._inverse).sum(axis=0)
        height = NOISE - math.fsum(row * across)
        grown = np.zeros((len(row) + 1, len(row) + 1))
        border = np.concatenate([across, [-1.0]])
        grown[:-1, :-1] = self._inverse
        self._inverse = grown + border[:, None] * border / height
        self._points = np.concatenate([self._points, point[:, None]], axis=1)
        self._values = np.concatenate([self._values, [value]])

    @property
    def count(self) -> int:
        """How many points the model has."""
        return len(self._values)

    def distances(self, points: Floats) -> Floats:
        """Return the distances (N, M) of all N points of the model from points (D, M)."""
        squares = np.zeros((self._points.shape[1], points.shape[1]))
        for known, new in zip(self._points, points, strict=True):
            squares += (known[:, None] - new) ** 2
        return np.sqrt(squares)

    def expected(self, points: Floats, distances: Floats) -> Floats:
        """Return the model's values (M,) at points (D, M) with their distances (N, M).

        Values above the median of the finite ones count as that median: a model of bad placements
        need not be right.
        """
        tail = np.zeros(len(points) + 1)
        finite = self._values[np.isfinite(self._values)]
        capped = np.minimum(self._values, np.median(finite))
        values = np.concatenate([tail, capped])
        weights = (values[:, None] * self._inverse).sum(axis=0)
        rows = [np.ones((1, points.shape[1])), points, _cubed(distances)]
        return np.asarray((weights[:, None] * np.concatenate(rows)).sum(axis=0))


class SurrogateDescent(Incumbent):
    """A surrogate descent from the best placement so far.

    `history` has known placements, and may grow meanwhile; `step` is the first standard deviation
    of steps, as a share of the variables' ranges.
    """

    def __init__(
        self,
        given: Given,
        history: History,
        start: Candidate,
        entropy: float,
        seed: Sequence[int],
        step: float,
    ) -> None:
        self._parametrization, self._history = given.parametrization, history
        self._ranges = UnitRanges(given)
        self._free = self._ranges.free
        super().__init__(start, entropy)
        self._rng = np.random.default_rng(seed)
        self._step, self._longest = step, step
        self._gains = self._failures = 0
        self._slots = [k for k, v in enumerate(given.parametrization.variables) if v.unit == SHARE]
        self._model = self._learnt()

    def descend(self, phase: Phase, count: float) -> MethodPart[None]:
        """Descend for about `count` placements."""
        while self._free and math.isfinite(self.entropy) and self.count < count:
            fewer = 1.0 - math.log1p(self.count) / math.log1p(count)
            candidates = self._candidates(min(1.0, MOVED / len(self._free)) * fewer)
            if not candidates:
                return
            values = yield from phase.evaluate(candidates)
            self._told(candidates, values)
            if self._model.count >= 2 * MAX_KNOWN:
                self._model = self._learnt()

    def _learnt(self) -> CubicModel:
        """Return a model of known placements with the slots of the best."""
        model, best = CubicModel(len(self._free)), self.best.vector
        known = [
            (self._ranges.point(vector), value)
            for vector, value in zip(self._history.vectors, self._history.values, strict=True)
            if all(vector[k] == best[k] for k in self._slots)
        ]
        at = self._ranges.point(best)
        away = [math.fsum((point - at) ** 2) for point, _ in known]
        nearest = sorted(range(len(known)), key=away.__getitem__)[:MAX_KNOWN]
        for number in nearest:
            model.add(*known[number])
        return model

    def _candidates(self, moved: float) -> list[Candidate]:
        """Return placements that break no rule, each the best by its weight, to be evaluated.

        Each variable is moved with a probability, at least one of them.
        """
        points = self._sampled(moved)
        distances = self._model.distances(points)
        low = _share(self._model.expected(points, distances))
        away = distances.min(axis=0)
        left, chosen = np.ones(SAMPLED, np.bool_), list[Candidate]()
        for _ in range(MAX_SAMPLED):
            weight = MODEL_WEIGHTS[len(chosen)]
            worth = weight * low + (1.0 - weight) * (1.0 - _share(away))
            number = int(np.argmin(np.where(left, worth, np.inf)))
            left[number] = False
            candidate = self._candidate(points[:, number])
            if candidate is None:
                continue
            chosen.append(candidate)
            if len(chosen) == len(MODEL_WEIGHTS):
                break
            between = points - self._ranges.point(candidate.vector)[:, None]
            away = np.minimum(away, np.sqrt((between * between).sum(axis=0)))
        return chosen

    def _sampled(self, moved: float) -> Floats:
        """Return points (D, M) round the best, reflected at the ends of the ranges."""
        shape = (len(self._free), SAMPLED)
        moves = self._rng.random(shape) < moved
        moves[self._rng.integers(shape[0], size=SAMPLED), np.arange(SAMPLED)] |= ~moves.any(axis=0)
        steps = np.where(moves, self._rng.normal(0.0, self._step, shape), 0.0)
        points = np.abs(self._ranges.point(self.best.vector)[:, None] + steps)
        return np.clip(1.0 - np.abs(1.0 - points), 0.0, 1.0)

    def _candidate(self, point: Floats) -> Candidate | None:
        """Return the placement at a point, None if it breaks a rule or is the best one."""
        vector = self._ranges.vector(self.best.vector, point)
        candidate = self._parametrization.candidate(vector)
        moved = candidate.vector != self.best.vector
        return candidate if moved and self._parametrization.allowed(candidate.rig) else None

    def _told(self, candidates: Sequence[Candidate], values: Sequence[float]) -> None:
        """Take values of placements; make the steps longer or shorter."""
        before = self.entropy
        for candidate, value in zip(candidates, values, strict=True):
            self._model.add(self._ranges.point(candidate.vector), value)
        self.told(zip(candidates, values, strict=True))
        if self.entropy < before - GAIN:
            self._gains, self._failures = self._gains + 1, 0
        else:
            self._gains, self._failures = 0, self._failures + len(values)
        if self._gains >= MAX_GAINS:
            self._step, self._gains = min(2.0 * self._step, self._longest), 0
        if self._failures >= max(MIN_FAILURES, len(self._free)):
            self._step = max(self._step / 2.0, self._longest / SHORTEST)
            self._failures = 0


def _cubed(values: Floats) -> Floats:
    """Return cubes; NumPy's own power is not the same on every system."""
    return values * values * values


def _share(values: Floats) -> Floats:
    """Return values from 0 for the lowest to 1 for the highest, or 1 for all if they are equal."""
    low, high = float(values.min()), float(values.max())
    return (values - low) / (high - low) if high > low else np.ones_like(values)
