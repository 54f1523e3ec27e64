"""Kriging: a smooth value at all points from noisy values at some, with its standard error.

Ordinary kriging (Matheron 1963) with a squared-exponential covariance. The mean is unknown, the
variance of the noise is known up to a factor. Range, variance and factor are those of the greatest
likelihood on a small grid (Rasmussen and Williams 2006, eq. 5.8).
"""

import math
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from pe_core.base.arrays import Floats

NOISE = (1.0, 3.0, 9.0)
"""Factors on the variance of the noise: values may be rougher than their errors tell."""
VARIANCE = (0.5, 3.0)  # Factors on the variance of the values
SMOOTHEST = 1e-3
"""The noise is at least this share of the values' scatter; exact values are no smooth function."""
AT_ONCE = 8192


@dataclass(frozen=True, slots=True)
class Kriging:
    """Noisy values at points, and the smooth function through them.

    `points` (N, K): Where values are known.
    `length`: Range of the covariance, in the unit of the points.
    `variance, noise`: Of the function, and (N,) of the values round it.
    """

    points: Floats
    length: float
    variance: float
    noise: Floats
    _inverse: Floats = field(repr=False)
    _weights: Floats = field(repr=False)
    _mean: float
    _mean_variance: float

    @classmethod
    def fit(
        cls, points: Floats, values: Floats, noise: Floats, lengths: tuple[float, ...]
    ) -> "Kriging":
        """Return the most likely one.

        Parameters
        ----------
        points : (N, K) float
        values : (N,) float
        noise : (N,) float
            Variances of the values.
        lengths : tuple of float
            Ranges of the covariance that are tried.
        """
        scatter = max(float(np.var(values)), 1e-18)
        floor = np.maximum(noise, SMOOTHEST**2 * scatter)
        square = _squares(points, points)
        tried = []
        for length, variance, factor in product(lengths, VARIANCE, NOISE):
            own = cls._solved(
                points,
                values,
                noise=factor * floor,
                square=square,
                length=length,
                variance=variance * scatter,
            )
            tried.append(own)
        _, best = max(tried, key=lambda each: each[0])
        return best

    @classmethod
    def _solved(
        cls,
        points: Floats,
        values: Floats,
        noise: Floats,
        square: Floats,
        length: float,
        variance: float,
    ) -> "tuple[float, Kriging]":
        """Return the logarithm of the likelihood, and the function."""
        covariance = variance * np.exp(-0.5 * square / length**2) + np.diag(noise)
        lower = np.linalg.cholesky(covariance)
        inverse = np.linalg.inv(lower)
        inverse = inverse.T @ inverse
        ones = inverse.sum(axis=1)
        mean = float(ones @ values) / float(ones.sum())
        weights = inverse @ (values - mean)
        likelihood = -0.5 * float((values - mean) @ weights) - float(np.log(np.diag(lower)).sum())
        own = cls(
            points,
            length,
            variance,
            noise=noise,
            _inverse=inverse,
            _weights=weights,
            _mean=mean,
            _mean_variance=1.0 / float(ones.sum()),
        )
        return likelihood, own

    @property
    def roughness(self) -> float:
        """Standard deviation of values round the smooth function, the least noisy value's."""
        return math.sqrt(float(self.noise.min()))

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Return values (M,) at points (M, K), and their standard errors (M,)."""
        values = np.empty(len(points))
        errors = np.empty(len(points))
        for start in range(0, len(points), AT_ONCE):
            part = slice(start, start + AT_ONCE)
            square = _squares(points[part], self.points)
            near = self.variance * np.exp(-0.5 * square / self.length**2)
            solved = near @ self._inverse
            values[part] = self._mean + near @ self._weights
            lack = 1.0 - solved.sum(axis=1)  # of what the unknown mean adds
            variance = self.variance - (solved * near).sum(axis=1)
            variance += lack**2 * self._mean_variance
            errors[part] = np.sqrt(np.maximum(variance, 0.0))
        return values, errors


def _squares(one: Floats, other: Floats) -> Floats:
    """Return squared distances (N, M) of points."""
    square = (one**2).sum(axis=1)[:, None] + (other**2).sum(axis=1) - 2.0 * (one @ other.T)
    return np.maximum(square, 0.0)
