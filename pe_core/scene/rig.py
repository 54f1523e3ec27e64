"""Mounted sensors, and rigs of sensors."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from ..base.errors import InputError, shown
from ..base.values import A_NAME
from ..geometry.poses import Pose
from ..metric.entropy import ApCurve

COLOR = re.compile("#[0-9a-f]{6}")
"""sRGB, two hexadecimal digits for red, green and blue."""


class SensorModel:
    """Intrinsics of a sensor: the base of every kind's model class.

    `kind` is the name of the kind in studies and in the catalogue. With `fuses_early` the sensors
    of the kind share one fusion group by default. With `sees_through_glass` the vehicle's glass
    does not occlude.
    """

    kind: ClassVar[str]
    fuses_early: ClassVar[bool] = False
    sees_through_glass: ClassVar[bool] = False
    name: str


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor on the vehicle: intrinsics, extrinsics and the fusion group it belongs to.

    Parameters
    ----------
    name : str
        Unique in its rig.
    model : SensorModel
        A `Lidar`, a `Camera`, or the model of another kind.
    pose : Pose
    fusion : str, optional
        Measurements inside one group are summed (early fusion, eq. 6). LiDARs share the group
        "lidar" by default; a camera has a group of its own.
    curve : ApCurve, optional
        Eq. 4 of this sensor's detector, in place of its kind's; the same in a fusion group.
    color : str, optional
        Its colour in pictures, such as "#5fb8f7" (sRGB). It changes no score.

    Raises
    ------
    InputError
        When a value has another type, a name is not one line of printable letters, or the colour
        is none.
    """

    name: str
    model: SensorModel
    pose: Pose = field(default_factory=lambda: Pose((0.0, 0.0, 0.0)))
    fusion: str | None = None
    curve: ApCurve | None = None
    color: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("sensor", "name", self.name))
        who = f"sensor {self.name!r}"
        if not isinstance(self.model, SensorModel):
            raise InputError(who, "model", "the model of a sensor", type(self.model).__name__)
        if not isinstance(self.pose, Pose):
            raise InputError(who, "pose", "a Pose", type(self.pose).__name__)
        fusion = None if self.fusion in (None, "") else A_NAME.checked(who, "fusion", self.fusion)
        object.__setattr__(self, "fusion", fusion)
        if not isinstance(self.curve, ApCurve | None):
            raise InputError(who, "curve", "an ApCurve", type(self.curve).__name__)
        if self.color is not None and not (
            isinstance(self.color, str) and COLOR.fullmatch(self.color)
        ):
            raise InputError(who, "color", 'a colour such as "#5fb8f7"', shown(self.color))

    @property
    def kind(self) -> str:
        """Name of the kind: ``"lidar"``, ``"camera"``."""
        return self.model.kind

    @property
    def group(self) -> str:
        """Name of the early-fusion group."""
        alone = f"{self.kind} {self.name}"
        return self.fusion or (self.kind if self.model.fuses_early else alone)

    def measures_as(self, other: Sensor) -> bool:
        """Whether two sensors measure the same: the same model at the same pose."""
        return self.model is other.model and self.pose == other.pose

    def moved(self, pose: Pose) -> Sensor:
        """Return the same sensor at another pose."""
        return replace(self, pose=pose)


@dataclass(frozen=True, eq=False)
class Rig:
    """The sensors mounted on one vehicle.

    Parameters
    ----------
    sensors : sequence of Sensor

    Raises
    ------
    InputError
        When there is no sensor, two share a name, or a fusion group mixes kinds or AP curves.
    """

    sensors: Sequence[Sensor]

    def __post_init__(self) -> None:
        object.__setattr__(self, "sensors", tuple(self.sensors))
        if not self.sensors:
            raise InputError("rig", "sensors", "at least one sensor", "none")
        for sensor in self.sensors:
            if not isinstance(sensor, Sensor):
                raise InputError("rig", "sensors", "sensors", type(sensor).__name__)
        names = Counter(s.name for s in self.sensors)
        if twice := sorted(name for name, count in names.items() if count > 1):
            raise InputError("rig", "sensor name", "a name used once", repr(twice[0]))
        for group, members in self.groups.items():
            if len({s.kind for s in members}) > 1:
                raise InputError("rig", f"fusion group {group!r}", "one kind of sensor", "two")
            if len({s.curve for s in members}) > 1:
                raise InputError("rig", f"fusion group {group!r}", "one AP curve", "two")

    def __iter__(self) -> Iterator[Sensor]:
        return iter(self.sensors)

    def __len__(self) -> int:
        return len(self.sensors)

    def __getitem__(self, name: str) -> Sensor:
        """Return the sensor of that name."""
        for sensor in self.sensors:
            if sensor.name == name:
                return sensor
        raise KeyError(name)

    @property
    def groups(self) -> dict[str, list[Sensor]]:
        """Sensors by early-fusion group, in the rig's order."""
        groups: dict[str, list[Sensor]] = {}
        for sensor in self.sensors:
            groups.setdefault(sensor.group, []).append(sensor)
        return groups

    def with_poses(self, poses: Sequence[Pose]) -> Rig:
        """Return the rig with a new pose for each sensor; unmoved sensors are the same objects."""
        pairs = zip(self.sensors, poses, strict=True)
        return Rig([s if s.pose == pose else s.moved(pose) for s, pose in pairs])
