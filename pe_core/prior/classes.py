"""Classes of objects on the road, and the densities of their positions."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Floats, mapped
from ..base.errors import InputError, shown
from ..base.values import A_NAME, LENGTH, SHARE, WEIGHT, Number, listed, real, vector
from ..geometry.grids import PerceptionSpace

Shape = tuple[Floats, Floats]
"""Density over the ground (nx, ny) and profile over height (nz,), each summing to 1."""

SPREAD = Number(0.0, cap=1e9, unit="m", noun="length")
RULES = {
    **dict.fromkeys(("height_spread", "decay_x", "laplace_y", "gauss_y"), LENGTH),
    "laplace_share": SHARE,
    "share": WEIGHT,
    **dict.fromkeys(("length_spread", "width_spread"), SPREAD),
    "any_heading": SHARE,
}
LANE = Number(cap=1e9, unit="m")
LANE_M = 3.75
"""Width of a motorway's lane: Germany's RAA; an Interstate's is 12 ft (3.66 m)."""
LANES = (-LANE_M, 0.0, LANE_M)
"""Middles of three lanes; the vehicle drives in the middle one. An assumption."""
LANE_EDGES = (-1.5 * LANE_M, -0.5 * LANE_M, 0.5 * LANE_M, 1.5 * LANE_M)
IN_LANE_M = 0.3
"""Standard deviation of a vehicle's position across its lane. An assumption."""
OFF_LANES = 0.2
"""Share of vehicles elsewhere: ramps, shoulders, the other carriageway. An assumption."""
OFF_LANES_M = 13.93
"""Their lateral scale: that of cars in KITTI tracking (Laplace share 0.73)."""
CELLS = 2048
"""Cells of a table of masses along an axis: 8 and 4 cm in the paper's space."""


@dataclass(frozen=True, slots=True)
class ObjectClass:
    """One class of objects: its mean box, and the density of its centre.

    The density is ``exp(-|x| / decay_x) * (w Laplace(y; laplace_y) + (1 - w) N(y;
    gauss_y))`` with w = `laplace_share`, about the vehicle's centre; with `lanes`, the mean of such
    densities about the middle of each lane. The box stands on the ground, along x. Heights are
    normally distributed.

    `InputError` when a length is not positive, or a share is out of range.

    Parameters
    ----------
    size : (length, width, height) float
        Mean box [m].
    height_spread : float
        Standard deviation of the height [m].
    decay_x, laplace_y, gauss_y : float
        Scales of the density [m].
    laplace_share : float
        w, 0 to 1.
    lanes : sequence of float
        y of the middle of each lane [m]; a lane given twice counts twice.
    share : float
        Mass relative to the other classes, before focus weights; equal for all in the paper.
    length_spread, width_spread : float
        Standard deviations of length and width of sampled objects [m]; voxels use the mean.
    any_heading : float
        Share of sampled objects with a random heading, 0 to 1; the others stand along x.
    """

    name: str
    size: tuple[float, float, float]
    height_spread: float
    decay_x: float
    laplace_y: float
    gauss_y: float
    laplace_share: float
    lanes: tuple[float, ...] = (0.0,)
    share: float = 1.0
    length_spread: float = 0.0
    width_spread: float = 0.0
    any_heading: float = 0.0

    def __post_init__(self) -> None:
        who = f"prior class {A_NAME.checked('prior class', 'name', self.name)!r}"
        object.__setattr__(self, "size", vector(who, "size", self.size, count=3, rule=LENGTH))
        for name, rule in RULES.items():
            object.__setattr__(self, name, rule.checked(who, name, getattr(self, name)))
        lanes = listed(self.lanes) or []
        if not lanes or not all(LANE.holds(real(lane)) for lane in lanes):
            raise InputError(who, "lanes", "one or more finite numbers", shown(self.lanes))
        object.__setattr__(self, "lanes", tuple(map(real, lanes)))


FIELDS = tuple(field.name for field in fields(ObjectClass))


ROAD_CLASSES = (
    ObjectClass(
        "car",
        (4.6, 1.9, 1.7),
        height_spread=0.195,
        decay_x=39.4,
        laplace_y=12.82,
        gauss_y=20.03,
        laplace_share=0.533,
        length_spread=0.362,
        width_spread=0.115,
    ),
    ObjectClass(
        "pedestrian",
        (0.8, 0.7, 1.75),
        height_spread=0.120,
        decay_x=32.2,
        laplace_y=659.55,
        gauss_y=16.15,
        laplace_share=0.171,
        length_spread=0.102,
        width_spread=0.059,
        any_heading=1.0,
    ),
    ObjectClass(
        "cyclist",
        (1.76, 0.65, 1.74),
        height_spread=0.267,
        decay_x=28.7,
        laplace_y=170.45,
        gauss_y=14.89,
        laplace_share=0.033,
        length_spread=0.265,
        width_spread=0.122,
    ),
    ObjectClass(
        "truck",
        (7.5, 2.55, 3.0),
        height_spread=0.785,
        decay_x=58.5,
        laplace_y=20.1,
        gauss_y=22.33,
        laplace_share=0.365,
        length_spread=3.470,
        width_spread=0.441,
    ),
    ObjectClass(
        "cone",
        (0.4, 0.4, 0.9),
        height_spread=0.232,
        decay_x=14.8,
        laplace_y=34.25,
        gauss_y=10.05,
        laplace_share=0.024,
        length_spread=0.092,
        width_spread=0.075,
        any_heading=1.0,
    ),
)
"""Positions: fitted by maximum likelihood to the boxes with a score of 0.4 and more that
CenterPoint finds in the 150 scenes of nuScenes val (boxes from the public AB3DMOT repository).
Spreads: the same boxes. Sizes: rounded between the means of nuScenes, Argoverse 2 and Waymo's
anchor boxes. Headings: an assumption; pedestrians and cones face any direction."""


def _highway_class(
    name: str,
    size: tuple[float, float, float],
    height_spread: float,
    decay_x: float,
    share: float,
    spread: tuple[float, float],
    off_lanes: float = OFF_LANES,
    lanes: tuple[float, ...] = LANES,
) -> ObjectClass:
    length_spread, width_spread = spread
    return ObjectClass(
        name,
        size,
        height_spread,
        decay_x,
        laplace_y=OFF_LANES_M,
        gauss_y=IN_LANE_M,
        laplace_share=off_lanes,
        lanes=lanes,
        share=share,
        length_spread=length_spread,
        width_spread=width_spread,
    )


HIGHWAY_CLASSES = (
    _highway_class(
        "car", (4.6, 1.9, 1.7), height_spread=0.195, decay_x=58.1, share=0.4, spread=(0.362, 0.115)
    ),
    _highway_class(
        "truck",
        (10.8, 2.7, 3.5),
        height_spread=0.327,
        decay_x=59.5,
        share=0.4,
        spread=(5.287, 0.235),
    ),
    _highway_class(
        "cyclist",
        (2.11, 0.77, 1.74),
        height_spread=0.267,
        decay_x=45.4,
        share=0.1,
        spread=(0.265, 0.122),
    ),
    _highway_class(
        name="cone",
        size=(0.4, 0.4, 0.9),
        height_spread=0.232,
        decay_x=21.7,
        share=0.1,
        spread=(0.092, 0.075),
        off_lanes=0.0,
        lanes=LANE_EDGES,
    ),
)
"""Cars, trucks, motorcyclists (named "cyclist") and the cones of road works.

Decays: maximum likelihood fits of exp(-|x| / L) to labels, which no detector's range limits:
KITTI tracking for trucks (1606 boxes), five logs of Argoverse 2 for the others. Trucks' box:
KITTI tracking's mean and spreads; motorcyclists': nuScenes' mean, as high as a cyclist; the others
as on the road. Lanes and shares are assumptions, not data."""

SHIPPED = {"road": ROAD_CLASSES, "highway": HIGHWAY_CLASSES}
"""Classes of the models that have classes of their own."""


def uniform_shape(space: PerceptionSpace) -> Shape:
    """Return the density that is the same for every voxel."""
    nx, ny, nz = space.shape
    return np.full((nx, ny), 1.0 / (nx * ny)), np.full(nz, 1.0 / nz)


def class_shape(cls: ObjectClass, space: PerceptionSpace) -> Shape:
    """Return the density of the voxels inside boxes of a class."""
    length, width, height = cls.size
    along = _blurred(lambda x: _exponential_mass(x, cls.decay_x), space.centers(0), length)
    across = _blurred(lambda y: _lateral_mass(y, cls), space.centers(1), width)
    ground = along[:, None] * across
    profile = 1.0 - _normal_cdf(_in_spreads(space.centers(2) - height, cls.height_spread))
    return normed(ground, profile)


def mass_in(cls: ObjectClass, space: PerceptionSpace) -> float:
    """Return the mass of a class's centres in a space, up to a constant factor of the class."""
    near, far = _exponential_mass(np.array(space.x), cls.decay_x).tolist()
    right, left = _lateral_mass(np.array(space.y), cls).tolist()
    return (far - near) * (left - right)


def sampled_positions(
    cls: ObjectClass, space: PerceptionSpace, u: Floats, v: Floats
) -> tuple[Floats, Floats]:
    """Return centres x and y [m] of objects of a class in a space, (N,) each. Inverse transform
    sampling: `u` and `v` (N,) are uniform in [0, 1). If the class has no mass in the space, all
    centres are the same."""
    x, y = _masses(cls, space.x, space.y)
    return _inverted(x, space.x, u), _inverted(y, space.y, v)


@lru_cache(maxsize=16)
def _masses(
    cls: ObjectClass, x: tuple[float, float], y: tuple[float, float]
) -> tuple[Floats, Floats]:
    """Tabulate the cumulative masses of a class's centres along both axes between bounds."""
    return _exponential_mass(_edges(x), cls.decay_x), _lateral_mass(_edges(y), cls)


def _edges(bounds: tuple[float, float]) -> Floats:
    low, high = bounds
    return np.asarray(low + (high - low) * (np.arange(CELLS + 1) / CELLS))


def _inverted(masses: Floats, bounds: tuple[float, float], u: Floats) -> Floats:
    """Invert a tabulated cumulative mass between bounds, with linear interpolation."""
    edges = _edges(bounds)
    wanted = masses[0] + u * (masses[-1] - masses[0])
    at = np.clip(np.searchsorted(masses, wanted, side="right") - 1, 0, CELLS - 1)
    step = masses[at + 1] - masses[at]
    inside = np.where(step > 0.0, (wanted - masses[at]) / np.where(step > 0.0, step, 1.0), 0.0)
    return edges[at] + np.clip(inside, 0.0, 1.0) * (edges[at + 1] - edges[at])


def normed(ground: NDArray[Any], profile: NDArray[Any]) -> Shape:
    """Scale both to sum 1, the ground in place. A class without mass in the space gets a ground of
    zeros."""
    whole = ground.sum()
    if not (whole > 0 and profile.sum() > 0):
        return np.zeros(ground.shape), np.full(profile.shape, 1.0 / len(profile))
    ground /= whole
    return ground, profile / profile.sum()


def _blurred(mass: Callable[[Floats], Floats], centers: Floats, size: float) -> Floats:
    """Probability that each centre is inside a box of that size; `mass` is cumulative."""
    return mass(centers + size / 2.0) - mass(centers - size / 2.0)


def _in_spreads(distances: Floats, spread: float) -> Floats:
    """Return distances in spreads; far beyond a tiny one they are infinite."""
    with np.errstate(over="ignore"):
        return distances / spread


def _exponential_mass(x: Floats, scale: float) -> Floats:
    """Integrals of exp(-|x| / scale) from 0 to each x."""
    return np.copysign(scale * -mapped(math.expm1, -_in_spreads(np.abs(x), scale)), x)


def _lateral_mass(y: Floats, cls: ObjectClass) -> Floats:
    """Masses from minus infinity to each y, up to a constant: the mean over the lanes."""
    masses = np.zeros(len(y))
    for lane in cls.lanes:
        off = y - lane
        laplace = 0.5 * np.copysign(
            -mapped(math.expm1, -_in_spreads(np.abs(off), cls.laplace_y)), off
        )
        normal = _normal_cdf(_in_spreads(off, cls.gauss_y))
        masses += cls.laplace_share * laplace + (1.0 - cls.laplace_share) * normal
    return masses / len(cls.lanes)


def _normal_cdf(z: Floats) -> Floats:
    return 0.5 * (1.0 + mapped(math.erf, z / math.sqrt(2.0)))
