"""The free region of a sensor: where on its mount it may go while a figure loses at most an amount.

Losses are kept by corner of a finely divided mount, with their standard errors. So another allowed
loss is another cut of the same surface, without a new computation. A corner is inside where its
loss plus `SURE` standard errors is at most the allowed loss: the region errs to the safe side.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from pe_core.base.arrays import Flags, Floats, Ints
from pe_core.base.values import rounded
from pe_core.geometry.surfaces import area_of, cut_below
from pe_core.scene.rig import Rig
from pe_core.scene.vehicle import closest_points
from pe_core.scoring.score import SURE
from pe_core.search import FIGURES, Figure, SurfaceMount, SurfacePlace

EDGE = "the edge of the mount"
BY_LOSS = "the loss"
PATCH_DECIMALS = 5
ON_PATCH_M = 1e-3
LEAST_M2 = 0.005  # A smaller area is told as none
METRE_UNIT = "m"
DEGREE_UNIT = "deg"
USUAL_LOSSES = 4.0
"""The allowed loss, where none is given, is so many times the smallest difference that counts."""
ALIKE_SHARE = 0.1
"""Two ways that differ by less than this share are told as one: "either way"."""


def usual_loss(figure: Figure) -> float:
    """Return the loss of a figure that is allowed where none is given: 0.02 nats of entropy."""
    return rounded(USUAL_LOSSES * figure.least)


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """How much a sensor loses along a way from where it is.

    `name`: "forward", or "yaw" with `turned`, its sign.
    `unit`: "m" or "deg".
    `steps, upper` (K,): How far, from 0 on, and the loss there plus `SURE` standard errors.
    `end`: What is behind the last step: `EDGE`, the rule that forbids it, or empty: not looked.
    """

    name: str
    unit: str
    steps: Floats
    upper: Floats
    end: str = ""

    def within(self, loss: float) -> tuple[float, str]:
        """Return how far a sensor may go, and what ends it there: `BY_LOSS`, or `end`."""
        over = np.flatnonzero(self.upper[1:] > loss)
        if not len(over):
            return float(self.steps[-1]), self.end
        k = int(over[0])
        low, high = self.upper[k : k + 2].tolist()
        share = (loss - low) / (high - low) if high > low and low <= loss else 0.0
        return float(self.steps[k] + share * (self.steps[k + 1] - self.steps[k])), BY_LOSS

    def text(self, distance: float) -> str:
        """Return a distance on this way: "4 cm", "2.5 deg"; rounded down."""
        if self.unit == DEGREE_UNIT:
            return f"{np.floor(10.0 * distance) / 10.0:g} deg"
        return f"{np.floor(100.0 * distance + 1e-9):.0f} cm"


@dataclass(frozen=True, slots=True)
class Limitation:
    """How far a sensor may go on a way, and why no farther."""

    way: Way
    distance: float
    why: str

    @property
    def is_open(self) -> bool:
        """Whether the way was not looked at any farther."""
        return not self.why

    @property
    def text(self) -> str:
        """The distance in words: "forward 4 cm"."""
        more = " and more" if self.is_open else ""
        return f"{self.way.text(self.distance)} {self.way.name}{more}"

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        own = {"way": self.way.name, "unit": self.way.unit}
        return {**own, "distance": rounded(self.distance), "ended_by": self.why or None}


@dataclass(frozen=True, slots=True, eq=False)
class FreeRegion:
    """Where a sensor may go, and what it loses all over its mount.

    `rig, sensor`: The rig as it is, and the name of the sensor that moves.
    `figure`: A key of `FIGURES`.
    `allowed`: The loss that is allowed, in the figure's own unit, positive is worse.
    `base`: The figure of the rig as it is.
    `mount_name, mount`: On which it moves; None for a list of slots.
    `corners` (V, 3), `faces` (F, 3): The mount's surface, finely divided [m].
    `loss, error` (V,): The loss at each corner, and its standard error.
    `forbidden` (V,): Corners where a rule or a limit is broken.
    `places`: Where the rig was evaluated; their values are losses.
    `ways`: Directions along the surface, and angles.
    `sample`: On what was evaluated, as text: "32,768 voxels"; empty where figures are exact.
    `not_held`: What the rig breaks as it is: it forbids nothing.
    `with_others`: Whether the other sensors were searched again at each place.
    `area_before`: The area while the others stay [m2], where they were searched again.
    `foot`: The point of the mount below the sensor as it is [m]; None in a slot.
    """

    rig: Rig
    sensor: str
    figure: str
    allowed: float
    base: float
    mount_name: str
    mount: SurfaceMount | None
    corners: Floats = field(repr=False)
    faces: Ints = field(repr=False)
    loss: Floats = field(repr=False)
    error: Floats = field(repr=False)
    forbidden: Flags = field(repr=False)
    places: tuple[SurfacePlace, ...] = field(repr=False)
    ways: tuple[Way, ...] = field(repr=False)
    sample: str = ""
    not_held: tuple[str, ...] = ()
    is_coarse: bool = False
    with_others: bool = False
    area_before: float | None = None
    foot: tuple[float, float, float] | None = None

    @property
    def row(self) -> Figure:
        """How the figure is read."""
        return FIGURES[self.figure]

    def allowing(self, loss: float) -> "FreeRegion":
        """Return the region for another allowed loss; nothing is computed again."""
        return replace(self, allowed=loss)

    def with_gain(self, gain: Floats, error: Floats) -> "FreeRegion":
        """Return the region where the loss falls by a gain (V,) with an error (V,) at each corner,
        as the other sensors are searched again: nowhere does the region become smaller. The ways
        along it are not told: they are of the others as they are."""
        both = np.sqrt(self.error**2 + error**2)
        turns = tuple(way for way in self.ways if way.unit == DEGREE_UNIT)
        gains = self.loss - gain + SURE * both < self.upper
        loss = np.where(gains, self.loss - gain, self.loss)
        error = np.where(gains, both, self.error)
        others = replace(self, loss=loss, error=error, ways=turns, with_others=True)
        return replace(others, area_before=self.area)

    @property
    def upper(self) -> Floats:
        """(V,) Loss plus `SURE` standard errors at each corner; inf where it is forbidden."""
        return np.where(self.forbidden, np.inf, self.loss + SURE * self.error)

    @property
    def patch(self) -> Floats:
        """The region as triangles (N, 3, 3) [m], rounded to 0.01 mm."""
        if not len(self.faces):
            return np.empty((0, 3, 3))
        cut = cut_below(self.corners[self.faces], self.upper[self.faces], self.allowed)
        cut = np.round(cut, PATCH_DECIMALS) + 0.0
        along = cut[:, 1:] - cut[:, :1]
        across = np.cross(along[:, 0], along[:, 1])
        return cut[(across != 0.0).any(axis=1)]

    def outward(self, triangles: Floats) -> Floats:
        """Return the outward normal (N, 3) of the place that is nearest to each of triangles
        (N, 3, 3)."""
        at = np.array([place.point for place in self.places])
        middles = triangles.mean(axis=1)
        square = (middles**2).sum(axis=1)[:, None] + (at**2).sum(axis=1) - 2.0 * middles @ at.T
        normals = np.array([place.normal for place in self.places])
        nearest: Floats = normals[square.argmin(axis=1)]
        return nearest

    @property
    def holds_sensor(self) -> bool:
        """Whether the sensor is on the patch where it is now, nearer than `ON_PATCH_M`."""
        return self.foot is not None and self.off_patch(np.array(self.foot)) <= ON_PATCH_M

    def off_patch(self, point: Floats) -> float:
        """Return how far a point (3,) is from the patch [m]; inf where the patch is empty."""
        away = closest_points(point, self.patch) - point
        return float(np.sqrt((away**2).sum(axis=1).min(initial=np.inf)))

    @property
    def area(self) -> float:
        """Area of the patch [m2]."""
        return area_of(self.patch)

    @property
    def mount_area(self) -> float:
        """Area of the whole mount [m2]."""
        return area_of(self.corners[self.faces])

    @property
    def limitations(self) -> tuple[Limitation, ...]:
        """How far the sensor may go on each way, and why."""
        return tuple(Limitation(way, *way.within(self.allowed)) for way in self.ways)

    @property
    def tightest(self) -> Limitation | None:
        """The direction along the surface in which the least is left; None without directions."""
        along = [each for each in self.limitations if each.way.unit == METRE_UNIT]
        return min(along, key=lambda each: each.distance, default=None)

    @property
    def typical_error(self) -> float:
        """Median standard error of the loss where the region ends, or all over the mount."""
        near = np.abs(self.loss - self.allowed) < self.allowed
        known = self.error[near & ~self.forbidden] if near.any() else self.error
        return rounded(float(np.median(known))) if len(known) else 0.0

    def free_places(self) -> list[SurfacePlace]:
        """Return the evaluated places that break nothing and lose at most what is allowed."""
        known = (each for each in self.places if each.value is not None)
        return [each for each in known if each.value is not None and each.value <= self.allowed]

    @property
    def extent(self) -> str:
        """How far the sensor may go, in one line: "4 cm forward, 31 cm back; yaw 2 deg"."""
        both = [_both_ways(pair) for pair in _pairs(self.limitations)]
        return "; ".join(both)

    def to_dict(self) -> dict[str, Any]:
        """Return the region as plain JSON data."""
        return {
            "sensor": self.sensor,
            "figure": self.figure,
            "unit": self.row.unit,
            "allowed_loss": self.allowed,
            "base": self.base,
            "mount": self.mount_name,
            "area_m2": rounded(self.area),
            "mount_area_m2": rounded(self.mount_area),
            "standard_error": self.typical_error,
            "evaluated_on": self.sample,
            "others_searched_again": self.with_others,
            "not_held": list(self.not_held),
            "ways": [each.to_dict() for each in self.limitations],
            "patch": self.patch.tolist(),
            "places": [_place_dict(each) for each in self.places],
        }


def _pairs(found: Sequence[Limitation]) -> Iterator[tuple[Limitation, ...]]:
    """Yield ways two by two: forth and back along an axis, or both turns of an angle."""
    for start in range(0, len(found), 2):
        yield tuple(found[start : start + 2])


def _both_ways(pair: Iterable[Limitation]) -> str:
    one, other = pair
    apart = abs(one.distance - other.distance)
    if one.way.unit == DEGREE_UNIT and apart <= ALIKE_SHARE * max(one.distance, other.distance):
        least = min(one, other, key=lambda each: each.distance)
        axis = least.way.name.split()[0]
        more = " and more" if one.is_open and other.is_open else ""
        return f"{axis} {least.way.text(least.distance)} either way{more}"
    return f"{one.text}, {other.text}"


def _place_dict(place: SurfacePlace) -> dict[str, Any]:
    return {
        "point": list(place.point),
        "position": list(place.pose.position),
        "rotation_deg": list(place.pose.rotation_deg),
        "loss": place.value,
        "forbidden_by": place.reason,
    }


def region_lines(found: FreeRegion) -> list[str]:
    """Return a region in lines: how large it is, how far the sensor may go, what ends it."""
    row = found.row
    lost = row.number(found.allowed)
    unit = f" {row.unit}".rstrip()
    head = f"{found.sensor} on {found.mount_name}"
    if found.mount is None:
        free = found.free_places()
        lines = [f"{head}: {len(free)} of {len(found.places)} slots lose at most {lost}{unit}"]
        for each in found.places:
            at = ", ".join(f"{v:.3f}" for v in each.pose.position)
            told = each.reason or f"loses {row.number(each.value or 0.0)}{unit}"
            lines.append(f"  ({at}): {told}")
        return lines
    area = f"{found.area:.2f} of {found.mount_area:.2f} m2"
    lines = [f"{head}: {area} lose at most {lost}{unit} of {row.name}"]
    if found.area_before is not None:
        more = found.area - found.area_before
        told = f"{more:.2f} m2 of it" if more >= LEAST_M2 else "none of it"
        lines.append(f"  {told} because the other sensors are searched again there")
        lines.append("  how far in each direction is told while they stay: without --others")
    lines += [f"  {part}" for part in found.extent.split("; ")] if found.ways else []
    if (least := found.tightest) is not None:
        ended = f", ended by {least.why}" if least.why else ""
        lines.append(f"tightest: {least.text}{ended}")
    forbidden = [each.reason for each in found.places if each.reason]
    for why in dict.fromkeys(sorted(forbidden)):
        lines.append(f"{forbidden.count(why)} of {len(found.places)} places forbidden: {why}")
    if found.typical_error:
        error = row.number(found.typical_error)
        lines.append(f"on {found.sample}; standard error of a loss {error}, {SURE:g} are added")
    lines += [f"not held now, so not asked for: {each}" for each in found.not_held]
    return lines
