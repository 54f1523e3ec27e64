"""Edges of a vehicle by name, and positions as distances from them.

A designer writes ``"0.35 m behind windshield top"`` in place of x. Distances run along the axes of
the ground frame, as dimensions in a drawing do: that to an edge across the vehicle is measured at
the sensor's own y. Beyond the ends of an edge its end counts. All are rounded as placements are.

Three kinds of edges: the vehicle's outer planes, its axles, its centre line and the ground; the
outline of each part of its mesh, ``PART SIDE``; and edges that a study states by points.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..base.arrays import Floats
from ..base.codec import Schema
from ..base.errors import InputError, one_of, require_kind, shown
from ..base.recent_cache import RecentCache
from ..base.setting import Named
from ..base.values import A_NAME, listed, vector
from ..geometry.poses import METRES
from ..geometry.surfaces import section
from ..scene.rig import POSITION_AXES
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..scoring.requirements import VehiclePlanes
from ..search import POSITION_DECIMALS

RECENT = 64  # Sections of parts that are kept: a sensor that is dragged asks for three a move
ROUNDS = 100  # How often the coordinates of a position that depend on each other are computed
WAYS = {"x": ("ahead of", "behind"), "y": ("left of", "right of"), "z": ("above", "below")}
"""Words for a position that is on the positive and on the negative side of an edge."""
KEPT = ("xyz", "xz", "yz", "z")
"""Axes of which distances are tried to tell a position, the best first."""
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
EXAMPLE = '"0.35 m behind windshield top"'
DISTANCE = re.compile(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+)\s*(m|cm|mm)?\s+([a-z]+(?: of)?)\s+(.+)")
PLANES = {
    "x": {"front": "front", "rear": "rear", "front axle": "front_axle", "rear axle": "rear_axle"},
    "y": {"left side": "left", "right side": "right"},
    "z": {},
}
"""Edges that are planes of the vehicle, by the axis that is measured from them."""
CENTER_LINE = "center line"
GROUND = "ground"
TOP = "highest point"
ALWAYS = {"x": (), "y": (CENTER_LINE,), "z": (GROUND, TOP)}
FIXED_NAMES = frozenset(
    name for known in (PLANES, ALWAYS) for own in known.values() for name in own
)
"""Names of edges of every vehicle."""
SIDES = {
    "front": (0, 1.0),
    "rear": (0, -1.0),
    "left": (1, 1.0),
    "right": (1, -1.0),
    "top": (2, 1.0),
    "bottom": (2, -1.0),
}
"""Sides of a part: the axis, and whether its largest or its least coordinate is the edge."""
SIDES_OF = {"x": ("front", "rear", "top", "bottom"), "y": ("left", "right"), "z": ("top", "bottom")}
"""Sides of a part that each axis is measured from."""


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge of the vehicle that a study states.

    `InputError` when there are fewer than two points, or all are one.

    Parameters
    ----------
    name : str
        One line; other than the names that every vehicle has.
    points : (N, 3) float
        Points of the edge in the ground frame [m], in any order: it runs along the axis on which
        they are farthest apart, straight from one to the next.
    """

    name: Named
    points: tuple[tuple[float, float, float], ...]

    def __post_init__(self) -> None:
        name = A_NAME.checked("edge", "name", self.name)
        object.__setattr__(self, "name", name)
        who = f"edge {name!r}"
        rows = listed(self.points)
        if rows is None or len(rows) < 2:
            found = shown(self.points) if rows is None else f"{len(rows)}"
            raise InputError(who, "points", "two points or more", found)
        points = tuple(vector(who, "points", row, count=3, rule=METRES) for row in rows)
        object.__setattr__(self, "points", points)
        if len(set(points)) < 2:
            raise InputError(who, "points", "two different points", f"{points[0]} alone")
        if name in FIXED_NAMES:
            raise InputError(who, "name", "a name that not every vehicle has", shown(name))

    @property
    def along(self) -> int:
        """The axis along which the edge runs: 0, 1 or 2."""
        points = np.array(self.points)
        return int(np.argmax(points.max(axis=0) - points.min(axis=0)))

    def at(self, axis: int, position: Sequence[float]) -> float:
        """Return a coordinate of the edge [m] where it passes a position (3,)."""
        along = self.along
        points = np.array(self.points)
        ordered = points[np.argsort(points[:, along], kind="stable")]
        return float(np.interp(position[along], ordered[:, along], ordered[:, axis]))


def checked_edges(edges: Any) -> tuple[Edge, ...]:
    """Return edges that a study states; `InputError` when two have one name."""
    if (rows := listed(edges)) is None:
        raise InputError("vehicle", "edge", "a list of edges", shown(edges))
    for row in rows:
        require_kind("vehicle", "edge", row, Edge)
    names = [row.name for row in rows]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError("vehicle", "edge", "each name once", f"{twice[0]!r} twice")
    return tuple(rows)


@dataclass(frozen=True, slots=True)
class Distance:
    """How far a position is from an edge along an axis: `offset` [m], forward, left or up."""

    axis: str
    offset: float
    edge: str

    @property
    def way(self) -> str:
        """On which side of the edge it is: "behind"."""
        return WAYS[self.axis][self.offset < 0.0]

    @property
    def text(self) -> str:
        """The distance as it is written: "0.35 m behind windshield top"."""
        number = f"{abs(self.offset):.{POSITION_DECIMALS}f}".rstrip("0").rstrip(".")
        return f"{number} m {self.way} {self.edge}"

    @classmethod
    def parsed(cls, axis: str, text: str, source: str, field: str) -> "Distance":
        """Return the distance of a text; `InputError` when it is none along this axis."""
        match = DISTANCE.fullmatch(text.strip())
        ways = WAYS[axis]
        if match is None or match[3] not in ways:
            expected = f"metres, or a distance from an edge ({EXAMPLE}): {' or '.join(ways)}"
            raise InputError(source, field, expected, shown(text))
        length = round(float(match[1]) * UNITS[match[2] or "m"], POSITION_DECIMALS)
        METRES.checked(source, field, length)
        return cls(axis, -length if match[3] == ways[1] else length, match[4].strip())


MetresOrDistance = float | Distance
"""A coordinate of a position: metres in the ground frame, or a distance from an edge."""


@dataclass(frozen=True, slots=True)
class PositionRule:
    """The rule of a position in a file: three numbers [m], or texts of distances from edges."""

    def checked(self, source: str, field: str, value: Any) -> tuple[MetresOrDistance, ...]:
        """Return the coordinates, or raise `InputError`."""
        items = listed(value, len(POSITION_AXES))
        if items is None or len(items) != len(POSITION_AXES):
            raise InputError(source, field, "three coordinates", shown(value))
        found: list[MetresOrDistance] = []
        for number, (axis, each) in enumerate(zip(POSITION_AXES, items, strict=True)):
            path = f"{field}[{number}]"
            if isinstance(each, str):
                found.append(Distance.parsed(axis, each, source, path))
            else:
                found.append(METRES.checked(source, path, each))
        return tuple(found)

    @staticmethod
    def json_schema(of_rule: Callable[[object], Schema]) -> Schema:
        """Return the JSON schema of such positions."""
        about = f"A distance from an edge of the vehicle: {EXAMPLE}"
        text = {"type": "string", "description": about}
        item = {"anyOf": [of_rule(METRES), text]}
        count = len(POSITION_AXES)
        return {"type": "array", "items": item, "minItems": count, "maxItems": count}


POSITION = PositionRule()


class VehicleEdges:
    """The edges of a vehicle, without one those that every vehicle has.

    Parameters
    ----------
    vehicle : Vehicle, optional
    own : sequence of Edge
        Edges that a study states. One of the name of a part's edge takes its place.
    reference : Reference, optional
        The axles; by default those of parts that are wheels by name, else of tyres by shape.
    """

    def __init__(
        self, vehicle: Vehicle | None, own: Sequence[Edge] = (), reference: Reference | None = None
    ) -> None:
        self._vehicle = vehicle
        self._reference = reference
        self._own = {edge.name: edge for edge in own}
        self._parts: dict[str, Floats] = {}
        self._sides = RecentCache[float](RECENT)

    def names(self, axis: str) -> tuple[str, ...]:
        """Return the names of the edges from which an axis, "x", "y" or "z", is measured."""
        own = (e.name for e in self._own.values() if POSITION_AXES[e.along] != axis)
        parts = () if self._vehicle is None else self._vehicle.part_names
        of_parts = (f"{part} {side}" for part in parts for side in SIDES_OF[axis])
        others = (name for name in of_parts if name not in self._own)
        return tuple(dict.fromkeys((*PLANES[axis], *ALWAYS[axis], *own, *others)))

    def at(self, name: str, axis: str, position: Sequence[float]) -> float:
        """Return the coordinate of an edge where it passes a position [m].

        `InputError` when there is no such edge for the axis.

        Parameters
        ----------
        name : str
            One of `names`.
        axis : {"x", "y", "z"}
            The axis that is measured.
        position : (3,) float
            A position in the ground frame [m].
        """
        if name not in self.names(axis):
            raise InputError("edges", axis, one_of(self.names(axis), name), shown(name))
        number = POSITION_AXES.index(axis)
        if name in (CENTER_LINE, GROUND):
            return 0.0
        if name in self._own:
            return round(self._own[name].at(number, position), POSITION_DECIMALS) + 0.0
        if self._vehicle is None:
            raise InputError("edges", axis, "a vehicle, for its edges", "none")
        if name == TOP:
            return round(float(self._vehicle.bounds[1][2]), POSITION_DECIMALS)
        if name in PLANES[axis]:
            return self._plane(axis, PLANES[axis][name])
        return self._side(name, number, position)

    def distance(self, name: str, axis: str, position: Sequence[float]) -> Distance:
        """Return how far a position (3,) is from an edge along an axis; `InputError` as of `at`."""
        offset = position[POSITION_AXES.index(axis)] - self.at(name, axis, position)
        return Distance(axis, round(offset, POSITION_DECIMALS) + 0.0, name)

    def position(self, coordinates: Sequence[MetresOrDistance]) -> tuple[float, float, float]:
        """Return the position [m] of three coordinates.

        A coordinate may depend on another one, as x does on y at an edge that is curved.
        `InputError` as of `at`, or when they have no common solution.
        """
        position = [0.0 if isinstance(each, Distance) else each for each in coordinates]
        for _ in range(ROUNDS):
            before = list(position)
            for number, each in enumerate(coordinates):
                if isinstance(each, Distance):
                    at = self.at(each.edge, each.axis, position) + each.offset
                    position[number] = round(at, POSITION_DECIMALS) + 0.0
            if position == before:
                x, y, z = position
                return x, y, z
        names = " and ".join(each.edge for each in coordinates if isinstance(each, Distance))
        raise InputError("edges", "", "distances that meet in one position", f"those from {names}")

    def coordinates(
        self, position: Sequence[float], measured_from: Mapping[str, str]
    ) -> tuple[MetresOrDistance, ...]:
        """Return a position (3,) [m] by distances from edges, by axis; metres of other axes, and
        where distances would not give back the position exactly: two edges may run together."""
        plain = tuple(position)
        for axes in KEPT:
            names = {axis: name for axis, name in measured_from.items() if axis in axes}
            found = {each.axis: each for each in self.distances(plain, names)}
            pairs = zip(POSITION_AXES, plain, strict=True)
            written = tuple(found.get(axis, metres) for axis, metres in pairs)
            with suppress(InputError):
                if self.position(written) == plain:
                    return written
        return plain

    def distances(
        self, position: Sequence[float], measured_from: Mapping[str, str]
    ) -> tuple[Distance, ...]:
        """Return the distances of a position (3,) [m] from edges, by axis; an edge that the vehicle
        does not have is left out."""
        found = []
        for axis, name in measured_from.items():
            with suppress(InputError):
                found.append(self.distance(name, axis, position))
        return tuple(found)

    @cached_property
    def _planes(self) -> VehiclePlanes:
        assert self._vehicle is not None
        return VehiclePlanes.of(self._vehicle, self._reference)

    def _plane(self, axis: str, plane: str) -> float:
        known = self._planes.along if axis == "x" else self._planes.across
        if plane not in known:
            raise InputError("edges", axis, self._planes.missing[plane], "none")
        return round(known[plane], POSITION_DECIMALS) + 0.0

    def _side(self, name: str, axis: int, position: Sequence[float]) -> float:
        """Return a coordinate of the outermost point of a part on one side, in the section through
        a position: across x for the left and the right side, else across y."""
        part, _, side = name.rpartition(" ")
        of_side, sign = SIDES[side]
        across = 0 if of_side == 1 else 1
        at = position[across]

        def outermost() -> float:
            points = section(self._triangles(part, POSITION_AXES[axis]), across, at)
            point = points[int(np.argmax(sign * points[:, of_side]))]
            return round(float(point[axis]), POSITION_DECIMALS) + 0.0

        return self._sides.made((name, axis, at), outermost)

    def _triangles(self, part: str, axis: str) -> Floats:
        if part not in self._parts:
            assert self._vehicle is not None
            number = self._vehicle.part_names.index(part)
            self._parts[part] = self._vehicle.triangles[self._vehicle.parts == number]
        if not len(self._parts[part]):
            raise InputError("edges", axis, "a part with faces", shown(part))
        return self._parts[part]
