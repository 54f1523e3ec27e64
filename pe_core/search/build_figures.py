"""What can be built: figures of a rig on its vehicle, rows of `FIGURES`.

The limits of a search and of a choice, the objectives of a front, the lines of a score and the
fields of the panel follow from the rows. A figure of which something is not known has no value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import combinations, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.arrays import Flags, Floats
from ..base.errors import InputError
from ..base.plugins import shipped
from ..base.values import Number
from ..geometry.grids import PerceptionSpace, in_chunks, top_heights
from ..geometry.poses import Pose, dot
from ..scene.data_sheet import DataSheet
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..scoring.requirements.planes import convex_outline
from ..sensors.kind import kind_of
from .domains import ROUNDING_M
from .figure import Figure
from .placement import Placement

if TYPE_CHECKING:
    from .rig_view import RigView

CELL_M = 0.01  # Side of the squares in which a frontal area is counted [m]
AROUND_M = 2.0  # So far round the body housings are seen from the front [m]
CHUNK = 1 << 18  # The body is drawn in parts of about so many cells, each in little memory
TURNS = 360
LAYERS = 36
"""Azimuths and elevations of the cells of a field of view."""
RAYS = 20_000  # Directions that fill the cells: 5 to 40 fall on one
ALONE = "one sensor alone"  # Why there is no distance and no common field
RELATIVE = 1e-9  # Relative rounding error that is allowed for sums
HOUSING = "housing"
FIELD = "field"
SUM = "sum"
AT = ROUNDING_M
SUMS = ("mass", "power", "data_rate", "price")
"""Figures that add up over the sensors' data sheets, wherever these are."""
LIMIT = {unit: Number(0.0, cap=1e6, unit=unit) for unit in ("m", "m2", "deg", "kg", "W", "Mbit/s")}


@lru_cache(1024)
def sheet_of(model: SensorModel, own: DataSheet) -> DataSheet:
    """Return a sensor's own figures, and the catalogue's where it has none."""
    return own.over(shipped("catalog.data_sheet")(model.name))


def _top(placed: Placement, name: str) -> float:
    return float(placed.hull(name).corners[:, 2].max())


def _width(placed: Placement, name: str) -> float:
    return 2.0 * float(np.abs(placed.hull(name).corners[:, 1]).max())


def _protrusion(placed: Placement, name: str) -> float:
    low, high = placed.vehicle.bounds
    corners = placed.hull(name).corners[:, :2]
    return max(0.0, float((low[:2] - corners).max()), float((corners - high[:2]).max()))


def _cleaning_reach(placed: Placement, name: str) -> float:
    low, high = placed.vehicle.bounds
    at = np.array(placed.rig[name].pose.position)
    inside = min((at - low)[:2].min(), (high - at)[:2].min())
    return math.hypot(max(0.0, float(inside)), float(at[2]))


def _distance(placed: Placement, a: str, b: str) -> float:
    apart = np.array(placed.rig[a].pose.position) - np.array(placed.rig[b].pose.position)
    return float(np.sqrt(dot(apart, apart)))


def _frontal_area(placed: Placement) -> float:
    """Cells that a housing covers and the body does not, seen along x [m2]."""
    grid, body = _seen_from_front(placed.vehicle)
    fans = []
    for sensor in placed.rig:
        outline = convex_outline(placed.hull(sensor.name).corners[:, 1:])
        fans += [(outline[0], *pair) for pair in pairwise(outline[1:])]
    flat = np.pad(np.array(fans), ((0, 0), (0, 0), (0, 1)))
    return int((np.isfinite(top_heights(flat, grid)) & ~body).sum()) * CELL_M**2


@lru_cache(4)
def _seen_from_front(vehicle: Vehicle) -> tuple[PerceptionSpace, Flags]:
    """Return a grid across x, and its cells that the body covers."""
    low, high = vehicle.bounds
    ends = float(low[1]) - AROUND_M, float(high[1]) + AROUND_M, float(high[2]) + AROUND_M
    left, right, top = (round(end / CELL_M) * CELL_M for end in ends)
    grid = PerceptionSpace((left, right), (0.0, top), (0.0, CELL_M), CELL_M)
    turned = vehicle.triangles[:, :, [1, 2, 0]]
    body = np.zeros(grid.shape[:2], bool)
    for some in in_chunks(turned, grid, CHUNK):
        body |= np.isfinite(top_heights(some, grid))
    return grid, body


def _overlap(placed: Placement) -> float:
    """Weakest link of the best chain that joins all sensors: a maximum spanning tree [deg]."""
    first, *fields = (_field(s.model, s.pose.rpy) for s in placed.rig)
    links = [_common(first, each) for each in fields]
    weakest = 360.0
    left = set(range(len(fields)))
    while left:
        joined = max(left, key=lambda k: links[k])
        weakest = min(weakest, links[joined])
        left.remove(joined)
        for k in left:
            links[k] = max(links[k], _common(fields[joined], fields[k]))
    return weakest


def _common(one: Flags, other: Flags) -> float:
    """Return in how many azimuths two fields have a direction in common [deg]."""
    return int((one & other).any(axis=1).sum()) * 360.0 / TURNS


@lru_cache(256)
def _field(model: SensorModel, rpy: tuple[float, float, float]) -> Flags:
    """Return the cells (TURNS, LAYERS) of directions that a sensor sees."""
    x, y, z = kind_of(model).rays(Sensor("field", model, Pose((0.0, 0.0, 0.0), rpy)), RAYS).T
    level = np.abs(x) + np.abs(y) > RELATIVE  # straight up there is no azimuth
    angles = [k * math.tau / TURNS for k in range(TURNS)]
    edges = _turn(np.array([*map(math.cos, angles)]), np.array([*map(math.sin, angles)]))
    layers = [math.sin((k / LAYERS - 0.5) * math.pi) for k in range(1, LAYERS)]
    seen = np.zeros((TURNS, LAYERS), bool)
    columns = np.searchsorted(edges, _turn(x[level], y[level]), side="right") - 1
    seen[columns, np.searchsorted(layers, z[level])] = True
    return seen


def _turn(x: Floats, y: Floats) -> Floats:
    """Return what grows with the azimuth, from 0 to 4: sums alone, the same on each machine."""
    along = x / (np.abs(x) + np.abs(y))
    return np.where(y >= 0.0, 1.0 - along, 3.0 + along)


def _sum(key: str, placed: Placement) -> float:
    return sum(getattr(sheet_of(s.model, s.sheet), key) for s in placed.rig)


KNOWN: dict[str, Callable[[str, Placement, Sensor], bool]] = {
    "": lambda key, placed, sensor: True,
    HOUSING: lambda key, placed, sensor: sensor.name in placed.housings,
    FIELD: lambda key, placed, sensor: len(kind_of(sensor.model).rays(sensor, 1)) > 0,
    SUM: lambda key, placed, sensor: getattr(sheet_of(sensor.model, sensor.sheet), key) is not None,
}
"""By what a figure needs of each sensor: whether that is known."""


@dataclass(frozen=True, slots=True)
class BuildFigure(Figure):
    """A figure of what can be built. `each` is the figure of a `Placement` and the names of `arity`
    sensors: none, one, or two. `needs` is what it takes of each sensor, of `KNOWN`. Rounding may
    move a placement by `slack`."""

    each: Callable[..., float] = float
    arity: int = 0
    needs: str = ""
    on_body: bool = False
    slack: float = 0.0
    is_seen: bool = False

    def lacking(self, placed: Placement) -> tuple[str, ...]:
        """Return of what it is not known: names of sensors, or why there is no such figure."""
        if self.on_body and placed.vehicle is None:
            return ("no vehicle",)
        if self.higher and len(placed.rig) < 2:
            return (ALONE,)
        known = KNOWN[self.needs]
        return tuple(s.name for s in placed.rig if not known(self.key, placed, s))

    def values(self, view: RigView) -> Sequence[float]:
        """Return the figure of a rig; none where something is not known."""
        value = self.of_placement(view.placement)
        return () if value is None else (value,)

    def of_placement(self, placed: Placement) -> float | None:
        """Return the figure of a placement; None where something is not known."""
        if self.lacking(placed):
            return None
        names = [sensor.name for sensor in placed.rig]
        return self.worst([self.each(placed, *some) for some in combinations(names, self.arity)])

    def required(self, placed: Placement, source: str, field: str) -> None:
        """Raise `InputError` where something is not known; a field of `source` asks for it."""
        if lacking := self.lacking(placed):
            expected = f"a known {self.name} of each sensor"
            found = f"unknown: {', '.join(dict.fromkeys(lacking))}"
            raise InputError(source, field, expected, found)

    def rules(
        self, value: float | None, start: Placement, moving: Set[str]
    ) -> Iterator[tuple[str, Callable[[Placement], bool]]]:
        """Yield the rules of a limit: their texts, and whether a placement breaks them. Its value
        is that of the start if it is None. `InputError` where what the limit needs is not known of
        the start."""
        if self.higher and (value == 0.0 or len(start.rig) < 2):
            return
        self.required(start, "limits", self.key)
        limit = value if value is not None else self.of_placement(start) or 0.0
        sign = self.signed(1.0)
        edge = sign * limit + self.slack + (limit * RELATIVE if self.needs == SUM else 0.0)

        def breaks(some: tuple[str, ...], placed: Placement) -> bool:
            return sign * self.each(placed, *some) > edge

        for some in combinations([sensor.name for sensor in start.rig], self.arity):
            if not some or moving & set(some):
                named = f" of {' and '.join(map(repr, some))}" if some else ""
                yield f"limits.{self.key}{named}", partial(breaks, some)


LIMIT[""] = Number(0.0, cap=1e12)
"""What a limit may be, by the unit of its figure."""


def _row(key: str, unit: str, about: str, each: Callable[..., float], **more: Any) -> BuildFigure:
    label = key.replace("_", " ").capitalize()
    return BuildFigure(key, label, unit, about, rule=LIMIT[unit], each=each, **more)


def _sum_row(key: str, unit: str) -> BuildFigure:
    label = key.replace("_", " ")
    return _row(key, unit, f"Sum of all sensors: {label}", partial(_sum, key), needs=SUM)


BUILD_FIGURES = {
    row.key: row
    for row in (
        _row("height", "m", "Top of the highest housing", _top, arity=1, slack=AT),
        _row(
            "width",
            "m",
            "Overall width: twice the distance of a housing from the middle",
            _width,
            arity=1,
            slack=2 * AT,
        ),
        _row(
            "distance",
            "m",
            "Smallest distance between any two sensors' origins",
            _distance,
            arity=2,
            slack=AT,
            higher=True,
        ),
        _row(
            "protrusion",
            "m",
            "How far a housing reaches beyond the body's length or width",
            _protrusion,
            arity=1,
            needs=HOUSING,
            on_body=True,
            slack=AT,
        ),
        _row(
            "cleaning_reach",
            "m",
            "How far a sensor is from the nearest ground beside the body",
            _cleaning_reach,
            arity=1,
            on_body=True,
            slack=AT,
        ),
        _row(
            "frontal_area",
            "m2",
            "Area that housings add to the body's silhouette from the front",
            _frontal_area,
            needs=HOUSING,
            on_body=True,
            decimals=4,
        ),
        _row(
            "overlap",
            "deg",
            "Smallest azimuth that neighbours have in common, to calibrate them to each other",
            _overlap,
            needs=FIELD,
            decimals=0,
            higher=True,
        ),
        _sum_row("mass", "kg"),
        _sum_row("power", "W"),
        _sum_row("data_rate", "Mbit/s"),
        _sum_row("price", ""),
    )
}
"""What can be built, by name."""
