"""A radar's intrinsics: the modes of one frame, and what they detect."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import Floats, read_only
from ...base.errors import InputError, shown
from ...base.values import A_NAME, Angle, Number, Whole, all_as_in_file, numbers
from ...scene.rig import Sensor, SensorModel
from ..field_of_view import LIGHT_M_S, MIN_RANGE, SHORTEST_RANGE_M
from ..ray_fan import AngleWindow
from .detection import (
    DBSM,
    Reflectivity,
    cautious_reflectivity,
    ratio_of_db,
    reflectivity_of,
    snr_for,
)

RANGE = Number(SHORTEST_RANGE_M, cap=1e5, unit="m", noun="length")
SCALE = Number(0.0, 1.0)
RESOLUTION = Number(0.001, cap=1e5, unit="m", noun="length")
ANGLE_RESOLUTION = Angle(0.001, 180.0)
PROBABILITY = Number(0.0, 1.0, above=True, below=True)
DETECTION = Number(0.01, 1.0, below=True)
LOSS = Number(0.0, 100.0, unit="dB")
ATTENUATION = Number(0.0, 1e4, unit="dB/km")
BANDWIDTH = Number(0.1, cap=1e6, unit="MHz", noun="bandwidth")
LIST = Whole(1, 1_000_000, "detections")
MAX_AZIMUTH_DEG = 180.0
MAX_ELEVATION_DEG = 89.0


@dataclass(frozen=True, eq=False)
class RadarMode:
    """One scan of a radar's frame, such as the far or the near scan.

    The range for the reference RCS in a direction is the range of its azimuth times the scale of
    its elevation, both interpolated; outside of the azimuths or the elevations the mode measures
    nothing.

    `InputError` when a figure is impossible, angles do not ascend, the ranges cross, or a range
    resolution is below c / 2B.

    `azimuths` (A,): Ascending; positive is left [rad].
    `ranges` (A,): Range for the reference RCS [m].
    `elevations` (E,): Ascending [rad].
    `scales` (E,): 0 to 1.
    `range_resolution`: [m]; not finer than c / 2B, where the bandwidth B is known.
    `azimuth_resolution, elevation_resolution`: [rad]; without a resolution an object is not more
        than one cell deep, wide or high.
    `min_range, max_range`: Nothing is detected nearer or farther [m]. The default of the maximum is
        the largest of the ranges.
    `bandwidth_mhz`: Bandwidth B of the sweep, or the occupied one, which is not narrower [MHz].
    """

    name: str
    azimuths: Floats
    ranges: Floats
    elevations: Floats
    scales: Floats
    range_resolution: float | None = None
    azimuth_resolution: float | None = None
    elevation_resolution: float | None = None
    min_range: float = 0.0
    max_range: float | None = None
    bandwidth_mhz: float | None = None

    def __post_init__(self) -> None:
        name = A_NAME.checked("radar", "mode.name", self.name)
        who = f"mode {name!r}"
        put = object.__setattr__
        azimuths = _angles(who, "azimuth_deg", self.azimuths, MAX_AZIMUTH_DEG)
        elevations = _angles(who, "elevation_deg", self.elevations, MAX_ELEVATION_DEG)
        ranges = _one_each(who, "range_m", self.ranges, len(azimuths), rule=RANGE)
        scales = _one_each(who, "elevation_scale", self.scales, len(elevations), rule=SCALE)
        far = self.max_range
        far = float(ranges.max()) if far is None else RANGE.checked(who, "max_range_m", far)
        near = MIN_RANGE.checked(who, "min_range_m", self.min_range) + 0.0
        if not near < far:
            found = f"{near:g}"
            raise InputError(who, "min_range_m", f"a length below {far:g} m", found)
        checked = {
            "azimuths": azimuths,
            "ranges": ranges,
            "elevations": elevations,
            "scales": scales,
            "min_range": near,
            "max_range": far,
        }
        finest = 0.0
        if self.bandwidth_mhz is not None:
            wide = checked["bandwidth_mhz"] = BANDWIDTH.checked(
                who, "bandwidth_mhz", self.bandwidth_mhz
            )
            finest = LIGHT_M_S / (2.0e6 * wide)  # c / 2B, Skolnik, section 1.2
        if self.range_resolution is not None:
            depth = RESOLUTION.checked(who, "range_resolution_m", self.range_resolution)
            if depth < finest:
                expected = f"a length >= {finest:.4g} m, c / 2B of bandwidth_mhz {wide:g}"
                raise InputError(who, "range_resolution_m", expected, f"{depth:g}")
            checked["range_resolution"] = depth
        for key in ("azimuth_resolution", "elevation_resolution"):
            if (value := getattr(self, key)) is not None:
                checked[key] = ANGLE_RESOLUTION.checked(who, f"{key}_deg", value)
        for key, value in checked.items():
            put(self, key, read_only(value) if isinstance(value, np.ndarray) else value)

    def reach(self, azimuth: Floats, elevation: Floats) -> Floats:
        """Return the range (...,) for the reference RCS in directions [m]; 0 outside the field."""
        across = _interpolated(azimuth, self.azimuths, self.ranges)
        return np.asarray(across * _interpolated(elevation, self.elevations, self.scales))

    def faces(self, azimuth: Floats) -> NDArray[np.bool_]:
        """Whether azimuths (...,) are between those of the mode [rad]."""
        return np.asarray((azimuth >= self.azimuths[0]) & (azimuth <= self.azimuths[-1]))

    def in_range(self, distance: Floats) -> NDArray[np.bool_]:
        """Whether distances (N,) are between the minimum and the maximum range [m]."""
        assert self.max_range is not None
        return np.asarray((distance >= self.min_range) & (distance <= self.max_range))


@dataclass(frozen=True, eq=False)
class Radar(SensorModel):
    """Intrinsics of a radar.

    `InputError` when there is no mode, two have one name, or a figure is impossible.

    `name`: Catalogue name, or the user's own.
    `modes`: The scans of one frame; their detections add.
    `reference_rcs_dbsm`: RCS of the target that the modes' ranges are for [dBsm].
    `detection_probability, false_alarm`: Pd and Pfa of that target at that range.
    `list_length`: The most detections that a frame has.
    `cover_loss_db`: Loss of a cover that is no part of the vehicle's mesh, one way [dB].
    `attenuation_db_km`: Attenuation of the air, one way [dB/km]: 0 in clear air.
    `rcs`: RCS of classes, in place of those of `reflectivity`.
    `is_cautious`: Whether classes have the RCS of `cautious_reflectivity`.
    """

    kind: ClassVar[str] = "radar"
    fuses_early: ClassVar[bool] = True

    name: str
    modes: Sequence[RadarMode]
    reference_rcs_dbsm: float = 10.0
    detection_probability: float = 0.9
    false_alarm: float = 1e-6
    list_length: int | None = None
    cover_loss_db: float = 0.0
    attenuation_db_km: float = 0.0
    rcs: Mapping[str, Reflectivity] = field(default_factory=dict)
    is_cautious: bool = False

    def __post_init__(self) -> None:
        name = A_NAME.checked("radar", "name", self.name)
        put = object.__setattr__
        modes = tuple(self.modes)
        if not modes:
            raise InputError(name, "mode", "at least one mode", "none")
        names = [mode.name for mode in modes]
        if len(set(names)) < len(names):
            raise InputError(name, "mode.name", "a name used once", shown(names))
        put(self, "modes", modes)
        for key, rule in (
            ("reference_rcs_dbsm", DBSM),
            ("detection_probability", DETECTION),
            ("false_alarm", PROBABILITY),
            ("cover_loss_db", LOSS),
            ("attenuation_db_km", ATTENUATION),
        ):
            put(self, key, rule.checked(name, key, getattr(self, key)))
        if self.false_alarm >= self.detection_probability:
            expected = f"a probability below detection_probability, {self.detection_probability:g}"
            raise InputError(name, "false_alarm", expected, f"{self.false_alarm:g}")
        if self.list_length is not None:
            put(self, "list_length", LIST.checked(name, "list_length", self.list_length))
        put(self, "rcs", dict(self.rcs))

    @cached_property
    def cautious(self) -> "Radar":
        """The radar as requirements take it: what most bodies return, not what half of them do."""
        return replace(self, is_cautious=True)

    def reflectivity(self, name: str) -> Reflectivity:
        """Return the RCS of a class of objects."""
        known = cautious_reflectivity if self.is_cautious else reflectivity_of
        return known(name, self.rcs)

    @cached_property
    def anchor(self) -> tuple[float, float]:
        """SNR at the range of a mode, less the losses of the cover both ways; its RCS [m2]."""
        snr = snr_for(self.detection_probability, self.false_alarm)
        snr *= ratio_of_db(-2.0 * self.cover_loss_db)
        return snr, ratio_of_db(self.reference_rcs_dbsm)

    @property
    def min_range(self) -> float:
        """Minimum range of all modes [m]."""
        return min(mode.min_range for mode in self.modes)

    @property
    def max_range(self) -> float:
        """Maximum range of all modes [m]."""
        return max(cast("float", mode.max_range) for mode in self.modes)

    @cached_property
    def window(self) -> AngleWindow:
        """Azimuths and elevations between which any mode measures [rad]."""
        sides = []
        for key in ("azimuths", "elevations"):
            ends = [getattr(mode, key) for mode in self.modes]
            sides.append((min(float(a[0]) for a in ends), max(float(a[-1]) for a in ends)))
        return sides[0], sides[1]

    @cached_property
    def cone(self) -> float:
        """Half the angle of a cone round the axis that contains the field of view [rad]."""
        (left, right), (low, high) = self.window
        across = max(abs(left), abs(right))
        up = max(abs(low), abs(high))
        return across if across >= math.pi / 2.0 else math.acos(math.cos(across) * math.cos(up))


def radar_of(sensor: Sensor) -> Radar:
    """Return the model of a sensor that is a radar."""
    return cast("Radar", sensor.model)


def _interpolated(at: Floats, angles: Floats, values: Floats) -> Floats:
    """Return values between ascending angles, 0 outside of them; equal values need no search."""
    if (values == values[0]).all():
        return np.where((at >= angles[0]) & (at <= angles[-1]), values[0], 0.0)
    return np.asarray(np.interp(at, angles, values, left=0.0, right=0.0))


def _angles(who: str, key: str, values: ArrayLike, limit_deg: float) -> Floats:
    """Return at least two ascending angles within +-limit_deg, as a file stores them [rad]."""
    angles = numbers(values)
    expected = f"two or more ascending angles within +-{limit_deg:g} degrees"
    if angles is None or angles.ndim != 1 or len(angles) < 2:
        raise InputError(who, key, expected, shown(values))
    degrees = np.degrees(angles)
    if not (np.abs(angles) <= math.radians(limit_deg)).all() or not (np.diff(angles) > 0.0).all():
        raise InputError(who, key, expected, shown([round(d, 6) for d in degrees.tolist()]))
    return all_as_in_file(angles)


def _one_each(who: str, key: str, values: ArrayLike, count: int, rule: Number) -> Floats:
    """Return one checked number for each of `count` angles; a single one is repeated."""
    array = numbers(values)
    if array is None or array.ndim > 1 or (array.ndim == 1 and len(array) not in (1, count)):
        raise InputError(who, key, f"a number, or {count}: one an angle", shown(values))
    array = np.broadcast_to(array, (count,)).copy()
    for value in array.tolist():
        rule.checked(who, key, value)
    if not array.any():
        raise InputError(who, key, "a number above 0", shown(array.tolist()))
    return array
