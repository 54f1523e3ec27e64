"""The voxel that docs/engine.md draws, worked by formulas on plain numbers.

A test holds the kernel to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import pe_core as pe
from pe_core.sensors.lidar.bracket import Bracket, Silhouettes, bracket, slice_through
from pe_core.sensors.lidar.definition import position_in_voxels
from pe_core.sensors.lidar.lattice import lattice_of

SPACE = pe.PerceptionSpace()
SIDE = SPACE.interval
MODEL = pe.catalog.load("Pandar64")
STEP = 2.0 * math.pi / MODEL.azimuth_count
SLOPES = [math.tan(e) for e in sorted(MODEL.elevations.tolist())]

TILTED = pe.Sensor("tilted", MODEL, pe.Pose.from_degrees((-0.43, 0.0, 1.8), (5.0, 10.0, 0.0)))
TILTED_CENTER = (8.05, 2.55, 0.35)


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


def _tilted_points() -> list[np.ndarray]:
    offsets = index_of(TILTED_CENTER) + 0.5 - position_of(TILTED)
    return [offsets[:, k].astype(np.float32) for k in range(3)]


def _rotation() -> np.ndarray:
    return TILTED.pose.ground_from_sensor.astype(np.float32)
