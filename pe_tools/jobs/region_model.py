"""The losses of a moved sensor between evaluated places: kriged over its mount, and over angles."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import dist, sqrt

import numpy as np

from pe_core.base.arrays import Floats, Ints
from pe_core.geometry.surfaces import area_of, divided
from pe_core.scoring.score import SURE
from pe_core.search import OwnPlaces, PathPoint, PlacedRig

from ..advice import EDGE, Kriging, Way

LENGTHS_M = (0.05, 0.1, 0.2, 0.4, 0.8)
LENGTHS_DEG = (1.0, 3.0, 10.0)
"""Ranges of kriging that are tried, over a surface and over an angle."""
NORMAL_M = 0.3
"""Places whose normals are opposite are as far apart as twice this [m]: a sheet has two sides."""
FINEST_M = 0.02
CORNERS = 20_000
"""Longest edge of the divided surface [m], unless it would have more triangles than that."""
POOL = 4000  # Corners among which the next places are chosen
SENSES = {"yaw": ("left", "right"), "pitch": ("nose down", "nose up"), "roll": ("right", "left")}
"""Words for the positive and the negative sense of a turn, in the frame of an upright mount."""
NEIGHBOURS = 3
"""A corner is forbidden where one of so many nearest places is."""
RULE_PART = 3  # One in so many new places is where a rule begins to forbid
APART_SHARE = 0.5
NEW_SHARE = 0.125
"""How far new places are apart, and from known ones, as a share of the mean distance of places."""
STEP_M = 0.02
LENGTH_M = 1.0
"""How far apart a way along the surface is told, and how far it is looked along [m]."""
FINE_DEG = 0.25  # How finely the loss over an angle is told
DECIMALS = 6  # Corners of neighbouring faces are one if they agree to so many decimals [m]


@dataclass(frozen=True, slots=True)
class MountCorners:
    """A mount's surface, finely divided: `corners` (V, 3) [m], their unit `normals` (V, 3), and
    `faces` (F, 3), which are empty for a list of slots."""

    corners: Floats
    normals: Floats
    faces: Ints

    @classmethod
    def of(cls, places: OwnPlaces) -> "MountCorners":
        """Return those of the mount of places."""
        if places.surface is None:
            return cls(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
        own = places.surface.triangles[places.surface.faces]
        fine = divided(own, max(FINEST_M, 2.0 * sqrt(area_of(own) / CORNERS)))
        flat = np.round(fine.reshape(-1, 3), DECIMALS) + 0.0
        corners, index = np.unique(flat, axis=0, return_inverse=True)
        index = index.reshape(-1)
        along = fine[:, 1:] - fine[:, :1]
        across = np.repeat(np.cross(along[:, 0], along[:, 1]), 3, axis=0)
        sums = [np.bincount(index, across[:, axis], len(corners)) for axis in range(3)]
        normals = np.stack(sums, axis=1)
        size = np.sqrt((normals**2).sum(axis=1, keepdims=True))
        return cls(corners, normals / np.maximum(size, 1e-12), index.reshape(-1, 3))

    @property
    def area(self) -> float:
        """Area of all faces [m2]."""
        return area_of(self.corners[self.faces])


def featured(points: object, normals: object) -> Floats:
    """Return points (N, 6) as kriging sees them: positions, and normals by `NORMAL_M`."""
    return np.concatenate([np.asarray(points), NORMAL_M * np.asarray(normals)], axis=1)


def features_of(placed: Sequence[PlacedRig]) -> Floats:
    """Return the places (N, 6) of placed rigs as kriging sees them."""
    points = [each.place.point for each in placed]
    return featured(points, [each.place.normal for each in placed])


def at_known(known: Sequence[PlacedRig], points: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Return points (M, 3) as kriging sees them (M, 6), their normals turned as that of the nearest
    known place, and which share of the nearest places is forbidden (M,)."""
    places = [each.place for each in known]
    at = np.array([place.point for place in places])
    square = (points**2).sum(axis=1)[:, None] + (at**2).sum(axis=1) - 2.0 * points @ at.T
    count = min(NEIGHBOURS, len(places))
    # A few minima one after the other are faster than a partition of all places.
    row = np.arange(len(points))
    near = np.empty((len(points), count), np.int64)
    for rank in range(count):
        near[:, rank] = square.argmin(axis=1)
        square[row, near[:, rank]] = np.inf
    own = np.array([place.normal for place in places])[near[:, 0]]
    sign = np.where((normals * own).sum(axis=1) < 0.0, -1.0, 1.0)
    is_forbidden = np.array([bool(place.reason) for place in places])
    return featured(points, normals * sign[:, None]), is_forbidden[near].mean(axis=1)


def hardest_to_tell(
    kriging: Kriging,
    mount: MountCorners,
    known: Sequence[PlacedRig],
    allowed: float,
    *,
    count: int,
    whole: int,
) -> Floats:
    """Return corners (N, 3) of a mount, at most `count`, where loss and error leave open most
    whether the loss is allowed, none near another or near a known place. `whole` is how many places
    the mount has in the end."""
    pool = slice(None, None, max(len(mount.corners) // POOL, 1))
    points = mount.corners[pool]
    at, forbidden = at_known(known, points, mount.normals[pool])
    loss, error = kriging.at(at)
    doubt = SURE * error - np.abs(loss - allowed)
    doubt[forbidden > 0.0] = -np.inf
    between = np.flatnonzero((forbidden > 0.0) & (forbidden < 1.0))
    first = between[:: max(len(between) // max(count // RULE_PART, 1), 1)]
    doubt[first] = np.inf  # where a rule begins to forbid
    spacing = sqrt(mount.area / whole)
    taken = [each.place.point for each in known]
    chosen: list[int] = []
    for k in np.argsort(-doubt, kind="stable").tolist():
        if len(chosen) == count or doubt[k] == -np.inf:
            break
        is_new = all(dist(points[k], each) >= NEW_SHARE * spacing for each in taken)
        if is_new and all(dist(points[k], points[j]) >= APART_SHARE * spacing for j in chosen):
            chosen.append(k)
    found: Floats = points[chosen]
    return found


@dataclass(frozen=True, slots=True)
class LossModel:
    """A kriged loss; `spread` is the variance of its error that all places share."""

    kriging: Kriging
    spread: float

    def at(self, points: Floats) -> tuple[Floats, Floats]:
        """Return losses (M,) and their standard errors (M,)."""
        loss, error = self.kriging.at(points)
        return loss, np.sqrt(error**2 + self.spread)

    def upper(self, points: Floats) -> Floats:
        """Return losses (M,) plus `SURE` standard errors."""
        loss, error = self.at(points)
        return loss + SURE * error


def ways_along(model: LossModel, places: OwnPlaces, known: Sequence[PlacedRig]) -> Iterator[Way]:
    """Yield the ways along the surface from where the sensor is."""
    whole = int(LENGTH_M / STEP_M)
    for name, direction in places.directions().items():
        path = [places.foot, *places.path(direction, STEP_M, LENGTH_M)]
        points = np.array([each.point for each in path])
        at, share = at_known(known, points, np.array([each.normal for each in path]))
        forbidden = share > 0.0
        forbidden[0] = False  # where it is now, it may be
        free = int(forbidden.argmax()) if forbidden.any() else len(path)
        end = EDGE if len(path) <= whole else ""
        if free < len(path):
            end = _nearest_reason(known, path[free])
        steps = np.array([each.distance for each in path[:free]])
        yield Way(name, "m", steps, upper=model.upper(at[:free]), end=end)


def _nearest_reason(known: Sequence[PlacedRig], point: PathPoint) -> str:
    barred = [each.place for each in known if each.place.reason]
    return min(barred, key=lambda place: dist(place.point, point.point)).reason


def ways_of_turn(
    model: LossModel, axis: str, barred: dict[float, str], farthest: float
) -> list[Way]:
    """Return the ways of turning about an axis, both ways: up to `farthest`, or to the first angle
    that is `barred`, with its rule. Angles are in degrees, as points of the model."""
    ways = []
    for name, sign in zip(SENSES[axis], (1.0, -1.0), strict=True):
        own = {abs(angle): why for angle, why in barred.items() if angle * sign > 0.0}
        first = min(own, default=farthest)
        last = farthest if not own else max(first - FINE_DEG, 0.0)
        steps = np.arange(0.0, last + FINE_DEG / 2.0, FINE_DEG)
        upper = model.upper(sign * steps[:, None])
        ways.append(Way(f"{axis} {name}", "deg", steps, upper=upper, end=own.get(first, "")))
    return ways
