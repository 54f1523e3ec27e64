"""Lenses: maps from directions to image positions and back, and their fields in a picture.

A lens is rotationally symmetric: the image of a direction at an angle theta from the axis is at a
distance ``radius(theta)`` from the principal point, in focal lengths. Beyond the edge of the field
the radius continues linearly, so the image of a shape across the edge can be clipped.

Brown-Conrady, as in OpenCV and ROS: with (x, y) the pinhole's image in focal lengths, right and
down, and r its distance from the centre, x and y are scaled by ``(1 + k1 r^2 + k2 r^4 + k3 r^6) /
(1 + k4 r^2 + k5 r^4 + k6 r^6)`` and shifted by ``2 p1 x y + p2 (r^2 + 2 x^2)`` and ``p1 (r^2 + 2
y^2) + 2 p2 x y``.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from typing import ClassVar, TypeVar

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError
from ...base.values import Angle, Number

Own = TypeVar("Own", bound="Lens")
FOCAL = Number(1e-6, cap=1e12, unit="pixels", noun="focal length")
PLACE = Number(cap=1e7, unit="pixels")
FOV = Angle(0.001, 220.0)
COEFFICIENT = Number(cap=1e6, noun="coefficient")
DEFAULT_EDGE = math.radians(100.0)
"""Default angle from the axis of the edge of a lens with a field of view beyond a plane's."""
TABLE = 4096  # Number of angles of the table that inverts a radius
MIN_SLOPE = 1e-9  # At its fold a radius has none
ROUNDS = 5
"""Steps of Newton's method after the look-up: each doubles the digits, of which four are exact."""
SHIFT_ROUNDS = 15  # Iterations that subtract the shift: each adds one or two digits
RINGS = 1100
SPOKES = 32
"""Directions in which a lens is checked: number of angles from the axis, and number round it."""
ROOM_PX = 1e-6
"""A corner beyond the edge of the field by at most this counts as on the edge."""
ALMOST_A_PLANE = math.radians(89.9)
"""Directions farther from the axis are outside any picture."""
WIDEST = math.radians(89.0)
"""Maximum angle from the axis, because r is the tangent of the angle."""


@dataclass(frozen=True)
class Lens(ABC):
    """A projection.

    `InputError` when a number is not possible.

    `fx, fy`: Focal lengths [px].
    `cx, cy`: Principal point, from the picture's upper left corner, right and down [px].
    `fov`: Full angle of the image circle [rad]; directions farther from the axis are not visible.
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
        """Return the additional shift of the image, in focal lengths, at an angle up to the edge.
        `right` and `down` are the unit vector away from the principal point."""
        return np.zeros_like(theta), np.zeros_like(theta)

    @property
    def is_straight(self) -> bool:
        """Whether straight lines are straight in the picture, as through a pinhole."""
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
        """Unit directions (..., 3), forward, left, up, of positions in the picture [px]. NaN for
        positions outside the image of the field."""
        x = (right - self.cx) / self.fx
        y = (down - self.cy) / self.fy
        x0 = x
        y0 = y
        for _ in range(SHIFT_ROUNDS if self.shifts else 1):
            away = np.hypot(x, y)
            safe = np.where(away > 0.0, away, 1.0)
            e = x / safe
            n = y / safe
            theta = self._angle_at(away)
            moved = self.shift(theta, e, n)
            x = x0 - moved[0]
            y = y0 - moved[1]
        theta = np.where(away > self._farthest * (1.0 + 1e-12), np.nan, theta)
        sine = np.sin(theta)
        return np.stack([np.cos(theta), -sine * e, -sine * n], axis=-1)

    def density(self, depth: Floats, left: Floats, up: Floats) -> Floats:
        """Pixels per steradian in directions, of any shape; 0 or less where the lens folds."""
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
        """Whether `shift` is anywhere different from 0."""
        return False

    @property
    def _farthest(self) -> float:
        return float(self.radius(np.asarray(self.edge)))

    def _angle_at(self, away: Floats) -> Floats:
        """Angle from the axis with the radius `away`; at most the edge."""
        table = np.linspace(0.0, self.edge, TABLE)
        theta = np.interp(away, self.radius(table), table)
        for _ in range(ROUNDS):
            steps = (self.radius(theta) - away) / np.maximum(self.slope(theta), MIN_SLOPE)
            theta = np.clip(theta - steps, 0.0, self.edge)
        return theta


def around_axis(depth: Floats, left: Floats, up: Floats) -> tuple[Floats, Floats, Floats]:
    """Angle from the axis [rad], and the unit vector away from it, right and down."""
    flat = np.hypot(left, up)
    safe = np.where(flat > 0.0, flat, 1.0)
    return np.arctan2(flat, depth), -left / safe, -up / safe


def reaching(lens: Own, name: str, width: int, height: int) -> Own:
    """Return the lens with the edge of its field set for a picture of that size. `InputError` when
    it cannot be inverted in all of the picture, or up to its own field of view."""
    folds = fold_angle(lens)
    wanted = lens.edge
    if folds >= wanted:
        return lens
    inner = lens.within(folds)
    if lens.fov is None and _holds(inner, width, height):
        return inner
    right, down = edge_circle(inner)
    radius_px = float(np.min(np.hypot(right - inner.cx, down - inner.cy)))
    found = f"it folds {math.degrees(folds):.2f} deg from the axis, {radius_px:.0f} px"
    most = f"or fov_deg of at most {math.floor(math.degrees(2.0 * folds) * 10.0) / 10.0:g}"
    what = "a lens that can be inverted in all of the picture"
    raise InputError(name, "distortion", f"{what}, {most}", f"{found} from the centre")


def fold_angle(lens: Lens) -> float:
    """Angle from the axis up to which a lens can be inverted [rad]: its edge, or where it folds.

    Pixels per steradian are radius times slope, divided by the sine of the angle. Where the lens
    can be inverted, this is above 0. The contribution of a shift has opposite signs on opposite
    spokes.
    """
    theta = np.linspace(0.0, lens.edge, RINGS + 1)[1:]
    with np.errstate(all="ignore"):
        spokes = SPOKES if lens.shifts else 1
        grows = np.all(lens.density(*_rings(theta, spokes)) > 0.0, axis=1)
        grows &= lens.radius(theta) > 0.0
    bad = np.flatnonzero(~grows)
    if not len(bad):
        return lens.edge
    return float(theta[bad[0] - 1]) if bad[0] else 0.0


def edge_circle(lens: Lens, spokes: int = SPOKES) -> tuple[Floats, Floats]:
    """Image (right, down) [px] of directions on the edge of a lens's field, (spokes,) each."""
    depth, left, up = _rings(np.array([lens.edge]), spokes)
    right, down = lens.project(depth, left, up)
    return right[0], down[0]


def field_outline(lens: Lens, width: int, height: int, places: int) -> Floats:
    """(N, 3) unit directions, forward, left, up, on the border of the view, clockwise as seen.
    There are `places` of them along each side of the picture. Where the border of the picture is
    outside the field, the edge of the field takes its place."""
    share = np.arange(places) / places
    none = np.zeros(places)
    all_ = np.ones(places)
    right = np.concatenate([share, all_, 1.0 - share, none]) * width
    down = np.concatenate([none, share, all_, 1.0 - share]) * height
    found = lens.unproject(right, down)
    x = (right - lens.cx) / lens.fx
    y = (down - lens.cy) / lens.fy
    away = np.maximum(np.hypot(x, y), 1e-12)
    sine = math.sin(lens.edge)
    edge = np.stack([np.full(len(x), math.cos(lens.edge)), -sine * x / away, -sine * y / away], 1)
    return np.where(np.isnan(found[:, :1]), edge, found)


def _rings(theta: Floats, spokes: int = SPOKES) -> tuple[Floats, Floats, Floats]:
    """Directions in rings round the axis, at angles (R,) from it, (R, spokes) each."""
    turn = np.linspace(0.0, 2.0 * math.pi, spokes, endpoint=False)
    flat = np.sin(theta)[:, None]
    depth = np.broadcast_to(np.cos(theta)[:, None], (len(theta), spokes))
    return depth, flat * np.cos(turn), flat * np.sin(turn)


def _holds(lens: Lens, width: int, height: int) -> bool:
    """Whether the whole picture lies within the edge of the field."""
    right, down = edge_circle(lens, 720)
    turn = np.arctan2(down - lens.cy, right - lens.cx)
    away = np.hypot(down - lens.cy, right - lens.cx)
    order = np.argsort(turn)
    for x, y in ((0, 0), (width, 0), (width, height), (0, height)):
        corner = math.atan2(y - lens.cy, x - lens.cx)
        reach = np.interp(corner, turn[order], away[order], period=2.0 * math.pi)
        if math.hypot(y - lens.cy, x - lens.cx) > reach + ROOM_PX:
            return False
    return True


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
        square = np.tan(theta) ** 2
        both = 2.0 * right * down
        x = self.p1 * both + self.p2 * (1.0 + 2.0 * right * right)
        y = self.p1 * (1.0 + 2.0 * down * down) + self.p2 * both
        return np.asarray(square * x), np.asarray(square * y)

    def density(self, depth: Floats, left: Floats, up: Floats) -> Floats:
        """Determinant of the distortion's Jacobian, divided by the cubed cosine."""
        theta, e, n = around_axis(depth, left, up)
        r = np.tan(np.minimum(theta, self.edge))
        above, below = self._sums(r * r)
        factor = above / below
        growth = self._growth(r * r)
        bend = growth - factor  # the derivative of the radial part along r is factor + bend
        x = r * e
        y = r * n
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
