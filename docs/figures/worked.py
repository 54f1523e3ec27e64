"""The two voxels that docs/engine.md works by hand: their numbers, by formulas on plain numbers.

The page has `bracket_rows` and `upright_rows` word for word, and a test holds them to the kernels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import pe_core as pe
from pe_core.sensors.lidar.bracket import Bracket, Silhouettes, bracket, slice_through
from pe_core.sensors.lidar.lattice import lattice_of
from pe_core.sensors.lidar.tie_rules import position_in_voxels
from pe_core.sensors.lidar.upright import Upright, circle, faces_of

SPACE = pe.PerceptionSpace()
SIDE = SPACE.interval
MODEL = pe.catalog.load("Pandar64")
STEP = 2.0 * math.pi / MODEL.azimuth_count
SLOPES = [math.tan(e) for e in sorted(MODEL.elevations.tolist())]

TILTED = pe.Sensor("tilted", MODEL, pe.Pose.from_degrees((-0.43, 0.0, 1.8), (5.0, 10.0, 0.0)))
TILTED_CENTER = (8.05, 2.55, 0.35)
LEVEL = pe.Sensor("level", MODEL, pe.Pose((-0.43, 0.0, 1.8)))
LEVEL_CENTER = (11.15, 3.25, 1.15)


def index_of(center: tuple[float, float, float]) -> np.ndarray:
    """(1, 3) which voxel has this centre."""
    return np.round((np.array([center]) - SPACE.origin) / SIDE - 0.5).astype(int)


def position_of(sensor: pe.Sensor) -> np.ndarray:
    """(3,) a sensor seen from the space's lowest corner, in sides."""
    return position_in_voxels(sensor.pose.position, SPACE.origin, SIDE)


def defined(sensor: pe.Sensor, center: tuple[float, float, float]) -> int:
    """m of the voxel, by definition."""
    return int(pe.measure(sensor, [center], SIDE)[0])


def channels_between(low: float, high: float) -> list[int]:
    """Channels, numbered from the lowest, whose slope lies between two slopes."""
    return [k for k, slope in enumerate(SLOPES) if low <= slope <= high]


@dataclass(frozen=True)
class Window:
    """A window of azimuth [steps] and slope, and the beams in it."""

    first: float
    last: float
    low: float
    high: float

    @property
    def columns(self) -> list[int]:
        """Azimuths in it."""
        return list(range(math.ceil(self.first), math.floor(self.last) + 1))

    @property
    def rows(self) -> list[int]:
        """Channels in it."""
        return channels_between(self.low, self.high)

    @property
    def beams(self) -> int:
        """How many there are: a product."""
        return len(self.columns) * len(self.rows)


@dataclass(frozen=True)
class Bracketed:
    """What `bracket` sees of the tilted voxel."""

    offset: list[float]
    place: list[float]
    flat: float
    middle: float
    depth: float
    width: float
    height: float
    slice_width: float
    slice_height: float
    skew: float

    @property
    def outer(self) -> Window:
        """Holds the cube: slopes over the nearest and the farthest distance."""
        near, far, z = self.near, self.far, self.place[2]
        reach = self.width / near / STEP
        low, high = z - self.height, z + self.height
        return Window(
            self.middle - reach,
            self.middle + reach,
            low / (far if low > 0 else near),
            high / (near if high > 0 else far),
        )

    @property
    def inner(self) -> Window:
        """Lies in the slice: slopes over its own farthest and nearest distance."""
        (near, far), z = self.inner_distances, self.place[2]
        low, high = z - self.slice_height, z + self.slice_height
        left = math.atan(self.slice_width / (self.flat + self.skew * self.slice_width)) / STEP
        right = math.atan(self.slice_width / (self.flat - self.skew * self.slice_width)) / STEP
        return Window(
            self.middle - right,
            self.middle + left,
            low / (near if low > 0 else far),
            high / (far if high > 0 else near),
        )

    @property
    def inner_distances(self) -> tuple[float, float]:
        """Least and greatest distance of the slice's rectangle from the axis."""
        drift = abs(self.skew) * self.slice_width
        return self.flat - drift, math.hypot(self.flat + drift, self.slice_width)

    @property
    def near(self) -> float:
        """Least distance of the cube from the axis."""
        return self.flat - self.depth

    @property
    def far(self) -> float:
        """Greatest distance of the cube from the axis."""
        return math.hypot(self.flat + self.depth, self.width)


def bracketed() -> Bracketed:
    """See the tilted voxel as the kernel does."""
    seen = Silhouettes.of(_tilted_points(), _rotation(), np.float32(STEP))
    slice_width, slice_height, skew = (float(w[0]) for w in slice_through(seen))
    offset = [float(p[0]) for p in _tilted_points()]
    place = (np.array(offset) @ TILTED.pose.ground_from_sensor).tolist()
    flat, middle, depth, width = (
        float(w[0]) for w in (seen.flat, seen.middle, seen.depth, seen.width)
    )
    return Bracketed(
        offset,
        place,
        flat,
        middle,
        depth,
        width,
        float(seen.height),
        slice_width,
        slice_height,
        skew,
    )


def kernel_bracket() -> Bracket:
    """Return what the kernel says of the tilted voxel."""
    bounds = lattice_of(MODEL).slope_bounds
    assert bounds is not None
    rotation = TILTED.pose.ground_from_sensor
    return bracket(_tilted_points(), rotation, bounds, MODEL.azimuth_count)


def bracket_rows() -> list[str]:
    """Rows of the page's table of the tilted voxel."""
    b = bracketed()
    outer, inner = b.outer, b.inner
    return [
        _row("centre, seen from the sensor along the ground's axes", "", _together(b.offset)),
        _row("the same, along the sensor's axes", "x, y, z", _together(b.place)),
        _row("distance from the sensor's axis", "flat = sqrt(x^2 + y^2)", f"{b.flat:.2f}"),
        _row("azimuth, in steps of 0.2 degrees", "middle = atan2(y, x) / step", f"{b.middle:.2f}"),
        _row(
            "half the cube's extents",
            "depth, width, height",
            _together((b.depth, b.width, b.height), 3),
        ),
        _row(
            "distances of the cube",
            "near = flat - depth, far = sqrt((flat + depth)^2 + width^2)",
            f"{b.near:.2f}, {b.far:.2f}",
        ),
        _row("**outer** azimuths", "middle -+ width / near / step", _azimuths(outer)),
        _row("slopes", "(z - height) / near, (z + height) / far", _channels(outer)),
        _row("beams that may pass", "upper = rows * columns", _product(outer)),
        _row("the slice: how it recedes to the left", "skew", f"{b.skew:.3f}"),
        _row(
            "half sides of the rectangle in it",
            "slice_width, slice_height",
            f"{b.slice_width:.3f}, {b.slice_height:.3f}",
        ),
        _row(
            "distances of that rectangle, nearest and farthest",
            "flat - abs(skew) slice_width, sqrt((flat + abs(skew) slice_width)^2 + slice_width^2)",
            _together(b.inner_distances),
        ),
        _row(
            "**inner** azimuths",
            "middle -+ atan(slice_width / (flat -+ skew * slice_width)) / step",
            _azimuths(inner),
        ),
        _row(
            "slopes",
            "(z - slice_height) / farthest, (z + slice_height) / nearest",
            _channels(inner),
        ),
        _row("beams that must pass", "lower = rows * columns", _product(inner)),
        _row("beams that pass, each tested", "m", f"**{defined(TILTED, TILTED_CENTER)}**"),
    ]


@dataclass(frozen=True)
class Crossing:
    """An azimuth through the square of the level voxel: distances [sides], slopes, channels."""

    azimuth: int
    enter: float
    leave: float
    low: float
    high: float

    @property
    def channels(self) -> list[int]:
        """Channels that pass the voxel at this azimuth."""
        return channels_between(self.low, self.high)


def faces() -> list[float]:
    """x0, x1, y0, y1, z0, z1 of the level voxel, seen from the sensor, in sides."""
    corners = [c.astype(np.float32) for c in index_of(LEVEL_CENTER).T]
    return [float(f[0]) for f in faces_of(corners, position_of(LEVEL))]


def corner_azimuths() -> tuple[float, float]:
    """Azimuths of the square's outermost corners, in steps."""
    x0, x1, y0, y1, _, _ = faces()
    return math.atan2(y0, x1) / STEP, math.atan2(y1, x0) / STEP


def crossings() -> list[Crossing]:
    """Every azimuth that meets the level voxel."""
    x0, x1, y0, y1, z0, z1 = faces()
    low, high = corner_azimuths()
    found = []
    for j in range(math.ceil(low), math.floor(high) + 1):
        c, s = math.cos(j * STEP), math.sin(j * STEP)
        enter, leave = max(x0 / c, y0 / s), min(x1 / c, y1 / s)
        slopes = [z / d for z in (z0, z1) for d in (enter, leave)]
        found.append(Crossing(j, enter, leave, min(slopes[:2]), max(slopes[2:])))
    return found


def kernel_azimuths() -> list[int]:
    """Azimuths that the kernel says meet the level voxel."""
    corners = [c.astype(np.float32) for c in index_of(LEVEL_CENTER).T]
    azimuths, unsure = circle(MODEL.azimuth_count, 0.0).meeting(
        faces_of(corners, position_of(LEVEL))
    )
    assert not unsure[0]
    entry, turn, count = azimuths[:, 0].astype(int).tolist()
    return [entry - 2 * MODEL.azimuth_count + turn * n for n in range(count)]


def kernel_upright() -> tuple[int, bool]:
    """Return what the kernel counts through the level voxel, and whether it is unsure."""
    slopes = lattice_of(MODEL).slope_counts
    assert slopes is not None
    nothing = np.zeros((len(SLOPES), MODEL.azimuth_count), bool)
    upright = Upright.of(slopes, LEVEL.pose.ground_from_sensor, nothing, 0.0)
    corners = [c.astype(np.float32) for c in index_of(LEVEL_CENTER).T]
    counts, unsure = upright.count(corners, position_of(LEVEL))
    return int(counts[0]), bool(unsure[0])


def upright_rows() -> list[str]:
    """Rows of the page's table of the level voxel."""
    x0, x1, y0, y1, z0, z1 = faces()
    low, high = corner_azimuths()
    meeting = [c.azimuth for c in crossings()]
    rows = [
        _row("faces, seen from the sensor", "x0, x1", f"{x0:.2f}, {x1:.2f}"),
        _row("", "y0, y1", f"{y0:.2f}, {y1:.2f}"),
        _row("", "z0, z1", f"{z0:.2f}, {z1:.2f}"),
        _row(
            "azimuths of the outermost corners, in steps",
            "atan2(y0, x1), atan2(y1, x0)",
            f"{low:.3f}, {high:.3f}: {_listed(meeting)}",
        ),
    ]
    for c in crossings():
        rows += [
            _row(
                f"azimuth {c.azimuth} cuts the square",
                "max(x0 / cos, y0 / sin), min(x1 / cos, y1 / sin)",
                f"{c.enter:.2f} to {c.leave:.2f}",
            ),
            _row(
                "slopes there",
                "min(z0 / enter, z0 / leave), max(z1 / enter, z1 / leave)",
                f"{c.low:.5f} to {c.high:.5f}: {_listed(c.channels)}",
            ),
        ]
    counted = " + ".join(str(len(c.channels)) for c in crossings())
    return [*rows, _row("beams that pass", "m", f"{counted} = **{defined(LEVEL, LEVEL_CENTER)}**")]


def _tilted_points() -> list[np.ndarray]:
    offsets = index_of(TILTED_CENTER) + 0.5 - position_of(TILTED)
    return [offsets[:, k].astype(np.float32) for k in range(3)]


def _rotation() -> np.ndarray:
    return TILTED.pose.ground_from_sensor.astype(np.float32)


def _row(what: str, formula: str, value: str) -> str:
    return f"| {what} | {formula and f'`{formula}`'} | {value} |"


def _together(values: Sequence[float], digits: int = 2) -> str:
    return ", ".join(f"{v:.{digits}f}" for v in values)


def _azimuths(window: Window) -> str:
    return f"{window.first:.2f} to {window.last:.2f}: {_listed(window.columns)}"


def _channels(window: Window) -> str:
    return f"{window.low:.5f} to {window.high:.5f}: {_listed(window.rows)}"


def _product(window: Window) -> str:
    return f"{len(window.rows)} * {len(window.columns)} = **{window.beams}**"


def _listed(numbers: list[int]) -> str:
    if len(numbers) < 3:
        return " and ".join(str(n) for n in numbers)
    return f"{numbers[0]} to {numbers[-1]}"


if __name__ == "__main__":
    print("\n".join([*bracket_rows(), "", *upright_rows()]))
