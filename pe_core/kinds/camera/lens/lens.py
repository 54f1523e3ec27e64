"""What every lens is: a map from directions to places in the picture, and back.

A lens turns round its axis: a direction at an angle theta from the axis falls at a distance
``radius(theta)`` from the principal point, in focal lengths. Beyond the edge of its field the
radius goes on in a straight line, so that what lies across the edge has an image to be cut.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from ....text.values import Angle, Number

Floats = NDArray[np.float64]
Own = TypeVar("Own", bound="Lens")

FOCAL = Number(1e-6, cap=1e12, unit="pixels", noun="focal length")
PLACE = Number(cap=1e7, unit="pixels")
FOV = Angle(0.001, 220.0)
COEFFICIENT = Number(cap=1e6, noun="coefficient")

DEFAULT_EDGE = math.radians(100.0)
"""How far from the axis a lens sees that bends wider than a plane can hold, unless told."""
TABLE = 4096
"""Angles at which a radius is tabulated, to be looked up backwards."""
LEAST_SLOPE = 1e-9
"""At its fold a radius has none."""
ROUNDS = 5
"""Of Newton's method after the look-up: each doubles the digits, and four are there."""
SHIFT_ROUNDS = 15
"""Of taking off the shift found before: each adds a digit or two."""


@dataclass(frozen=True)
class Lens(ABC):
    """A projection.

    Parameters
    ----------
    fx, fy : float
        Focal lengths [px].
    cx, cy : float
        Principal point, from the picture's upper left corner, right and down [px].
    fov : float, optional
        Whole angle of the image circle [rad]; what is farther from the axis is not seen.

    Raises
    ------
    InputError
        When a number is impossible.
    """

    model: ClassVar[str]
    coefficients: ClassVar[tuple[str, ...]] = ()
    """Names of its further numbers, in the order in which files list them."""
    widest: ClassVar[float] = DEFAULT_EDGE
    """No direction farther from the axis is seen [rad], unless `fov` says so."""

    fx: float
    fy: float
    cx: float
    cy: float
    fov: float | None = None
    edge: float = field(init=False, default=0.0, compare=False, repr=False)
    """Angle from the axis up to which it sees [rad]; `reaching` sets it for a picture."""

    def __post_init__(self) -> None:
        for key, rule in (("fx", FOCAL), ("fy", FOCAL), ("cx", PLACE), ("cy", PLACE)):
            object.__setattr__(self, key, rule.checked(self.model, key, getattr(self, key)))
        for key in self.coefficients:
            object.__setattr__(
                self, key, COEFFICIENT.checked(self.model, key, getattr(self, key)) + 0.0
            )
        if self.fov is not None:
            object.__setattr__(self, "fov", FOV.checked(self.model, "fov", self.fov))
        object.__setattr__(self, "edge", self.widest if self.fov is None else self.fov / 2.0)

    @abstractmethod
    def radius(self, theta: Floats) -> Floats:
        """Distance from the principal point in focal lengths at angles up to the edge [rad]."""

    @abstractmethod
    def slope(self, theta: Floats) -> Floats:
        """Derivative of `radius`."""

    def shift(self, theta: Floats, right: Floats, down: Floats) -> tuple[Floats, Floats]:
        """Return what the image is moved by besides, in focal lengths, at an angle up to the edge.

        `right` and `down` are the unit vector away from the principal point.
        """
        return np.zeros_like(theta), np.zeros_like(theta)

    @property
    def is_straight(self) -> bool:
        """Whether straight lines are straight in the picture: a pinhole."""
        return False

    def project(self, depth: Floats, left: Floats, up: Floats) -> tuple[Floats, Floats]:
        """Image position (right, down) [px] of points along the sensor's axes, of any shape."""
        theta, right, down = around_axis(depth, left, up)
        inside = np.minimum(theta, self.edge)
        edge = np.asarray(self.edge)
        reach = self.radius(inside) + self.slope(edge) * (theta - inside)
        more = self.shift(inside, right, down)
        return (
            self.cx + self.fx * (reach * right + more[0]),
            self.cy + self.fy * (reach * down + more[1]),
        )

    def unproject(self, right: Floats, down: Floats) -> Floats:
        """Unit directions (..., 3), forward, left, up, of places in the picture [px].

        NaN where nothing within the field falls.
        """
        x, y = (right - self.cx) / self.fx, (down - self.cy) / self.fy
        x0, y0 = x, y
        for _ in range(SHIFT_ROUNDS if self.shifts else 1):
            away = np.hypot(x, y)
            safe = np.where(away > 0.0, away, 1.0)
            e, n = x / safe, y / safe
            theta = self._angle_at(away)
            moved = self.shift(theta, e, n)
            x, y = x0 - moved[0], y0 - moved[1]
        theta = np.where(away > self._farthest * (1.0 + 1e-12), np.nan, theta)
        sine = np.sin(theta)
        return np.stack([np.cos(theta), -sine * e, -sine * n], axis=-1)

    def density(self, depth: Floats, left: Floats, up: Floats) -> Floats:
        """Pixels a steradian in directions, of any shape; not above 0 where the lens folds."""
        theta, _, _ = around_axis(depth, left, up)
        inside = np.maximum(np.minimum(theta, self.edge), 1e-9)
        around = self.radius(inside) / np.sin(inside)
        return np.asarray(self.fx * self.fy * around * self.slope(inside))

    def within(self: Own, edge: float) -> Own:
        """Return the lens with another edge of its field [rad]."""
        own = replace(self)
        object.__setattr__(own, "edge", edge)
        return own

    @property
    def shifts(self) -> bool:
        """Whether `shift` is not 0 everywhere."""
        return False

    @property
    def _farthest(self) -> float:
        return float(self.radius(np.asarray(self.edge)))

    def _angle_at(self, away: Floats) -> Floats:
        """Angle from the axis whose radius is `away`; the edge beyond."""
        table = np.linspace(0.0, self.edge, TABLE)
        theta = np.interp(away, self.radius(table), table)
        for _ in range(ROUNDS):
            steps = (self.radius(theta) - away) / np.maximum(self.slope(theta), LEAST_SLOPE)
            theta = np.clip(theta - steps, 0.0, self.edge)
        return theta


def around_axis(depth: Floats, left: Floats, up: Floats) -> tuple[Floats, Floats, Floats]:
    """Angle from the axis [rad], and the unit vector away from it, right and down."""
    flat = np.hypot(left, up)
    safe = np.where(flat > 0.0, flat, 1.0)
    return np.arctan2(flat, depth), -left / safe, -up / safe
