"""Linear descent: all sensors at once, down a linear model in a trust region that shrinks.

The model interpolates the values at the corners of a simplex: N + 1 placements for N variables
(M. J. D. Powell, A direct search optimization method that models the objective and constraint
functions by linear interpolation, 1994; here without constraints). Each question has two
placements: a step down the model, and a corner that makes the simplex better.

Variables are scaled by their ranges, so the first steps are as long as the space is wide. A step
that breaks a rule is made shorter, or is made to the other side, which costs no evaluation.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...base.arrays import Floats
from ..domains import SHARE
from ..parametrization import Candidate, Vector
from .method import Given, Incumbent, MethodPart, Phase

LEAST_HEIGHT, LONGEST, NEW_HEIGHT = 0.25, 2.1, 0.5
"""Powell's alpha, beta, gamma: least height and longest edge of a simplex, and the height of a new
corner, in radii."""
GAINED = 0.1
"""Share of the predicted decrease below which the radius is halved, if the simplex is good."""
STEP_SHARES = (1.0, 0.5, 0.25)
EDGE_SHARES = (1.0, -1.0, 0.5, -0.5, 0.25, -0.25)
"""Shares of a step, and of an edge, that are tried until a placement breaks no rule."""
FAR = 1.1
"""Powell's delta: a corner that is so far away, in radii, gives way to a new one first."""
FLAT = 1e-3
"""A new corner is at least so high above the others, in the old one's heights."""
SLACK, DIGITS = 1e-9, 9
"""Rounding: a simplex is evaluated alike on every system."""
NO_EDGE = 0.01
"""Length of an edge along a variable that cannot be changed, in radii."""


class UnitRanges:
    """The variables that have a range, scaled by it: `free`. Slots and fixed variables stay."""

    def __init__(self, given: Given) -> None:
        variables = given.parametrization.variables
        each = list(enumerate(variables))
        self.free = [k for k, v in each if v.low < v.high and v.unit != SHARE]
        self._low = np.array([variables[k].low for k in self.free])
        self._range = np.array([variables[k].high for k in self.free]) - self._low

    def point(self, vector: Vector) -> Floats:
        """Return the point (N,) of a vector."""
        return np.asarray((np.array([vector[k] for k in self.free]) - self._low) / self._range)

    def vector(self, base: Vector, point: Floats) -> list[float]:
        """Return the vector at a point (N,), the other variables as in the base."""
        vector = list(base)
        for k, value in zip(self.free, self._low + point * self._range, strict=True):
            vector[k] = float(value)
        return vector


class LinearDescent(Incumbent):
    """A linear descent from a placement; `radius` of the trust region is a share of the ranges."""

    def __init__(self, given: Given, start: Candidate, entropy: float, radius: float) -> None:
        super().__init__(start, entropy)
        self.radius = radius
        self._parametrization, self._ranges = given.parametrization, UnitRanges(given)
        self._free = self._ranges.free
        at = {k: number for number, k in enumerate(self._free)}
        blocks = ([at[k] for k in block if k in at] for block in given.parametrization.blocks)
        self._blocks = [block for block in blocks if block]
        self._pole, self._value = self._ranges.point(start.vector), entropy
        self._edges = np.eye(len(self._free))
        self._rises = np.zeros(len(self._free))

    def descend(self, phase: Phase, count: float, finest: float) -> MethodPart[None]:
        """Descend for about `count` placements, until the radius is below `finest`."""
        end = self.count + count
        for block in self._blocks:
            if self.count < end:
                yield from self._first_edges(phase, block)
        while self._free and self.count < end and self.radius >= finest:
            yield from self._iterate(phase)

    def _first_edges(self, phase: Phase, block: Sequence[int]) -> MethodPart[None]:
        """Evaluate a step along each variable of one sensor, from the best so far."""
        edges = [self.radius * row for row in np.eye(len(self._free))[list(block)]]
        moves = [self._feasible(edge, EDGE_SHARES) for edge in edges]
        values = iter((yield from self._evaluate(phase, [move for move in moves if move])))
        before = self._value
        for number, edge, move in zip(block, edges, moves, strict=True):
            self._edges[number] = NO_EDGE * edge if move is None else move[0]
            self._rises[number] = 0.0 if move is None else next(values) - before
        for number in range(block[-1] + 1, len(self._free)):
            self._edges[number] = self.radius * np.eye(len(self._free))[number]
        self._to_best(range(block[-1] + 1))

    def _iterate(self, phase: Phase) -> MethodPart[None]:
        """Evaluate a step down the model and a better corner; update the simplex."""
        heights, lengths, inverse = self._geometry()
        high = float(heights.min()) >= (LEAST_HEIGHT - SLACK) * self.radius
        farthest = int(np.argmax(lengths))
        too_far = lengths[farthest] > (LONGEST + SLACK) * self.radius
        gradient = _times(self._rises, inverse.T)
        slope = math.sqrt(math.fsum(gradient * gradient))
        step = corner = None
        if slope > 0.0:
            step = self._feasible(-self.radius / slope * gradient, STEP_SHARES)
        number = farthest if too_far else int(np.argmin(heights))
        if not high or too_far or step is None:
            normal = heights[number] * inverse[:, number]
            downhill = math.fsum(gradient * normal) <= 0.0
            edge = (NEW_HEIGHT if downhill else -NEW_HEIGHT) * self.radius * normal
            corner = self._feasible(edge, EDGE_SHARES)
            if corner is not None and abs(math.fsum(corner[0] * inverse[:, number])) < FLAT:
                corner = None  # clipped to the plane of the other corners
        moves = [move for move in (step, corner) if move is not None]
        pole, before = self._pole.copy(), self._value
        values = yield from self._evaluate(phase, moves)
        if corner is not None:
            self._replace(number, pole + corner[0], values[-1])
        gained = predicted = 0.0
        if step is not None:
            self._insert(pole + step[0], values[0])
            gained, predicted = before - values[0], -math.fsum(gradient * step[0])
        if corner is None and (step is None or gained < GAINED * predicted):
            self.radius /= 2.0

    def _geometry(self) -> tuple[Floats, Floats, Floats]:
        """Return heights and lengths of the edges (N,), and the inverse (N, N) of all edges.

        Heights and lengths are rounded, so that equal ones are equal on every system.
        """
        inverse, digits = _inverse(self._edges), DIGITS - math.floor(math.log10(self.radius))
        heights = 1.0 / np.sqrt((inverse * inverse).sum(axis=0))
        turned = np.ascontiguousarray(self._edges.T)
        lengths = np.sqrt((turned * turned).sum(axis=0))
        return heights.round(digits), lengths.round(digits), inverse

    def _insert(self, point: Floats, value: float) -> None:
        """Put a point in place of a corner, where the simplex stays good or the value is lower."""
        heights, lengths, inverse = self._geometry()
        move = point - self._pole
        shares = np.abs(_times(move, inverse)).round(DIGITS)
        lower = value < self._value
        between = np.ascontiguousarray((self._edges - move).T)
        away = np.sqrt((between * between).sum(axis=0)) if lower else lengths
        stays_high = shares * heights >= (LEAST_HEIGHT - SLACK) * self.radius
        far = (stays_high | (shares >= 1.0)) & (away > (FAR + SLACK) * self.radius)
        if far.any():
            self._replace(int(np.argmax(np.where(far, away, -1.0))), point, value)
        elif lower or float(shares.max()) > 1.0:
            self._replace(int(np.argmax(shares)), point, value)

    def _replace(self, number: int, point: Floats, value: float) -> None:
        self._edges[number], self._rises[number] = point - self._pole, value - self._value
        self._to_best(range(len(self._rises)))

    def _to_best(self, corners: range) -> None:
        """Make the best of the corners the pole, from which edges are counted."""
        lowest = int(np.argmin(self._rises[: corners.stop]))
        rise = self._rises[lowest]
        if rise < 0.0:
            edge = self._edges[lowest].copy()
            self._pole, self._value = self._pole + edge, self._value + rise
            self._edges[: corners.stop] -= edge
            self._edges[lowest] = -edge
            self._rises[: corners.stop] -= rise
            self._rises[lowest] = -rise

    def _feasible(self, move: Floats, shares: Sequence[float]) -> tuple[Floats, Candidate] | None:
        """Return the first share of a move that breaks no rule, and its placement."""
        length = float(np.abs(move).max())
        for share in shares:
            point = np.clip(self._pole + share * move, 0.0, 1.0)
            moved = point - self._pole
            if float(np.abs(moved).max()) < 0.1 * abs(share) * length:
                continue  # it is at the end of its range
            vector = self._ranges.vector(self.best.vector, point)
            candidate = self._parametrization.candidate(vector)
            if self._parametrization.allowed(candidate.rig):
                return moved, candidate
        return None

    def _evaluate(
        self, phase: Phase, moves: Sequence[tuple[Floats, Candidate]]
    ) -> MethodPart[list[float]]:
        """Return the values of moves."""
        candidates = [candidate for _, candidate in moves]
        values = (yield from phase.evaluate(candidates)) if candidates else []
        self.told(zip(candidates, values, strict=True))
        return values


def _times(vector: Floats, matrix: Floats) -> Floats:
    """Return a vector (N,) times a matrix (N, N), summed in the same order on every system."""
    return np.asarray((vector[:, None] * matrix).sum(axis=0))


def _inverse(matrix: Floats) -> Floats:
    """Return the inverse (N, N) by Gauss and Jordan's method: the same bits on every system."""
    count = len(matrix)
    work = np.concatenate([matrix, np.eye(count)], axis=1)
    for k in range(count):
        pivot = k + int(np.argmax(np.abs(work[k:, k])))
        if pivot != k:
            work[[k, pivot]] = work[[pivot, k]]
        work[k] /= work[k, k]
        factors = work[:, k].copy()
        factors[k] = 0.0
        work -= factors[:, None] * work[k]
    return np.ascontiguousarray(work[:, count:])
