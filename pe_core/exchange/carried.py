"""A rig on its way between programs: poses in our axes, and what formats can say of intrinsics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..kinds.camera import Camera, Lens
from ..kinds.camera.lens.field import fold_angle
from ..kinds.lidar import Lidar
from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor, SensorModel
from .pictures import ALIKE_PX, KeptPicture, Picture, Size, lost

Floats = NDArray[np.float64]

CAMERA, LIDAR = Camera.kind, Lidar.kind


NO_EXTENT_RAD = 1e-9
"""A scan of less across does not turn."""
OFF_CENTER = 0.06
"""Of a picture's side, how far from the middle the principal point of a usual size may be:
nuScenes' own cameras have it 0.046 below."""
EVEN_RAD = 1e-4
"""Channels nearer to even distances than this are even."""


@dataclass(frozen=True, slots=True)
class Scan:
    """A LiDAR's beams, as formats have them that know channels at even distances.

    Angles in radians, ranges in metres. `even` says whether the channels are so; `directions`
    are the beams of a file that lists them, `model` the LiDAR of a rig that goes out,
    whose channels are off in azimuth by up to `offset_rad`.
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
        """(B, 3) directions of the beams, where they are known; worked out when asked for."""
        return self.directions if self.model is None else self.model.directions

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
        ``"camera"``, ``"lidar"``, another one that the file names, or None where nothing tells.
    model : str or None
        What the file calls its model.
    picture : Picture or None
    scan : Scan or None
    fusion : str or None
    min_range, max_range : float or None
        [m]; None where the file does not say one.
    told : str
        What has to be known of how it was read, if anything.
    entry : str
        What stands in the file, a JSON object in the words of its format; empty where the format
        keeps nothing. On the way back it is written again, with what has changed.
    is_left_out : bool
        Whether it is of a kind that is not known here: on the way back its entry is all of it.
    is_unmoved : bool
        Whether it is where its entry has it.
    is_stand_in : bool
        Whether its model stands in for one that nobody has named.
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
        """The name of its model, unless that only stands in."""
        return None if self.is_stand_in else self.model

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
        if each.scan is None:
            continue
        if not each.scan.even:
            had = f"the {each.scan.channels} of {each.model} are not"
            lines.append(f"{each.name}: {asking} spaces channels evenly; {had}")
        if each.scan.offset_rad > EVEN_RAD:
            most = f"{math.degrees(each.scan.offset_rad):.3g} deg"
            had = f"those of {each.model}, up to {most}, are left out"
            lines.append(f"{each.name}: {asking} has no azimuth offsets of channels; {had}")
    return lines


def with_pictures(
    sensors: Iterable[CarriedSensor], kept: KeptPicture, asking: str
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors with what a format keeps of their pictures, and lines on what it leaves."""
    done, lines = [], []
    for each in sensors:
        if each.picture is not None:
            left = lost(each.picture, kept(each.picture))
            lines += [f"{each.name}: the {what} of {each.model} is left out of {asking}"
                      for what in left]  # fmt: skip
            each = replace(each, picture=kept(each.picture))
        done.append(each)
    return tuple(done), lines


def picture_of(model: object) -> Picture | None:
    """Return a camera's picture; None of what is no camera."""
    if not isinstance(model, Camera):
        return None
    return Picture(model.projection, (model.width, model.height))


def camera_of(name: str, p: Picture, usual: Size | None = None) -> tuple[Camera, str]:
    """Return the camera of a picture, and a line on what was made up of it, or nothing.

    A picture without a size has that which is usual in its format, if the principal point is near
    its middle; else one that has the principal point in the middle. A lens that folds inside the
    picture sees as far as it does not.
    """
    if p.size is not None:
        return _camera(name, p, p.size)
    (width, height), words = _made_up_size(p, usual)
    model, _ = _camera(name, p, (width, height))
    return model, f"{name}: no size in the file; {width} x {height} px {words}"


def _made_up_size(p: Picture, usual: Size | None) -> tuple[Size, str]:
    """Return a size for a picture that has none, and why it is that one."""
    twice = [2.0 * middle for middle in p.center]
    width, height = (round(side) for side in twice)
    is_centred = max(abs(twice[0] - width), abs(twice[1] - height)) < ALIKE_PX
    if usual is None or is_centred:  # nobody calibrates a camera to the half of a pixel
        return (width, height), "has its middle there"
    off = max(abs(side / whole - 1.0) / 2.0 for side, whole in zip(twice, usual, strict=True))
    if off < OFF_CENTER:
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
    cut = _unfolded(p.lens)
    told = f"{name}: its lens folds inside the picture; what is farther than {{:g}} deg from the "
    line = told.format(math.degrees(cut.fov or 0.0) / 2.0) + "axis is left out"
    return Camera(name, *size, lens=cut), line


def _unfolded(lens: Lens) -> Lens:
    """Return a lens that sees as far as it can be inverted, to a tenth of a degree."""
    degrees = math.floor(math.degrees(2.0 * fold_angle(lens)) * 10.0) / 10.0
    return replace(lens, fov=math.radians(max(degrees, 0.1)))


def lidar_of(name: str, scan: Scan) -> Lidar:
    """Return the LiDAR of a scan: of its beams where they are known, else of even channels."""
    ranges = scan.max_range, scan.min_range
    if scan.directions is not None:
        return Lidar.from_directions(name, scan.directions, *ranges)
    elevations = np.linspace(scan.low, scan.high, scan.channels)
    low, high = scan.fov
    if high - low < NO_EXTENT_RAD:  # it does not turn: its channels stand at one azimuth
        level = np.cos(elevations)
        beams = [level * math.cos(low), level * math.sin(low), np.sin(elevations)]
        return Lidar.from_directions(name, np.stack(beams, axis=1), *ranges)
    share = min((high - low) / (2.0 * math.pi), 1.0)
    steps = max(round(scan.azimuths / share), 1)
    fov = scan.fov
    return Lidar(
        name, elevations, steps, scan.max_range, horizontal_fov=fov, min_range=scan.min_range
    )


def with_ranges(model: SensorModel, each: CarriedSensor) -> SensorModel:
    """Return a model with the minimum and maximum range that a file says, where it says them."""
    if not isinstance(model, Camera | Lidar):
        return model
    nearest = model.min_range if each.min_range is None else each.min_range
    farthest = model.max_range if each.max_range is None else each.max_range
    if (nearest, farthest) == (model.min_range, model.max_range):
        return model
    return replace(model, min_range=nearest, max_range=farthest)


def _carried(sensor: Sensor) -> CarriedSensor:
    model = sensor.model
    figures: dict[str, Any] = {}
    if isinstance(model, Camera):
        figures["picture"] = picture_of(model)
    elif isinstance(model, Lidar):
        figures["scan"] = _scan(model)
    for key, none in (("min_range", 0.0), ("max_range", math.inf)):
        if (value := getattr(model, key, none)) != none:
            figures[key] = value
    known = (sensor.name, sensor.pose, sensor.kind, model.name)
    return CarriedSensor(*known, fusion=sensor.fusion, **figures)


def _scan(model: Lidar) -> Scan:
    angles = sorted(model.elevations.tolist())
    step = (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    even = all(abs(b - a - step) < EVEN_RAD for a, b in pairwise(angles))
    offset = float(np.abs(model.azimuth_offsets).max())
    figures = (len(angles), angles[0], angles[-1], len(model.azimuth_steps), model.horizontal_fov)
    return Scan(*figures, model.max_range, even, None, model.min_range, model, offset)


def merged_lines(told: Iterable[tuple[str, str]], everyone: int = 0) -> list[str]:
    """Return a line for each text, with the names that it is about; of `everyone` with none."""
    names: dict[str, list[str]] = {}
    for name, text in told:
        if text:
            names.setdefault(text, []).append(name)
    everyone = everyone if everyone > 1 else 0
    return [
        f"all sensors: {text}" if len(own) == everyone else f"{', '.join(own)}: {text}"
        for text, own in names.items()
    ]


def named_apart(names: Sequence[str]) -> list[str]:
    """Return names of which no two are alike: later ones get a number."""
    found: list[str] = []
    for name in names:
        number, unique = 2, name
        while unique in found:
            unique, number = f"{name}_{number}", number + 1
        found.append(unique)
    return found
