"""The exchange model: sensors and poses as all rig formats can express them."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pe_core.base.arrays import Floats
from pe_core.geometry.poses import Pose
from pe_core.scene.vehicle import Vehicle

from .lens_pictures import KeptPicture, Picture, lost

ORIGIN = Pose((0.0, 0.0, 0.0))
EVEN_RAD = 1e-4  # Channels nearer to even distances than this are even


@dataclass(frozen=True, slots=True, eq=False)
class Emitters:
    """A scan as emitters that fire together at each of `ticks` azimuths of a turn. `azimuths` (E,)
    are relative to those of the ticks, `elevations` (E,) above the horizon [rad]."""

    azimuths: Floats
    elevations: Floats
    ticks: int


@dataclass(frozen=True, slots=True)
class Scan:
    """A LiDAR's scan pattern, in the terms of formats with evenly spaced channels. `low` and `high`
    are the elevations of the outer channels, `fov` is the azimuth range [rad]; ranges are in
    metres. `even` tells whether the channels are evenly spaced; their azimuth offsets are up to
    `offset_rad`. `directions` (B, 3) are the beams of an imported file that lists them; for a LiDAR
    of a rig, `compute_beams` computes them. `ends` are the first and the last azimuth [rad], which
    formats state that divide a scan so (SDF); None where the file has `fov` alone.
    `compute_emitters` returns the scan as emitters; None for a file that has none."""

    channels: int
    low: float
    high: float
    azimuths: int
    fov: tuple[float, float]
    max_range: float
    even: bool = True
    directions: Floats | None = None
    min_range: float = 0.0
    compute_beams: Callable[[], Floats] | None = None
    offset_rad: float = 0.0
    ends: tuple[float, float] | None = None
    compute_emitters: Callable[[], Emitters] | None = None

    @property
    def beams(self) -> Floats | None:
        """(B, 3) directions of the beams, computed on access; None if unknown."""
        return self.directions if self.compute_beams is None else self.compute_beams()

    @property
    def beam_count(self) -> int:
        """Number of beams in one frame."""
        return self.channels * self.azimuths


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """The field of view of a radar or an ultrasonic sensor: lowest and highest angles, ranges.
    `across` are azimuths and `up` elevations [rad]; ranges are in metres."""

    across: tuple[float, float]
    up: tuple[float, float]
    max_range: float
    min_range: float = 0.0


@dataclass(frozen=True, slots=True)
class PortableSensor:
    """A sensor in the exchange model. `name`, `model`: its name, and that of its model, in the
    file. `pose`: axes are those of this project (a camera looks along x); the origin is the
    format's. `kind`: ``"camera"``, ``"lidar"``, another one that the file names, or None if
    unknown. `min_range`, `max_range`: [m]; None if the file has none. `told`: note on how it was
    read. `entry`: its part of the file's document, as the format knows it; None for a sensor that
    is not in the file. An export into the file updates it, unless the sensor `is_unmoved` and its
    model `is_unchanged`. `is_stand_in`: whether the model is a stand-in because the file names
    none. `parameters`: table of its model in a study (JSON), of a kind that has neither picture nor
    scan. `field`: to what a kind reduces in formats without room for its parameters."""

    name: str
    pose: Pose
    kind: str | None = None
    model: str | None = None
    picture: Picture | None = None
    scan: Scan | None = None
    fusion: str | None = None
    min_range: float | None = None
    max_range: float | None = None
    told: str = ""
    entry: Any = None
    is_unmoved: bool = False
    is_unchanged: bool = False
    is_stand_in: bool = False
    parameters: str = ""
    field: FieldOfView | None = None

    @property
    def has_figures(self) -> bool:
        """Whether it has figures of its model."""
        own = self.picture, self.scan, self.field
        return any(figures is not None for figures in own) or bool(self.parameters)

    @property
    def known_model(self) -> str | None:
        """Name of the model; None if it is a stand-in."""
        return None if self.is_stand_in else self.model


PortableRig = tuple[PortableSensor, ...]


@dataclass(frozen=True, slots=True)
class ForeignRig:
    """The content of a file of another program. `sensors`: in the format's frame. `lines`: messages
    on what is not read, or is guessed. `document`: the whole content, which an export into the file
    updates; None if the format has no more than the sensors."""

    sensors: PortableRig
    lines: Sequence[str] = ()
    document: Any = None


@dataclass(frozen=True, slots=True, eq=False)
class SceneFacts:
    """What a format may have besides the rig: the vehicle, in the ground frame, and `metadata`, the
    figures and verdicts of a score as plain data."""

    vehicle: Vehicle | None = None
    metadata: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class MergeTarget:
    """The file that an export goes into. `document`: its content. `gone`: its sensors that the rig
    no longer has. `taken`: names in the file of what is no sensor of the rig."""

    document: Any
    gone: PortableRig = ()
    taken: Sequence[str] = ()


def uneven(sensors: Iterable[PortableSensor], title: str) -> list[str]:
    """Return messages on LiDARs whose channels a format with even channels cannot express."""
    lines = []
    for sensor in sensors:
        if sensor.scan is None:
            continue
        if not sensor.scan.even:
            details = f"the {sensor.scan.channels} of {sensor.model} are not"
            lines.append(f"{sensor.name}: {title} spaces channels evenly; {details}")
        if sensor.scan.offset_rad > EVEN_RAD:
            max_offset = f"{math.degrees(sensor.scan.offset_rad):.3g} deg"
            details = f"those of {sensor.model}, up to {max_offset}, are left out"
            lines.append(f"{sensor.name}: {title} has no azimuth offsets of channels; {details}")
    return lines


def with_pictures(
    sensors: Iterable[PortableSensor], reduce: KeptPicture, title: str
) -> tuple[tuple[PortableSensor, ...], list[str]]:
    """Return sensors with intrinsics reduced to a format, and a message for each loss."""
    reduced = []
    lines = []
    for sensor in sensors:
        if sensor.picture is not None:
            losses = lost(sensor.picture, reduce(sensor.picture))
            lines += [f"{sensor.name}: the {what} of {sensor.model} is left out of {title}"
                      for what in losses]  # fmt: skip
            sensor = replace(sensor, picture=reduce(sensor.picture))
        reduced.append(sensor)
    return tuple(reduced), lines


def merged_lines(notes: Iterable[tuple[str, str]], total: int = 0) -> list[str]:
    """Return one message per text, with its sensors; "all sensors" if it has `total` of them."""
    names: dict[str, list[str]] = {}
    for name, text in notes:
        if text:
            names.setdefault(text, []).append(name)
    total = total if total > 1 else 0
    return [
        f"all sensors: {text}" if len(about) == total else f"{', '.join(about)}: {text}"
        for text, about in names.items()
    ]


def named_apart(names: Sequence[str]) -> list[str]:
    """Return unique names; a number is appended to repeated ones."""
    unique_names: list[str] = []
    for name in names:
        number = 2
        unique = name
        while unique in unique_names:
            unique = f"{name}_{number}"
            number = number + 1
        unique_names.append(unique)
    return unique_names
