"""A rig on its way between programs: poses in our axes, and what formats can say of intrinsics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds.camera import Camera, Pinhole
from ..kinds.lidar import Lidar
from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor

Floats = NDArray[np.float64]

CAMERA, LIDAR = Camera.kind, Lidar.kind


EVEN_RAD = 1e-4
"""Channels nearer to even distances than this are even."""


@dataclass(frozen=True, slots=True)
class Picture:
    """A camera's picture: focal lengths, principal point and size [px].

    The size is None where a format does not say it; `distortion` names what bends it, if anything
    does: no format here has that.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    size: tuple[int, int] | None = None
    distortion: str = ""

    @property
    def is_plain(self) -> bool:
        """Whether its pixels are square and its principal point is in the middle."""
        width, height = self.size or (0, 0)
        return self.fx == self.fy and (2.0 * self.cx, 2.0 * self.cy) == (width, height)


@dataclass(frozen=True, slots=True)
class Scan:
    """A LiDAR's beams, as formats have them that know channels at even distances.

    Angles in radians, the range in metres. `even` says whether the channels are so; `directions`
    are the beams themselves, where they are known.
    """

    channels: int
    low: float
    high: float
    azimuths: int
    fov: tuple[float, float]
    max_range: float
    even: bool = True
    directions: Floats | None = None

    @property
    def beam_count(self) -> int:
        """Beams of a frame."""
        return self.channels * self.azimuths


@dataclass(frozen=True, slots=True)
class CarriedSensor:
    """A sensor of another program.

    Attributes
    ----------
    name : str
        As the other program has it.
    pose : Pose
        Axes are ours (a camera looks along x); the origin is the format's.
    kind : str or None
        ``"camera"``, ``"lidar"``, or None where nothing tells.
    model : str or None
        What the file calls its model.
    picture : Picture or None
    scan : Scan or None
    fusion : str or None
    """

    name: str
    pose: Pose
    kind: str | None = None
    model: str | None = None
    picture: Picture | None = None
    scan: Scan | None = None
    fusion: str | None = None

    def moved(self, pose: Pose) -> CarriedSensor:
        """Return the same sensor elsewhere."""
        return replace(self, pose=pose)

    def called(self, name: str) -> CarriedSensor:
        """Return the same sensor under another name."""
        return replace(self, name=name)


def carried(rig: Rig) -> tuple[CarriedSensor, ...]:
    """Return the sensors of a rig, in the ground frame."""
    return tuple(_carried(sensor) for sensor in rig)


def cameras(sensors: Iterable[CarriedSensor]) -> list[CarriedSensor]:
    """Return those that are cameras."""
    return [each for each in sensors if each.kind == CAMERA]


def lidars(sensors: Iterable[CarriedSensor]) -> list[CarriedSensor]:
    """Return those that are LiDARs."""
    return [each for each in sensors if each.kind == LIDAR]


def uneven(sensors: Iterable[CarriedSensor], asking: str) -> list[str]:
    """Return a line for each LiDAR whose channels a format cannot say, that knows even ones."""
    lines = []
    for each in sensors:
        if each.scan is not None and not each.scan.even:
            had = f"the {each.scan.channels} of {each.model} are not"
            lines.append(f"{each.name}: {asking} spaces channels evenly; {had}")
    return lines


def bent(sensors: Iterable[CarriedSensor], asking: str) -> list[str]:
    """Return a line for each camera whose distortion is left out."""
    told = "{0}: the distortion ({1}) of {2} is left out of {3}"
    return [
        told.format(s.name, s.picture.distortion, s.model, asking)
        for s in sensors
        if s.picture is not None and s.picture.distortion
    ]


def camera_of(name: str, p: Picture) -> Camera:
    """Return the camera of a picture; one without a size has its principal point in the middle."""
    if p.size is None:
        p = replace(p, size=(round(2.0 * p.cx), round(2.0 * p.cy)))
    width, height = p.size or (0, 0)
    if p.is_plain:
        return Camera(name, width, height, 2.0 * math.atan(width / (2.0 * p.fx)))
    return Camera(name, width, height, lens=Pinhole(p.fx, p.fy, p.cx, p.cy))


def lidar_of(name: str, scan: Scan) -> Lidar:
    """Return the LiDAR of a scan: of its beams where they are known, else of even channels."""
    if scan.directions is not None:
        return Lidar.from_directions(name, scan.directions, scan.max_range)
    elevations = np.linspace(scan.low, scan.high, scan.channels)
    low, high = scan.fov
    share = min((high - low) / (2.0 * math.pi), 1.0)
    steps = max(round(scan.azimuths / share), 1)
    return Lidar(name, elevations, steps, scan.max_range, horizontal_fov=scan.fov)


def _carried(sensor: Sensor) -> CarriedSensor:
    model = sensor.model
    figures: dict[str, Any] = {}
    if isinstance(model, Camera):
        figures["picture"] = _picture(model)
    elif isinstance(model, Lidar):
        figures["scan"] = _scan(model)
    known = (sensor.name, sensor.pose, sensor.kind, model.name)
    return CarriedSensor(*known, fusion=sensor.fusion, **figures)


def _picture(model: Camera) -> Picture:
    lens, size = model.projection, (model.width, model.height)
    return Picture(lens.fx, lens.fy, lens.cx, lens.cy, size, "" if lens.is_straight else lens.model)


def _scan(model: Lidar) -> Scan:
    angles = sorted(model.elevations.tolist())
    step = (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    even = all(abs(b - a - step) < EVEN_RAD for a, b in pairwise(angles))
    figures = (len(angles), angles[0], angles[-1], len(model.azimuth_steps), model.horizontal_fov)
    return Scan(*figures, model.max_range, even, model.directions)


def named_apart(names: Sequence[str]) -> list[str]:
    """Return names of which no two are alike: later ones get a number."""
    found: list[str] = []
    for name in names:
        number, unique = 2, name
        while unique in found:
            unique, number = f"{name}_{number}", number + 1
        found.append(unique)
    return found
