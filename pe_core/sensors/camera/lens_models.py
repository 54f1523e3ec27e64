"""Lens models: pinhole, Brown-Conrady, Kannala-Brandt and f-theta.

Brown-Conrady, as in OpenCV and ROS: with (x, y) the pinhole's image in focal lengths, right and
down, and r its distance from the centre, x and y are scaled by ``(1 + k1 r^2 + k2 r^4 + k3 r^6) /
(1 + k4 r^2 + k5 r^4 + k6 r^6)`` and shifted by ``2 p1 x y + p2 (r^2 + 2 x^2)`` and ``p1 (r^2 + 2
y^2) + 2 p2 x y``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import Floats
from .lens import Lens, around_axis

ALMOST_A_PLANE = math.radians(89.9)
"""Directions farther from the axis are outside any picture."""


@dataclass(frozen=True)
class Pinhole(Lens):
    """A camera without distortion, eq. 3: ``radius = tan(theta)``."""

    model: ClassVar[str] = "pinhole"
    widest: ClassVar[float] = ALMOST_A_PLANE

    @property
    def is_straight(self) -> bool:
        """True: a pinhole has no distortion."""
        return self.fov is None

    def radius(self, theta: Floats) -> Floats:
        """Tangent of the angle."""
        return np.asarray(np.tan(theta))

    def slope(self, theta: Floats) -> Floats:
        """One over the squared cosine."""
        return np.asarray(np.cos(theta) ** -2)


WIDEST = math.radians(89.0)
"""Maximum angle from the axis, because r is the tangent of the angle."""


@dataclass(frozen=True)
class BrownConrady(Lens):
    """A pinhole with radial (k1 to k6) and tangential (p1, p2) distortion."""

    model: ClassVar[str] = "brown-conrady"
    coefficients: ClassVar[tuple[str, ...]] = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
    widest: ClassVar[float] = WIDEST

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0
    k5: float = 0.0
    k6: float = 0.0

    @property
    def is_straight(self) -> bool:
        """Whether there is no distortion."""
        return self.fov is None and not any(getattr(self, key) for key in self.coefficients)

    def radius(self, theta: Floats) -> Floats:
        """Tangent of the angle times the radial factor."""
        r = np.tan(theta)
        above, below = self._sums(r * r)
        return np.asarray(r * above / below)

    def slope(self, theta: Floats) -> Floats:
        """Derivative of `radius`, by the quotient rule and the chain rule."""
        r = np.tan(theta)
        return np.asarray(self._growth(r * r) * (1.0 + r * r))

    def shift(self, theta: Floats, right: Floats, down: Floats) -> tuple[Floats, Floats]:
        """Return the tangential part."""
        square, both = np.tan(theta) ** 2, 2.0 * right * down
        x = self.p1 * both + self.p2 * (1.0 + 2.0 * right * right)
        y = self.p1 * (1.0 + 2.0 * down * down) + self.p2 * both
        return np.asarray(square * x), np.asarray(square * y)

    def density(self, depth: Floats, left: Floats, up: Floats) -> Floats:
        """Determinant of the distortion's Jacobian, divided by the cubed cosine."""
        theta, e, n = around_axis(depth, left, up)
        r = np.tan(np.minimum(theta, self.edge))
        above, below = self._sums(r * r)
        factor, growth = above / below, self._growth(r * r)
        bend = growth - factor  # the derivative of the radial part along r is factor + bend
        x, y = r * e, r * n
        xx = factor + bend * e * e + 2.0 * self.p1 * y + 6.0 * self.p2 * x
        yy = factor + bend * n * n + 6.0 * self.p1 * y + 2.0 * self.p2 * x
        xy = bend * e * n + 2.0 * self.p1 * x + 2.0 * self.p2 * y
        return np.asarray(self.fx * self.fy * (xx * yy - xy * xy) * (1.0 + r * r) ** 1.5)

    @property
    def shifts(self) -> bool:
        """Whether there is a tangential part."""
        return bool(self.p1 or self.p2)

    def _sums(self, square: Floats) -> tuple[Floats, Floats]:
        """Numerator and denominator of the radial factor."""
        above = 1.0 + square * (self.k1 + square * (self.k2 + square * self.k3))
        return above, 1.0 + square * (self.k4 + square * (self.k5 + square * self.k6))

    def _growth(self, square: Floats) -> Floats:
        """Derivative of r times the radial factor with respect to r."""
        above, below = self._sums(square)
        up = square * (self.k1 + square * (2.0 * self.k2 + square * 3.0 * self.k3))
        down = square * (self.k4 + square * (2.0 * self.k5 + square * 3.0 * self.k6))
        return np.asarray((above + 2.0 * up) / below - 2.0 * above * down / (below * below))


@dataclass(frozen=True)
class KannalaBrandt(Lens):
    """``radius = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)``."""

    model: ClassVar[str] = "kannala-brandt"
    coefficients: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3", "k4")

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0

    def radius(self, theta: Floats) -> Floats:
        """Odd polynomial of the angle."""
        s = theta * theta
        return np.asarray(
            theta * (1.0 + s * (self.k1 + s * (self.k2 + s * (self.k3 + s * self.k4))))
        )

    def slope(self, theta: Floats) -> Floats:
        """Derivative of `radius`."""
        s = theta * theta
        k = 3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3, 9.0 * self.k4
        return np.asarray(1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))))


@dataclass(frozen=True)
class FTheta(Lens):
    """``radius = k1 theta + k2 theta^2 + ... + k6 theta^6`` [px].

    `fx` and `fy` scale the radius; they are usually 1.
    """

    model: ClassVar[str] = "f-theta"
    coefficients: ClassVar[tuple[str, ...]] = ("k1", "k2", "k3", "k4", "k5", "k6")

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0
    k5: float = 0.0
    k6: float = 0.0

    def radius(self, theta: Floats) -> Floats:
        """Polynomial of the angle, 0 at 0."""
        return np.asarray(np.polyval([*self._falling, 0.0], theta))

    def slope(self, theta: Floats) -> Floats:
        """Derivative of `radius`."""
        falling = [n * k for n, k in zip(range(6, 0, -1), self._falling, strict=True)]
        return np.asarray(np.polyval(falling, theta))

    @property
    def _falling(self) -> list[float]:
        return [getattr(self, key) for key in reversed(self.coefficients)]


LENSES: dict[str, type[Lens]] = {
    each.model: each for each in (Pinhole, BrownConrady, KannalaBrandt, FTheta)
}
"""Lens models by their name in studies."""
