"""The exchange model: sensors and poses as all rig formats can express them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig, Sensor, SensorModel
from pe_core.sensors.camera import Camera, Lens
from pe_core.sensors.camera.lens import fold_angle
from pe_core.sensors.lidar import Lidar

from .lens_pictures import ALIKE_PX, KeptPicture, Picture, Size, lost

Floats = NDArray[np.float64]

CAMERA, LIDAR = Camera.kind, Lidar.kind


NO_EXTENT_RAD = 1e-9
"""A scan with a smaller horizontal field of view does not rotate [rad]."""
OFF_CENTER = 0.06
"""Of a picture's side, how far from the middle the principal point of a usual size may be:
nuScenes' own cameras have it 0.046 below."""
EVEN_RAD = 1e-4
"""Channels nearer to even distances than this are even."""


@dataclass(frozen=True, slots=True)
class Scan:
    """A LiDAR's scan pattern, in the terms of formats with evenly spaced channels.

    Angles are in radians, ranges in metres. `low` and `high` are the elevations of the outer
    channels, `fov` is the azimuth range. `even` tells whether the channels are evenly spaced.
    `directions` (B, 3) are the beams of an imported file that lists them. `model` is the LiDAR of a
    rig that is exported; its channels have azimuth offsets of up to `offset_rad`.
    """

    channels: int
    low: float
    high: float
    azimuths: int
    fov: tuple[float, float]
    max_range: float
    even: bool = True
    directions: Floats | None = None
    min_range: float = 0.0
    model: Lidar | None = None
    offset_rad: float = 0.0

    @property
    def beams(self) -> Floats | None:
        """(B, 3) directions of the beams, computed on access; None if unknown."""
        return self.directions if self.model is None else self.model.directions

    @property
    def beam_count(self) -> int:
        """Number of beams in one frame."""
        return self.channels * self.azimuths


@dataclass(frozen=True, slots=True)
class PortableSensor:
    """A sensor in the exchange model.

    Attributes
    ----------
    name : str
        Name in the other program.
    pose : Pose
        Axes are those of this project (a camera looks along x); the origin is the format's.
    kind : str or None
        ``"camera"``, ``"lidar"``, another one that the file names, or None if unknown.
    model : str or None
        Name of its model in the file.
    picture : Picture or None
    scan : Scan or None
    fusion : str or None
    min_range, max_range : float or None
        [m]; None if the file has none.
    told : str
        Note on how it was read; may be empty.
    entry : str
        The sensor's entry in the imported file, a JSON object of its format; empty if the format
        keeps none. An export writes it again with the changes.
    is_left_out : bool
        Whether the sensor is of an unknown kind; an export then writes only its entry.
    is_unmoved : bool
        Whether the sensor has the pose of its entry.
    is_stand_in : bool
        Whether the model is a stand-in because the file names none.
    """

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
    entry: str = ""
    is_left_out: bool = False
    is_unmoved: bool = False
    is_stand_in: bool = False

    @property
    def known_model(self) -> str | None:
        """Name of the model; None if it is a stand-in."""
        return None if self.is_stand_in else self.model

    def moved(self, pose: Pose) -> PortableSensor:
        """Return the sensor with another pose."""
        return replace(self, pose=pose)

    def called(self, name: str) -> PortableSensor:
        """Return the sensor with another name."""
        return replace(self, name=name)


def portable_sensors(rig: Rig) -> tuple[PortableSensor, ...]:
    """Return the sensors of a rig, in the ground frame."""
    return tuple(_portable_sensor(sensor) for sensor in rig)


def cameras(sensors: Iterable[PortableSensor]) -> list[PortableSensor]:
    """Return the cameras among the sensors."""
    return [sensor for sensor in sensors if sensor.kind == CAMERA]


def lidars(sensors: Iterable[PortableSensor]) -> list[PortableSensor]:
    """Return the LiDARs among the sensors."""
    return [sensor for sensor in sensors if sensor.kind == LIDAR]


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
    reduced, lines = [], []
    for sensor in sensors:
        if sensor.picture is not None:
            losses = lost(sensor.picture, reduce(sensor.picture))
            lines += [f"{sensor.name}: the {what} of {sensor.model} is left out of {title}"
                      for what in losses]  # fmt: skip
            sensor = replace(sensor, picture=reduce(sensor.picture))
        reduced.append(sensor)
    return tuple(reduced), lines


def picture_of(model: object) -> Picture | None:
    """Return a camera's intrinsics; None for a model that is no camera."""
    if not isinstance(model, Camera):
        return None
    return Picture(model.projection, (model.width, model.height))


def camera_of(name: str, p: Picture, usual: Size | None = None) -> tuple[Camera, str]:
    """Return the camera model of intrinsics, and a message on assumptions (may be empty).

    Intrinsics without an image size get the usual size of the format, if the principal point is
    near its middle, or else the size whose middle is the principal point. If the lens folds inside
    the image, the field of view is limited to the part before the fold.
    """
    if p.size is not None:
        return _camera(name, p, p.size)
    (width, height), reason = _made_up_size(p, usual)
    model, _ = _camera(name, p, (width, height))
    return model, f"{name}: no size in the file; {width} x {height} px {reason}"


def _made_up_size(p: Picture, usual: Size | None) -> tuple[Size, str]:
    """Return an assumed image size [px], and the reason for it."""
    doubled = [2.0 * middle for middle in p.center]
    width, height = (round(side) for side in doubled)
    is_centred = max(abs(doubled[0] - width), abs(doubled[1] - height)) < ALIKE_PX
    if usual is None or is_centred:  # calibrations do not have half pixels by chance
        return (width, height), "has its middle there"
    offset = max(abs(side / whole - 1.0) / 2.0 for side, whole in zip(doubled, usual, strict=True))
    if offset < OFF_CENTER:
        return usual, "is usual there"
    return (width, height), "has its middle there"


def _camera(name: str, p: Picture, size: tuple[int, int]) -> tuple[Camera, str]:
    if replace(p, size=size).is_plain:
        return Camera(name, *size, 2.0 * math.atan(size[0] / (2.0 * p.fx))), ""
    try:
        return Camera(name, *size, lens=p.lens), ""
    except InputError:
        if p.lens.fov is not None:
            raise
    unfolded = _unfolded(p.lens)
    message = (
        f"{name}: its lens folds inside the picture; what is farther than {{:g}} deg from the "
    )
    line = message.format(math.degrees(unfolded.fov or 0.0) / 2.0) + "axis is left out"
    return Camera(name, *size, lens=unfolded), line


def _unfolded(lens: Lens) -> Lens:
    """Return the lens limited to the field of view where it is invertible, to 0.1 degrees."""
    degrees = math.floor(math.degrees(2.0 * fold_angle(lens)) * 10.0) / 10.0
    return replace(lens, fov=math.radians(max(degrees, 0.1)))


def lidar_of(name: str, scan: Scan) -> Lidar:
    """Return the LiDAR model of a scan, from its listed beams or else with even channels."""
    ranges = scan.max_range, scan.min_range
    if scan.directions is not None:
        return Lidar.from_directions(name, scan.directions, *ranges)
    elevations = np.linspace(scan.low, scan.high, scan.channels)
    low, high = scan.fov
    if high - low < NO_EXTENT_RAD:  # it does not rotate: all of its channels have one azimuth
        level = np.cos(elevations)
        beams = [level * math.cos(low), level * math.sin(low), np.sin(elevations)]
        return Lidar.from_directions(name, np.stack(beams, axis=1), *ranges)
    share = min((high - low) / (2.0 * math.pi), 1.0)
    steps = max(round(scan.azimuths / share), 1)
    fov = scan.fov
    return Lidar(
        name, elevations, steps, scan.max_range, horizontal_fov=fov, min_range=scan.min_range
    )


def with_ranges(model: SensorModel, sensor: PortableSensor) -> SensorModel:
    """Return a model with the minimum and maximum range of the file, if it states them."""
    if not isinstance(model, Camera | Lidar):
        return model
    nearest = model.min_range if sensor.min_range is None else sensor.min_range
    farthest = model.max_range if sensor.max_range is None else sensor.max_range
    if (nearest, farthest) == (model.min_range, model.max_range):
        return model
    return replace(model, min_range=nearest, max_range=farthest)


def _portable_sensor(sensor: Sensor) -> PortableSensor:
    model = sensor.model
    figures: dict[str, Any] = {}
    if isinstance(model, Camera):
        figures["picture"] = picture_of(model)
    elif isinstance(model, Lidar):
        figures["scan"] = _scan(model)
    for key, default in (("min_range", 0.0), ("max_range", math.inf)):
        if (value := getattr(model, key, default)) != default:
            figures[key] = value
    fields = (sensor.name, sensor.pose, sensor.kind, model.name)
    return PortableSensor(*fields, fusion=sensor.fusion, **figures)


def _scan(model: Lidar) -> Scan:
    angles = sorted(model.elevations.tolist())
    step = (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    even = all(abs(b - a - step) < EVEN_RAD for a, b in pairwise(angles))
    offset = float(np.abs(model.azimuth_offsets).max())
    figures = (len(angles), angles[0], angles[-1], len(model.azimuth_steps), model.horizontal_fov)
    return Scan(*figures, model.max_range, even, None, model.min_range, model, offset)


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
        number, unique = 2, name
        while unique in unique_names:
            unique, number = f"{name}_{number}", number + 1
        unique_names.append(unique)
    return unique_names
