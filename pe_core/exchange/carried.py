"""A rig on its way between programs: poses in our axes, and what formats can say of intrinsics."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ..kinds.camera import Camera
from ..kinds.lidar import Lidar
from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor, SensorModel

CAMERA, LIDAR = Camera.kind, Lidar.kind


@dataclass(frozen=True, slots=True)
class Picture:
    """A camera's picture: focal lengths, principal point and size [px].

    The size is None where a format does not say it.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    size: tuple[int, int] | None = None


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
    sensor_model : SensorModel or None
        The model itself, for writers.
    fusion : str or None
    """

    name: str
    pose: Pose
    kind: str | None = None
    model: str | None = None
    picture: Picture | None = None
    sensor_model: SensorModel | None = None
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


def beam_fan(model: SensorModel) -> tuple[int, float, float, bool] | None:
    """Return channels, lowest and highest elevation [rad] of a LiDAR, and whether they are even."""
    if not isinstance(model, Lidar):
        return None
    angles = sorted(model.elevations.tolist())
    step = (angles[-1] - angles[0]) / max(len(angles) - 1, 1)
    gaps = (abs(b - a - step) for a, b in pairwise(angles))
    return len(angles), angles[0], angles[-1], all(gap < 1e-4 for gap in gaps)


def uneven(sensors: Iterable[CarriedSensor], asking: str) -> list[str]:
    """Return a line for each LiDAR whose channels a format cannot say, that knows even ones."""
    lines = []
    for each in lidars(sensors):
        fan = beam_fan(each.sensor_model) if each.sensor_model is not None else None
        if fan is not None and not fan[3]:
            lines.append(
                f"{each.name}: {asking} spaces channels evenly; the {fan[0]} of "
                f"{each.model} are not"
            )
    return lines


def _carried(sensor: Sensor) -> CarriedSensor:
    model = sensor.model
    picture = None
    if isinstance(model, Camera):
        focal = model.focal_px
        size = (model.width, model.height)
        picture = Picture(focal, focal, model.width / 2.0, model.height / 2.0, size)
    return CarriedSensor(
        *(sensor.name, sensor.pose, sensor.kind, model.name, picture, model, sensor.fusion)
    )


def named_apart(names: Sequence[str]) -> list[str]:
    """Return names of which no two are alike: later ones get a number."""
    found: list[str] = []
    for name in names:
        number, unique = 2, name
        while unique in found:
            unique, number = f"{name}_{number}", number + 1
        found.append(unique)
    return found
