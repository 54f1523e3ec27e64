"""The prior p_S(s): how likely a voxel belongs to an object, after focus weights w(s, c).

Each class is a density over the ground times a profile over height, so no weight is ever stored for
every one of 64 million voxels.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import InputError
from .space import PerceptionSpace

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ObjectClass:
    """One kind of object on the road: its box and where its centre is met.

    The centre's density is ``exp(-|x| / decay_x) * (w Laplace(y; laplace_y) + (1 - w) N(y;
    gauss_y))`` with w = `laplace_share`, round the vehicle's centre; the box stands on the ground
    along x; heights scatter normally.

    Parameters
    ----------
    name : str
    size : (length, width, height) float
        Mean box [m].
    height_spread : float
        Standard deviation of the height [m].
    decay_x, laplace_y, gauss_y : float
        Scales of the density [m].
    laplace_share : float
        w, 0 to 1.
    """

    name: str
    size: tuple[float, float, float]
    height_spread: float
    decay_x: float
    laplace_y: float
    gauss_y: float
    laplace_share: float


ROAD_CLASSES = (
    ObjectClass("car", (4.6, 1.9, 1.7), 0.195, 39.4, 12.82, 20.03, 0.533),
    ObjectClass("pedestrian", (0.8, 0.7, 1.75), 0.120, 32.2, 659.55, 16.15, 0.171),
    ObjectClass("cyclist", (1.76, 0.65, 1.74), 0.267, 28.7, 170.45, 14.89, 0.033),
    ObjectClass("truck", (7.5, 2.55, 3.0), 0.785, 58.5, 20.1, 22.33, 0.365),
    ObjectClass("cone", (0.4, 0.4, 0.9), 0.232, 14.8, 34.25, 10.05, 0.024),
)
"""Positions: fitted by maximum likelihood to the boxes with a score of 0.4 and more that
CenterPoint finds in the 150 scenes of nuScenes val (boxes from the public AB3DMOT repository).
Height spreads: the same boxes. Sizes: rounded between the means of nuScenes, Argoverse 2 and
Waymo's anchor boxes."""


@dataclass(frozen=True, slots=True)
class Focus:
    """A factor of w(s, c): counts a region, or some classes, more or less.

    Parameters
    ----------
    factor : float
        At least 0. Where regions overlap, factors multiply.
    x, y : (low, high) float
        Region of the ground [m]; infinite by default.
    classes : sequence of str, optional
        Which classes; all by default.
    """

    factor: float
    x: tuple[float, float] = (-math.inf, math.inf)
    y: tuple[float, float] = (-math.inf, math.inf)
    classes: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.factor) and self.factor >= 0.0):
            raise InputError("focus", "factor", "a finite number >= 0", self.factor)
        for name in "xy":
            low, high = getattr(self, name)
            if not low < high:
                raise InputError("focus", name, "two numbers, low before high", [low, high])


@dataclass(frozen=True, slots=True)
class ClassDensity:
    """One class on one space: p(i, j, k) = ground[i, j] * profile[k], focus weights included.

    `ground` (nx, ny) holds the class's share of the whole prior; `profile` (nz,) sums to 1.
    """

    name: str
    ground: Floats
    profile: Floats


@dataclass(frozen=True, slots=True)
class Prior:
    """A prior: a model's name, its classes, and the focus. Use `road` or `uniform`."""

    model: str
    classes: tuple[ObjectClass, ...] = ()
    focus: tuple[Focus, ...] = ()

    def __post_init__(self) -> None:
        for focus in self.focus:
            for name in focus.classes or ():
                if name not in self.class_names:
                    expected = f"one of {', '.join(self.class_names)}"
                    raise InputError("focus", "classes", expected, repr(name))

    @classmethod
    def road(cls, focus: Sequence[Focus] = ()) -> Prior:
        """Cars, pedestrians, cyclists, trucks and cones, as met on public roads; equal shares."""
        return cls("road", ROAD_CLASSES, tuple(focus))

    @classmethod
    def uniform(cls, focus: Sequence[Focus] = ()) -> Prior:
        """Every voxel counts the same."""
        return cls("uniform", (), tuple(focus))

    @property
    def class_names(self) -> tuple[str, ...]:
        """Names of the classes; ``("any",)`` for the uniform prior."""
        return tuple(c.name for c in self.classes) or ("any",)

    def densities(self, space: PerceptionSpace) -> list[ClassDensity]:
        """p_S class by class; all of it sums to 1.

        Each class's own distribution sums to 1 before its focus weights (the paper's p_Sc), so
        without focus the classes share alike.

        Raises
        ------
        InputError
            When nothing is left of the prior after the focus weights.
        """
        shapes = [_class_shape(c, space) for c in self.classes] or [_uniform_shape(space)]
        grounds = [
            ground * self._weights(name, space)
            for name, (ground, _) in zip(self.class_names, shapes, strict=True)
        ]
        total = sum(float(g.sum()) for g in grounds)
        if not total > 0.0:
            raise InputError("prior", "focus", "some weight left in the space", "none")
        return [
            ClassDensity(name, ground / total, profile)
            for name, ground, (_, profile) in zip(self.class_names, grounds, shapes, strict=True)
        ]

    def _weights(self, name: str, space: PerceptionSpace) -> Floats:
        """w(s, c) over the ground (nx, ny)."""
        weights = np.ones(space.shape[:2])
        x, y = space.centers(0), space.centers(1)
        for focus in self.focus:
            if focus.classes is None or name in focus.classes:
                rows = (x > focus.x[0]) & (x < focus.x[1])
                columns = (y > focus.y[0]) & (y < focus.y[1])
                weights[np.ix_(rows, columns)] *= focus.factor
        return weights


def _uniform_shape(space: PerceptionSpace) -> tuple[Floats, Floats]:
    nx, ny, nz = space.shape
    return np.full((nx, ny), 1.0 / (nx * ny)), np.full(nz, 1.0 / nz)


def _class_shape(cls: ObjectClass, space: PerceptionSpace) -> tuple[Floats, Floats]:
    """Ground density (nx, ny) and height profile (nz,) of voxelised boxes, each summing to 1."""
    length, width, height = cls.size
    along = _blurred(lambda x: _exponential_mass(x, cls.decay_x), space.centers(0), length)
    across = _blurred(lambda y: _lateral_mass(y, cls), space.centers(1), width)
    ground = along[:, None] * across
    profile = np.array(
        [1.0 - _normal_cdf((z - height) / cls.height_spread) for z in space.centers(2).tolist()]
    )
    return ground / ground.sum(), profile / profile.sum()


def _blurred(mass: Callable[[float], float], centers: Floats, size: float) -> Floats:
    """Density of being inside a box of that size whose centre has the cumulative `mass`."""
    return np.array([mass(c + size / 2.0) - mass(c - size / 2.0) for c in centers.tolist()])


def _exponential_mass(x: float, scale: float) -> float:
    """Integral of exp(-|x| / scale) from 0 to x."""
    return math.copysign(scale * -math.expm1(-abs(x) / scale), x)


def _lateral_mass(y: float, cls: ObjectClass) -> float:
    laplace = 0.5 * math.copysign(-math.expm1(-abs(y) / cls.laplace_y), y)
    return cls.laplace_share * laplace + (1.0 - cls.laplace_share) * _normal_cdf(y / cls.gauss_y)


def _normal_cdf(z: float) -> float:
    return 0.5 * (1.0 + math.erf(z / math.sqrt(2.0)))
