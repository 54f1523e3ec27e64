"""Reach: the distance up to which objects of a class are found.

The expected AP of a class at a location is the mean of AP (eqs. 4 to 7) over the class's height
profile in the prior. Along each bearing it is computed in rings of `RING_M`, as the mean of voxels
spread over the ring's piece and the height, and then smoothed: a running mean over `SMOOTHED_M`,
and over the neighbouring bearings with half its weight each. So neither the rings of a LiDAR nor
the single voxels that its far beams meet end the reach.

In a study on objects, reach is that of lone objects by eighths of the circle, the same that the
score reports (`targets.object_metric`), so that maps, views and tables show the same metres.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...base.arrays import Flags, Floats, Ints, mapped, read_only
from ...base.errors import require_name
from ...base.notebook import ShortRepr
from ...base.values import Number, Whole
from ...geometry.grids import PerceptionSpace
from ...prior.prior import ClassDensity
from ...scene.rig import Rig
from ..sampling import CENTERED, scrambled_sobol
from ..score import FARTHEST_M
from ..targets.object_metric import SECTORS, LoneObjects

RING_M = 1.0
SMOOTHED_M = 5.0
"""About as long as a car."""
BESIDE_RAD = math.radians(10.0)
"""Bearings farther apart than this are not smoothed over, and no sector is wider."""
VOXELS = 32  # Voxels of a ring's piece
FEW = 0.25
"""With a smaller share of voxels in the space and outside the vehicle, AP counts as 0."""
DECIMALS = 6  # Reaches are rounded to the micrometre
AP = Number(0.0, 1.0, above=True, below=True)
BEARINGS = Whole(4, 720)
AT_LEAST_M = 0.5
"""A reach this near to the end of the evaluated range counts as its end: it is "at least"."""
ARC_STEPS = 12  # Points along the arc of a sector
SECTOR_RAD = 2.0 * math.pi / len(SECTORS)


@dataclass(frozen=True, slots=True, eq=False)
class Reach(ShortRepr):
    """The distance up to which a class is found, by bearing.

    Attributes
    ----------
    class_name : str
    ap : float
        The required AP.
    bearings : (B,) float
        Counter-clockwise from straight ahead [rad].
    distance : (B,) float
        Distance from the origin where the longest range with an expected AP of at least `ap` ends
        [m]; 0 where there is no such range.
    per_sensor : dict of (B,) float
        The same for each sensor alone, by name.
    limit : (B,) float
        Where the space ends [m]: a reach that equals it is "at least".
    sector : float
        In a study on objects: width of the sector round each bearing [rad]; distances are those of
        lone objects. 0 in a study on voxels: distances are along bearings.
    """

    class_name: str
    ap: float
    bearings: Floats
    distance: Floats
    per_sensor: Mapping[str, Floats]
    limit: Floats
    sector: float = 0.0

    def towards(self, bearing: float) -> tuple[float, bool]:
        """Return the reach [m] nearest to a bearing [rad], and whether the space ends there."""
        k = int(np.abs(np.angle(np.exp(1j * (self.bearings - bearing)))).argmin())
        return float(self.distance[k]), bool(ends_with_space(self, self.distance)[k])


@dataclass(frozen=True, slots=True)
class SpokeColumns:
    """Columns of voxels along bearings, the same for all classes: `i` and `j` (N,) of each, 0 where
    it is beyond the space, that is not `inside` (N,), and the `quantile` (N,) of a class's height
    profile at which its voxel is chosen. There are `VOXELS` for each ring of each bearing."""

    bearings: Floats
    limit: Floats
    i: Ints
    j: Ints
    inside: Flags
    quantile: Floats


@lru_cache(2)
def spoke_columns(space: PerceptionSpace, bearings: int) -> SpokeColumns:
    """Choose columns round the origin."""
    angles = np.array([2.0 * math.pi * b / bearings for b in range(bearings)])
    limit = np.array([_edge(space, angle) for angle in angles.tolist()])
    rings = max(1, math.ceil(limit.max() / RING_M))
    u = scrambled_sobol(bearings * rings * VOXELS, CENTERED).reshape(bearings, rings, VOXELS, 3)
    distance = (np.arange(rings)[:, None] + u[..., 0]) * RING_M
    half = math.tan(min(math.pi / bearings, BESIDE_RAD / 2.0))
    aside = (2.0 * u[..., 1] - 1.0) * half
    inside = np.ones(u.shape[:3], bool)
    places = []
    for axis, w in enumerate(_turned(angles, aside, distance)):
        place = np.floor((w - space.origin[axis]) / space.interval).astype(np.int64)
        inside &= (place >= 0) & (place < space.shape[axis])
        places.append(place)
    i, j = (np.where(inside, place, 0).ravel() for place in places)
    return SpokeColumns(
        read_only(angles),
        read_only(limit),
        i=read_only(i),
        j=read_only(j),
        inside=read_only(inside.ravel()),
        quantile=read_only(u[..., 2].ravel()),
    )


@dataclass(frozen=True, slots=True)
class Spokes:
    """Voxels along bearings: `index` (V, 3), and the `ring` (V,) of each, R rings a bearing. None
    is in the vehicle or beyond the space. `limit` (B,) is where the space ends; `mass` (B, R) are
    the voxels of each ring and of those that it is smoothed with."""

    bearings: Floats
    limit: Floats
    index: Ints
    ring: Ints
    mass: Floats

    @classmethod
    def of(
        cls, space: PerceptionSpace, tops: Floats | None, density: ClassDensity, bearings: int
    ) -> "Spokes":
        """Choose voxels for a class, round the origin."""
        columns = spoke_columns(space, bearings)
        layer = np.searchsorted(np.cumsum(density.profile), columns.quantile, side="right")
        layer = np.minimum(layer, space.shape[2] - 1)
        inside = columns.inside.copy()
        if tops is not None:
            heights = space.centers(2)[layer]
            inside &= heights >= tops[columns.i, columns.j]
        chosen = np.flatnonzero(inside)
        index = np.stack([each[chosen] for each in (columns.i, columns.j, layer)], axis=1)
        rings = len(inside) // (bearings * VOXELS)
        counts = inside.reshape(bearings, rings, VOXELS).sum(axis=2, dtype=float)
        return cls(
            columns.bearings,
            columns.limit,
            index=index,
            ring=chosen // VOXELS,
            mass=_smoothed(counts),
        )

    @property
    def ahead(self) -> "Spokes":
        """The voxels that `distance` needs for the first bearing alone."""
        count, rings = self.mass.shape
        near = np.isin(self.ring // rings, (0, 1, count - 1))
        return replace(self, index=self.index[near], ring=self.ring[near])

    def distance(self, ap: Floats, min_ap: float) -> Floats:
        """Return the distance (B,) up to which the AP (V,) of voxels is at least `min_ap` [m]."""
        shape = self.mass.shape
        by_ring = np.bincount(self.ring, ap, math.prod(shape)).astype(float)
        sums = _smoothed(by_ring.reshape(shape))
        enough = (self.mass > 0.0) & (self.mass >= FEW * self.mass.max())
        mean = sums / np.where(enough, self.mass, np.inf)
        ends = [_end_of_longest(row, min_ap) for row in mean]
        return np.minimum(np.round(np.array(ends) * RING_M, DECIMALS), self.limit)


def _smoothed(values: Floats) -> Floats:
    """Sums (B, R) over rings and bearings beside each; fewer rings at the ends."""
    half = int(SMOOTHED_M / RING_M) // 2
    padded = np.pad(values, ((0, 0), (half, half)))
    near = [padded[:, k : k + values.shape[1]] for k in range(2 * half + 1)]
    total: Floats = np.sum(near, axis=0)
    if 2.0 * math.pi / len(total) > BESIDE_RAD * (1.0 + 1e-9):
        return total
    return 2.0 * total + np.roll(total, 1, axis=0) + np.roll(total, -1, axis=0)


def density_of(densities: list[ClassDensity], name: str) -> ClassDensity:
    """Return the class of that name; `InputError` where there is none."""
    require_name("sight", "class_name", name, (density.name for density in densities))
    return next(density for density in densities if density.name == name)


def _turned(angles: Floats, aside: Floats, distance: Floats) -> tuple[Floats, Floats]:
    """Points (x, y) (B, R, n) at a distance; `aside` is the tangent of the angle to a bearing."""
    ahead = distance / np.sqrt(1.0 + aside * aside)
    c, s = (mapped(turn, angles)[:, None, None] for turn in (math.cos, math.sin))
    return ahead * (c - s * aside), ahead * (s + c * aside)


def _edge(space: PerceptionSpace, bearing: float) -> float:
    """Distance from the origin to the end of the space along a bearing [m]."""
    ends = []
    for component, (low, high) in ((math.cos(bearing), space.x), (math.sin(bearing), space.y)):
        if abs(component) > 1e-12:
            ends.append((high if component > 0.0 else low) / component)
    return max(0.0, min(ends))


def _end_of_longest(values: Floats, min_value: float) -> float:
    """End of the longest run of values of at least `min_value`, the first of several; else 0. In
    rings from the first ring's inner edge, interpolated linearly between the middles of rings."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], values >= min_value, [False]])))
    if not len(edges):
        return 0.0
    starts = edges[::2]
    ends = edges[1::2]
    end = int(ends[np.argmax(ends - starts)])
    if end == len(values):
        return float(end)
    above = float(values[end - 1])
    below = float(values[end])
    return end - 0.5 + (above - min_value) / (above - below)


@dataclass(frozen=True, slots=True, eq=False)
class ReachLine:
    """`points` (N, 2) [m], the last one beside the first, and where they are `at_least` (N,)."""

    points: Floats
    at_least: Flags


def reach_line(reach: Reach, distance: Floats) -> ReachLine:
    """Return the line of distances (B,) of a reach, of the rig or of one sensor. Reaches along
    bearings are smoothed with the weights 1 2 1, because beams make them ragged. A reach by sectors
    has an arc for each sector."""
    at_least = ends_with_space(reach, distance)
    bearings = reach.bearings
    if reach.sector:
        aside = (np.arange(ARC_STEPS) / (ARC_STEPS - 1) - 0.5) * reach.sector
        bearings = np.add.outer(bearings, aside).reshape(-1)
        distance = np.repeat(distance, ARC_STEPS)
        at_least = np.repeat(at_least, ARC_STEPS)
    else:
        round_ = (np.roll(distance, 1) + 2.0 * distance + np.roll(distance, -1)) / 4.0
        distance = np.where(at_least, distance, round_)
    points = np.stack([distance * np.cos(bearings), distance * np.sin(bearings)], axis=1)
    return ReachLine(points, at_least)


def ends_with_space(reach: Reach, distance: Floats) -> Flags:
    """Whether reaches (B,) end at the limit of the space: the true reach may be longer."""
    return np.asarray(distance >= reach.limit - AT_LEAST_M)


def object_reach(lone: LoneObjects, rig: Rig, class_name: str, min_ap: float) -> Reach:
    """Return the reach of a class with an AP of at least `min_ap`: of the rig, of each sensor."""

    def metres(members: list[str] | None) -> np.ndarray:
        by_sector = lone.reach(class_name, lone.ap(rig, members), min_ap)
        return read_only(np.array([by_sector[way] for way in SECTORS]))

    bearings = read_only(np.arange(len(SECTORS)) * SECTOR_RAD)
    alone = {s.name: metres([s.name]) for s in rig}
    limit = read_only(np.full(len(SECTORS), FARTHEST_M))
    return Reach(
        class_name, min_ap, bearings, metres(None), per_sensor=alone, limit=limit, sector=SECTOR_RAD
    )
