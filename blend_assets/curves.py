"""Curves and soft steps from which the shapes of the vehicles are drawn."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray
Field = Callable[[Array], Array]  # a number for each of the points (n, 3)


class Curve:
    """A natural cubic spline through (position, value) pairs, straight outside of them."""

    def __init__(self, *pairs: tuple[float, float]) -> None:
        self.x, self.y = np.array(sorted(pairs), dtype=float).T
        self.second = self._second_derivatives()

    def _second_derivatives(self) -> Array:
        step = np.diff(self.x)
        n = len(self.x)
        system = np.eye(n)
        right = np.zeros(n)
        slope = np.diff(self.y) / step
        for i in range(1, n - 1):
            system[i, i - 1 : i + 2] = step[i - 1], 2 * (step[i - 1] + step[i]), step[i]
            right[i] = 6 * (slope[i] - slope[i - 1])
        return np.linalg.solve(system, right)

    def __call__(self, at: Array | float) -> Array:
        inside = np.clip(at, self.x[0], self.x[-1])
        i = np.clip(np.searchsorted(self.x, inside) - 1, 0, len(self.x) - 2)
        step = self.x[i + 1] - self.x[i]
        b = (inside - self.x[i]) / step
        a = 1 - b
        bend = (a**3 - a) * self.second[i] + (b**3 - b) * self.second[i + 1]
        value = a * self.y[i] + b * self.y[i + 1] + bend * step**2 / 6
        slope = (self.y[i + 1] - self.y[i]) / step + step / 6 * (
            (3 * b * b - 1) * self.second[i + 1] - (3 * a * a - 1) * self.second[i]
        )
        return value + (np.asarray(at) - inside) * slope


def smooth_max(a: Array, b: Array, radius: Array | float) -> Array:
    """The larger of two, with the corner rounded over about this radius."""
    overlap = np.maximum(radius - np.abs(a - b), 0) / radius
    return np.maximum(a, b) + overlap**2 * radius / 4


def step(x: Array, start: float, stop: float) -> Array:
    """A smooth ramp from 0 at `start` to 1 at `stop`."""
    t = np.clip((x - start) / (stop - start), 0, 1)
    return t * t * (3 - 2 * t)


def bump(x: Array, centre: float, width: float) -> Array:
    """A bell of height one."""
    return np.exp(-(((x - centre) / width) ** 2))
