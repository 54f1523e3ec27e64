"""A LiDAR's intrinsics: the beams of one revolution."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import Floats, read_only
from ...base.errors import InputError, shown
from ...base.values import A_NAME, Angle, Number, Whole, all_as_in_file, choice, numbers, pair
from ...scene.rig import Sensor, SensorModel
from ..field_of_view import NEAREST, SHORTEST_RANGE_M, checked_ranges

FULL_CIRCLE = (-math.pi, math.pi)
STEPS = Whole(1, 360_000, "azimuths")
RANGE = Number(SHORTEST_RANGE_M, cap=1e5, unit="m", noun="length")
FOV = Angle(-720.0, 720.0)
ALL = "all"
ROAD = "road"
RETURNS = (ALL, ROAD)
MAX_BEAMS = 10_000_000
"""A frame of more is a typing error: it has sixty times the beams of the catalogue's largest."""


@dataclass(frozen=True, eq=False)
class Lidar(SensorModel):
    """Intrinsics of a LiDAR: the beams of one revolution (one frame).

    A beam is a channel's elevation at an azimuth ``a_j = j * step + offset of the channel`` with
    ``step = 360 deg / azimuth_count``; beams outside `horizontal_fov` do not exist.

    `InputError` when there are no beams or more than ten million, or a name, an angle, a count or
    the range is impossible.

    Parameters
    ----------
    name : str
        Catalogue name, or the user's own.
    elevations : (C,) float
        Elevation of each channel above the horizon [rad].
    azimuth_count : int
        Number of azimuth steps in a full circle.
    max_range : float
        Farthest distance at which a beam may enter a voxel [m].
    azimuth_offsets : (C,) float, optional
        Added to the azimuth of each channel, counter-clockwise seen from above [rad].
    horizontal_fov : (low, high) float
        Azimuths the sensor scans, before the offsets [rad].
    min_range : float
        A beam counts in a voxel that it leaves no nearer than this [m].
    returns : {"all", "road"}
        Whether each beam returns, or as on the road: then m is an expected number of points
        (`lidar.returns`).

    Angles are stored as reading them back from a file in degrees gives them: an angle that is the
    `math.radians` of no float changes by one unit in the last place.
    """

    kind: ClassVar[str] = "lidar"
    fuses_early: ClassVar[bool] = True

    name: str
    elevations: Floats
    azimuth_count: int
    max_range: float
    azimuth_offsets: Floats = None  # type: ignore[assignment]  # zeros
    horizontal_fov: tuple[float, float] = FULL_CIRCLE
    min_range: float = NEAREST
    returns: str = ALL

    def __post_init__(self) -> None:
        name = A_NAME.checked("lidar", "name", self.name)
        elevations = _angles(name, "elevations", self.elevations, 90.0)
        offsets = (
            np.zeros_like(elevations)
            if self.azimuth_offsets is None
            else _angles(name, "azimuth_offsets", self.azimuth_offsets, 180.0)
        )
        if offsets.shape != elevations.shape:
            raise InputError(
                name, "azimuth_offsets", f"{len(elevations)}, one a channel", len(offsets)
            )
        fov = pair(name, "horizontal_fov", self.horizontal_fov, FOV, same=True)
        nearest, farthest = checked_ranges(name, self.min_range, self.max_range, RANGE)
        checked = {
            "elevations": read_only(elevations),
            "azimuth_offsets": read_only(offsets),
            "azimuth_count": STEPS.checked(name, "azimuth_count", self.azimuth_count),
            "max_range": farthest,
            "min_range": nearest,
            "horizontal_fov": fov,
            "returns": choice(name, "returns", self.returns, RETURNS),
        }
        for key, value in checked.items():
            object.__setattr__(self, key, value)
        if not len(self.azimuth_steps):
            raise InputError(
                name, "horizontal_fov", "a range with at least one azimuth", self.horizontal_fov
            )
        if self.beam_count > MAX_BEAMS:
            raise InputError(name, "elevations", f"at most {MAX_BEAMS} beams", self.beam_count)

    @classmethod
    def from_directions(
        cls, name: str, directions: ArrayLike, max_range: float, min_range: float = NEAREST
    ) -> "Lidar":
        """Return a LiDAR of an arbitrary pattern (a rosette, a raster): every beam is a channel.

        `InputError` when the directions are not (B, 3) finite numbers, or one has no length.

        Parameters
        ----------
        directions : (B, 3) float
            Directions of a frame's beams in the sensor frame, of any length but zero.
        max_range, min_range : float
            [m]
        """
        beams = np.asarray(directions, dtype=float)
        if beams.ndim != 2 or beams.shape[1:] != (3,) or not len(beams):
            raise InputError(name, "directions", "(B, 3) numbers, B > 0", beams.shape)
        bad = ~(np.isfinite(beams).all(axis=1) & (np.abs(beams).max(axis=1) > 0.0))
        if bad.any():
            found = f"beam {int(np.flatnonzero(bad)[0])}: {beams[bad][0].tolist()}"
            raise InputError(name, "directions", "finite vectors of a length above 0", found)
        elevations = [math.atan2(z, math.hypot(x, y)) for x, y, z in beams.tolist()]
        azimuths = [math.atan2(y, x) for x, y, _ in beams.tolist()]
        return cls(
            name,
            np.array(elevations),
            azimuth_count=1,
            max_range=max_range,
            azimuth_offsets=np.array(azimuths),
            min_range=min_range,
        )

    @property
    def azimuth_step(self) -> float:
        """Angle between two azimuths of a channel [rad]."""
        return 2.0 * math.pi / self.azimuth_count

    @cached_property
    def azimuth_steps(self) -> NDArray[np.int64]:
        """(A,) the integers j of the existing azimuths ``j * step``, ascending."""
        low, high = self.horizontal_fov
        if high - low >= 2.0 * math.pi - 1e-9:
            return read_only(np.arange(self.azimuth_count))
        margin = 1e-9  # rounding may put an azimuth just outside of a bound given in degrees
        first = math.ceil(low / self.azimuth_step - margin)
        return read_only(np.arange(first, math.floor(high / self.azimuth_step + margin) + 1))

    @property
    def beam_count(self) -> int:
        """Number of beams B = C * A of a frame."""
        return len(self.elevations) * len(self.azimuth_steps)

    @cached_property
    def directions(self) -> Floats:
        """(B, 3) unit directions in the sensor frame, channel by channel (eq. 1).

        Beam ``c * A + j`` is channel c at the j-th azimuth. Built from scalar sines: NumPy's
        vectorised ones differ in the last bit between builds.
        """
        steps = self.azimuth_steps
        rows = []
        circles: dict[float, Floats] = {}
        for elevation, offset in zip(self.elevations, self.azimuth_offsets, strict=True):
            if offset not in circles:
                angles = [j * self.azimuth_step + offset for j in steps.tolist()]
                circles[offset] = np.array([(math.cos(a), math.sin(a)) for a in angles])
            horizontal = math.cos(elevation) * circles[offset]
            up = np.full((len(steps), 1), math.sin(elevation))
            rows.append(np.hstack([horizontal, up]))
        return read_only(np.concatenate(rows))

    @cached_property
    def direction_axes(self) -> tuple[Floats, ...]:
        """`directions` as three arrays (B,), one an axis: rotated twice as fast as rows."""
        return tuple(read_only(np.ascontiguousarray(w)) for w in self.directions.T)


def lidar_of(sensor: Sensor) -> Lidar:
    """Return the model of a sensor that is a LiDAR."""
    return cast("Lidar", sensor.model)


def _angles(name: str, key: str, values: ArrayLike, limit_deg: float) -> Floats:
    """Return angles (C,) within +-limit_deg as a file stores them [rad], or raise `InputError`."""
    angles = numbers(values)
    if angles is None:
        raise InputError(name, key, "angles", shown(values))
    angles = np.atleast_1d(angles)
    if angles.ndim != 1 or not len(angles):
        raise InputError(name, key, "at least one angle in a row", f"shape {angles.shape}")
    bad = ~(np.abs(angles) <= math.radians(limit_deg))  # written so that NaN is bad
    if bad.any():
        found = f"{math.degrees(angles[bad][0]):g} (channel {int(np.flatnonzero(bad)[0])})"
        raise InputError(name, key, f"angles within +-{limit_deg:g} degrees", found)
    return all_as_in_file(angles)
