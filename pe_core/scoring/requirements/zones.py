"""Zones of the ground in which a requirement has to hold, sampled at a stated step.

A zone is an area, a ring of constant distance round the vehicle, a path, or single spots. Its
signed distance (negative inside) tells how far a sample is inside the zone or outside of it: the
margin of a verdict is a distance of this kind.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any

import numpy as np

from ...base.arrays import Floats
from ...base.errors import InputError, shown
from ...base.setting import OneOf, Pair, Panel, Part, check_settings, setting
from ...base.values import Number, listed
from ...scene.vehicle import Vehicle
from ...scene.vehicle_description import Reference
from .planes import DECIMALS, SIDES, Place, VehiclePlanes, parsed

PlacePair = tuple[Place, Place]

STEP_M = 0.15  # The largest step of the grid of UN R159 Annex 3
STEP = Number(0.02, 100.0, unit="m", noun="length")
HEIGHT = Number(0.0, 100.0, unit="m", noun="length")
RING = Number(0.0, 100.0, unit="m", noun="length")
MAX_SAMPLES = 20_000
"""Samples of one zone at most."""
MAX_GRID = 60_000
"""Places of a grid on which a zone is grown at most, and samples with the ground round them."""
MAX_PLACES = 2_000_000
"""Places of the grid at most from which the ground round a path or spots is taken."""
GROWN_M = 0.6
"""How far round a zone samples are taken to find how far it could grow [m]."""
INSIDE_M = 1e-6  # A sample this far outside of a zone is on its edge: rounding
AREA_M2 = 2e-6  # Twice the area of the smallest polygon
WHO = "zone"
SIDES_MENU = (("Right", "As in countries that drive on the right"), ("Left", "As in the UK"))
SHAPES = ("x and y", "polygon", "ring", "path", "spots")
OF_SHAPE = Part(shape="shape")


@dataclass(frozen=True, slots=True)
class PlacePairRule:
    """Two places along one axis: numbers [m], or planes of the vehicle with offsets."""

    axis: int
    words = "two places"

    def checked(self, source: Any, field: str, value: Any) -> PlacePair:
        """Return the value, or raise `InputError`."""
        return _places((value,), (self.axis, self.axis), source, field)[0]


ALONG = PlacePairRule(0)
ACROSS = PlacePairRule(1)


@dataclass(frozen=True, slots=True)
class CornersRule:
    """A list of corners [x, y], each two places; none, or at least so many."""

    fewest: int
    words = "list of places [x, y]"

    def checked(self, source: Any, field: str, value: Any) -> tuple[PlacePair, ...]:
        """Return the value, or raise `InputError`."""
        corners = _places(value, (0, 1), source, field)
        if corners and len(corners) < self.fewest:
            raise InputError(source, field, f"at least {self.fewest} corners", len(corners))
        return corners


@dataclass(frozen=True)
class Zone:
    """Where a requirement has to hold: exactly one shape.

    Its fields say what they mean. Places are numbers [m], or planes of the vehicle with
    offsets. Bodies stand on the ground.

    `InputError` when it has no shape or several, or a value is none.
    """

    x: Annotated[PlacePair | None, OF_SHAPE] = setting(
        None, ALONG, "A rectangle: from and to along x"
    )
    y: Annotated[PlacePair | None, OF_SHAPE] = setting(
        None, ACROSS, "A rectangle: from and to along y"
    )
    polygon: Annotated[tuple[PlacePair, ...], OF_SHAPE] = setting(
        (), CornersRule(3), "Corners of an area"
    )
    ring: Annotated[tuple[float, float] | None, OF_SHAPE] = setting(
        None, Pair(RING), "All ground at these distances from the vehicle's outline"
    )
    path: Annotated[tuple[PlacePair, ...], OF_SHAPE] = setting(
        (), CornersRule(2), "Corners of a line along which a body moves"
    )
    spots: Annotated[tuple[PlacePair, ...], OF_SHAPE] = setting((), CornersRule(1), "Single places")
    z: tuple[float, float] = setting(
        (0.0, 0.0),
        Pair(HEIGHT, same=True),
        "Heights of the foot of the body above the ground",
        Panel("z", "Heights"),
    )
    step: float = setting(
        STEP_M,
        STEP,
        "Largest distance of two samples of the zone",
        Panel("step", "Step", soft_max=2.0),
    )
    below: float | None = setting(
        None,
        HEIGHT,
        "What is higher does not count for the vehicle's planes",
        Panel("below", "Planes Below"),
    )
    near_side: str = setting(
        "right",
        OneOf(SIDES[::-1]),
        "The side of the kerb",
        Panel("near_side", "Near Side", menu=SIDES_MENU),
    )
    eyes: float | None = setting(
        None,
        Number(cap=1e3, unit="m"),
        "The x of the driver's eyes, for the plane eyes",
        Panel("eyes", "Driver's Eyes X", min=-1e3),
    )

    def __post_init__(self) -> None:
        check_settings(self, WHO)
        if (self.x is None) != (self.y is None):
            raise InputError(WHO, "x, y", "both, or neither", "one of them")
        shapes = [self.x is not None, *map(bool, (self.polygon, self.ring, self.path, self.spots))]
        if sum(shapes) != 1:
            expected = f"one of {', '.join(SHAPES)}"
            found = " and ".join(s for s, has in zip(SHAPES, shapes, strict=True) if has)
            raise InputError(WHO, "shape", expected, found or "none")

    def placed(
        self,
        vehicle: Vehicle | None,
        reference: Reference | None,
        name: str,
        planes: dict[tuple[Any, ...], VehiclePlanes] | None = None,
    ) -> "PlacedZone":
        """Return the zone round a vehicle, for the requirement of a name. `planes` caches the
        vehicle's planes, for several zones. `InputError` when there is no vehicle, a plane is not
        found, or the zone has no extent."""
        who = f"requirement {name!r}"
        if vehicle is None:
            raise InputError(who, "zone", "a study with a vehicle", "no [vehicle]")
        planes = {} if planes is None else planes
        key = self.below, self.near_side, self.eyes
        if key not in planes:
            planes[key] = VehiclePlanes.of(
                vehicle, reference, below=self.below, near_side=self.near_side, eyes=self.eyes
            )
        return self._on(planes[key], who)

    def _on(self, planes: VehiclePlanes, who: str) -> "PlacedZone":
        """Return the zone on the planes of a vehicle."""

        def at(corners: tuple[PlacePair, ...], key: str) -> Floats:
            near = self.near_side
            return np.array(
                [
                    [
                        planes.coordinate(a, c, near, who, field=f"zone.{key}")
                        for a, c in enumerate(xy)
                    ]
                    for xy in corners
                ]
            ).reshape(-1, 2)

        corners = np.zeros((0, 2))
        kind = "ring"
        if self.x is not None and self.y is not None:
            x, y = (
                sorted(
                    planes.coordinate(a, c, self.near_side, who, field=f"zone.{'xy'[a]}")
                    for c in own
                )
                for a, own in enumerate((self.x, self.y))
            )
            if min(x[1] - x[0], y[1] - y[0]) <= 0.0:
                found = f"x = {x}, y = {y}"
                raise InputError(who, "zone", "an area of some extent (else a path)", found)
            corners = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
            kind = "area"
        for key in ("polygon", "path", "spots"):
            if own := getattr(self, key):
                corners = at(own, key)
                kind = {"polygon": "area"}.get(key, key)
        ahead = np.roll(corners, -1, axis=0)
        area = (corners[:, 0] * ahead[:, 1] - corners[:, 1] * ahead[:, 0]).sum()
        if kind == "area" and abs(area) < AREA_M2:
            raise InputError(who, "zone.polygon", "an area of some extent", corners.tolist())
        return PlacedZone(self, planes, kind, corners, who=who)


@dataclass(frozen=True, eq=False)
class PlacedZone:
    """A zone in the ground frame. `kind` {"area", "ring", "path", "spots"}. `corners` (K, 2): Of
    the area, path or spots [m]; none of a ring."""

    zone: Zone
    planes: VehiclePlanes
    kind: str
    corners: Floats
    who: str

    def distance(self, points: Floats, within: float = math.inf) -> Floats:
        """Return the distance (N,) of points (N, 2) to the zone, negative inside [m]. A distance
        that is not `within` so many metres may be infinite."""
        if self.kind == "spots":
            return _nearest(points, self.corners, within)
        if self.kind == "path":
            return _to_lines(points, self.corners[:-1], self.corners[1:])
        if self.kind == "area":
            return signed_distance(points, self.corners)
        low, high = self.zone.ring or (0.0, 0.0)
        away = signed_distance(points, self.planes.outline)
        return np.maximum(away - high, low - away)

    @property
    def outlines(self) -> tuple[Floats, ...]:
        """Lines round the zone, (K, 2) each [m]; closed for areas and rings."""
        if self.kind == "area":
            return (np.vstack([self.corners, self.corners[:1]]),)
        if self.kind != "ring":
            return (self.corners,)
        return tuple(_offset(self.planes.outline, d) for d in self.zone.ring or ())

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner (2,) [m]."""
        corners = self.corners if self.kind != "ring" else self.planes.outline
        out = (self.zone.ring or (0.0, 0.0))[1] if self.kind == "ring" else 0.0
        return corners.min(axis=0) - out, corners.max(axis=0) + out

    @cached_property
    def grow(self) -> float:
        """How far round the zone samples are taken [m]."""
        return max(GROWN_M, self.zone.step)

    def samples(self, coarser: float = 1.0, grown: bool = True) -> tuple[Floats, Floats]:
        """Return samples (N, 2) [m] of the zone and of the ground round it, and their distances.

        Samples inside the vehicle's outline are left out: nobody stands there. The step is that of
        the zone times `coarser`; with `grown` the ground round the zone is sampled. `InputError`
        when there are too many samples, or all of them are inside the vehicle.
        """
        most = (self.grow if grown else 0.0) + INSIDE_M
        points = self._lattice(self.zone.step * coarser, self.grow if grown else 0.0)
        distance = self.distance(points, most)
        kept = distance <= most
        points = points[kept]
        distance = distance[kept]
        if len(points) > MAX_GRID:
            found = f"{len(points):,} with the ground round it"
            raise InputError(self.who, "zone.step", f"at most {MAX_GRID:,} samples", found)
        outside = signed_distance(points, self.planes.outline) > INSIDE_M
        points = points[outside]
        distance = distance[outside]
        if not (distance <= INSIDE_M).any():
            found = "a zone inside the vehicle's body"
            raise InputError(self.who, "zone", "ground on which a body can stand", found)
        return points, distance

    def ring_of_samples(self, low: float, high: float, most: int) -> tuple[Floats, Floats]:
        """Return the samples of the zone grown by `high` that are beyond `low`, as `samples` does.
        Where there would be many more than `most`, more than `most` of any are returned."""
        corners = self.bounds
        around = ((corners[1] - corners[0] + 2.0 * high) / self.zone.step + 1.0).tolist()
        if math.prod(around) > MAX_GRID:
            return np.zeros((most + 1, 2)), np.zeros(most + 1)
        points = self._lattice(self.zone.step, high)
        distance = self.distance(points)
        kept = (distance > low + INSIDE_M) & (distance <= high + INSIDE_M)
        points = points[kept]
        distance = distance[kept]
        outside = signed_distance(points, self.planes.outline) > INSIDE_M
        return points[outside], distance[outside]

    def _lattice(self, step: float, grow: float) -> Floats:
        """Return a grid over an area or ring and beyond; points along a path, spots."""
        is_area = self.kind in ("area", "ring")
        lines = self.outlines if is_area or self.kind == "path" else ()
        own = [_along(a, b, step) for w in lines for a, b in pairwise(w)]
        if self.kind == "spots":
            own = [self.corners]
        if not is_area and not grow:
            return _unique(np.concatenate(own))
        low, high = self.bounds
        counts = np.maximum(np.ceil((high - low) / step - INSIDE_M), 1.0).astype(np.int64)
        steps = np.where(high > low, (high - low) / counts, step)
        extra = np.ceil(grow / steps - INSIDE_M).astype(np.int64)
        if (places := math.prod((counts + 1 + 2 * extra).tolist())) > MAX_PLACES and not is_area:
            found = f"{places:,} in the rectangle round it"
            raise InputError(self.who, "zone.step", f"at most {MAX_PLACES:,} places", found)
        if is_area and math.prod((counts + 1).tolist()) > MAX_SAMPLES:
            found = f"{math.prod((counts + 1).tolist()):,} with a step of {step:g} m"
            raise InputError(self.who, "zone.step", f"at most {MAX_SAMPLES:,} samples", found)
        x, y = (
            low[k] + (np.arange(counts[k] + 1 + 2 * extra[k]) - extra[k]) * steps[k] for k in (0, 1)
        )
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        if self.kind == "area" and self.zone.x is not None:
            own = []  # the grid has its edges
        return _unique(np.concatenate([grid, *own]))


def signed_distance(points: Floats, corners: Floats) -> Floats:
    """Return the distance (N,) of points (N, 2) to a polygon's edge, negative inside [m]. Its
    corners (K, 2) are in either sense of rotation."""
    others = np.roll(corners, -1, axis=0)
    away = _to_lines(points, corners, others)
    near = ((points >= corners.min(axis=0)) & (points <= corners.max(axis=0))).all(axis=1)
    x = points[near, :1]
    y = points[near, 1:]
    ax, ay = corners.T
    bx, by = others.T
    crosses = (ay <= y) != (by <= y)
    slope = (bx - ax) / np.where(by == ay, 1.0, by - ay)
    inside = np.zeros(len(points), dtype=bool)
    inside[near] = (crosses & (x < ax + (y - ay) * slope)).sum(axis=1) % 2 == 1
    return np.where(inside, -away, away)


def _to_lines(points: Floats, starts: Floats, ends: Floats) -> Floats:
    """Return the distance (N,) of points to the nearest of some line segments (K, 2)."""
    x, y = np.ascontiguousarray(points.T)
    best = np.full(len(points), np.inf)
    for (ax, ay), (bx, by) in zip(starts.tolist(), ends.tolist(), strict=True):
        along_x = bx - ax
        along_y = by - ay
        size = along_x * along_x + along_y * along_y
        share = ((x - ax) * along_x + (y - ay) * along_y) / (size or 1.0)
        np.clip(share, 0.0, 1.0, out=share)
        off_x = x - (ax + share * along_x)
        off_y = y - (ay + share * along_y)
        np.minimum(best, off_x * off_x + off_y * off_y, out=best)
    return np.sqrt(best)


def _nearest(points: Floats, spots: Floats, within: float) -> Floats:
    """Return the distance (N,) of points to the nearest of some spots; inf where none is within."""
    order = np.argsort(points[:, 0], kind="stable")
    x, y = points[order].T
    first = np.searchsorted(x, spots[:, 0] - within, "left").tolist()
    last = np.searchsorted(x, spots[:, 0] + within, "right").tolist()
    best = np.full(len(points), np.inf)
    for (at_x, at_y), a, b in zip(spots.tolist(), first, last, strict=True):
        np.minimum(best[a:b], np.hypot(x[a:b] - at_x, y[a:b] - at_y), out=best[a:b])
    distance = np.empty_like(best)
    distance[order] = best
    return distance


def _along(start: Floats, end: Floats, step: float) -> Floats:
    """Return points (N, 2) on a line, no farther apart than a step, with both ends."""
    count = max(1, math.ceil(math.hypot(*(end - start)) / step - INSIDE_M))
    if count > MAX_SAMPLES:
        raise InputError("zone", "step", f"at most {MAX_SAMPLES:,} samples", f"{count:,}")
    return start + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - start)


def _unique(points: Floats) -> Floats:
    return np.unique(np.round(points, DECIMALS), axis=0)


def _offset(outline: Floats, distance: float) -> Floats:
    """Return the closed line (K, 2) at a distance outside of a convex outline."""
    if distance == 0.0:
        return np.vstack([outline, outline[:1]])
    edges = np.roll(outline, -1, axis=0) - outline
    turn = np.arctan2(-edges[:, 0], edges[:, 1])  # outward normals of a counter-clockwise outline
    points = []
    for k, corner in enumerate(outline):
        first = turn[k - 1]
        last = turn[k]
        sweep = (last - first) % (2.0 * math.pi)
        count = max(1, math.ceil(sweep / math.radians(10.0)))
        angles = first + sweep * np.arange(count + 1) / count
        points.append(corner + distance * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    closed = np.concatenate(points)
    return np.vstack([closed, closed[:1]])


def _places(
    values: object, axes: tuple[int, int], who: str, field_name: str
) -> tuple[PlacePair, ...]:
    """Return checked pairs of places along two axes."""
    rows = listed(values)
    if rows is None:
        raise InputError(who, field_name, "a list of pairs", shown(values))
    checked: list[PlacePair] = []
    for row in rows:
        items = listed(row, 2)
        if items is None or len(items) != 2:
            raise InputError(who, field_name, "pairs of places", shown(row))
        first, second = (_place(a, v, who, field_name) for a, v in zip(axes, items, strict=True))
        checked.append((first, second))
    return tuple(checked)


def _place(axis: int, value: object, who: str, field_name: str) -> Place:
    if isinstance(value, str):
        parsed(axis, value, who, field_name)
        return value
    return Number(cap=1e4, unit="m").checked(who, field_name, value)
