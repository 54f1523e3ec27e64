"""Mounted sensors, rigs of sensors, and housings of sensors.

A housing has its size as a data sheet gives it. It is shown, and checked for cuts into the body; it
never changes a score.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, ClassVar

import numpy as np

from ..base.arrays import Floats, ReadOnlyDict
from ..base.errors import InputError, require_kind, shown
from ..base.notebook import ShortRepr, Tabular
from ..base.setting import Named, NotStored, Part
from ..base.values import A_NAME, A_TEXT, LENGTH, Number, choice, listed, vector
from ..geometry.overlap import Hull, meets_box, meets_cylinder, upright_hull
from ..geometry.poses import Pose, dot, rotate
from ..metric.entropy import ApCurve, CurveOf, OwnCurve
from .data_sheet import DataSheet
from .vehicle import Vehicle

COLOR = re.compile("#[0-9a-f]{6}")
"""sRGB, two hexadecimal digits for red, green and blue."""
SHAPES = ("cylinder", "box")
SEAT_M = 0.003
"""An overlap with the body up to this depth is a seat: a gasket, or a roof that is not flat."""
NEAR = Number(-10.0, 10.0, unit="m")
POSITION_AXES = ("x", "y", "z")


class SensorModel(ShortRepr):
    """Intrinsics of a sensor: the base of every kind's model class. `kind` is the name of the kind
    in studies and in the catalogue. With `fuses_early` the sensors of the kind share one fusion
    group by default. With `sees_through_glass` the vehicle's glass does not occlude."""

    kind: ClassVar[str]
    fuses_early: ClassVar[bool] = False
    sees_through_glass: ClassVar[bool] = False
    name: str


@dataclass(frozen=True, eq=False)
class Sensor(ShortRepr):
    """A sensor on the vehicle: intrinsics, extrinsics and the fusion group it belongs to.

    `InputError` when a value has another type, a name is not one line of printable letters, or the
    colour is none.

    Parameters
    ----------
    name : str
        Unique in its rig.
    model : SensorModel
        A `Lidar`, a `Camera`, or the model of another kind.
    fusion : str, optional
        Measurements inside one group are summed (early fusion, eq. 6). LiDARs share the group
        "lidar" by default; a camera has a group of its own.
    curve : ApCurve, optional
        Eq. 4 of this sensor's detector, in place of its kind's; the same in a fusion group.
    color : str, optional
        Its colour in pictures, such as "#5fb8f7" (sRGB). It changes no score.
    sheet : DataSheet
        Figures of its own, in place of the catalogue's.
    measured_from : mapping of str to str
        Edges of the vehicle from which its position is told, by axis: "x", "y" or "z". It changes
        no position.
    """

    name: Named
    model: SensorModel
    pose: Annotated[Pose, Part(inline=True)] = field(default_factory=lambda: Pose((0.0, 0.0, 0.0)))
    fusion: Annotated[str | None, Part(rule=A_NAME)] = None
    curve: Annotated[ApCurve | None, Part(key="ap")] = None
    color: str | None = None
    sheet: Annotated[DataSheet, Part(inline=True)] = field(default_factory=DataSheet)
    measured_from: Annotated[Mapping[str, str], NotStored] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("sensor", "name", self.name))
        who = f"sensor {self.name!r}"
        if not isinstance(self.model, SensorModel):
            raise InputError(who, "model", "the model of a sensor", type(self.model).__name__)
        require_kind(who, "pose", self.pose, Pose)
        fusion = None if self.fusion in (None, "") else A_NAME.checked(who, "fusion", self.fusion)
        object.__setattr__(self, "fusion", fusion)
        if self.curve is not None:
            require_kind(who, "curve", self.curve, ApCurve)
        if self.color is not None and not (
            isinstance(self.color, str) and COLOR.fullmatch(self.color)
        ):
            raise InputError(who, "color", 'a colour such as "#5fb8f7"', shown(self.color))
        object.__setattr__(self, "measured_from", _checked_edges(who, self.measured_from))

    @property
    def kind(self) -> str:
        """Name of the kind: ``"lidar"``, ``"camera"``."""
        return self.model.kind

    @property
    def detector(self) -> CurveOf:
        """What its AP curve is looked up by: its kind, with its own curve where it has one."""
        return self.kind if self.curve is None else OwnCurve(self.kind, self.curve)

    @property
    def group(self) -> str:
        """Name of the early-fusion group."""
        alone = f"{self.kind} {self.name}"
        return self.fusion or (self.kind if self.model.fuses_early else alone)

    def measures_as(self, other: "Sensor") -> bool:
        """Whether two sensors measure the same: the same model at the same pose."""
        return self.model is other.model and self.pose == other.pose

    def moved(self, pose: Pose) -> "Sensor":
        """Return the same sensor at another pose."""
        return replace(self, pose=pose)


def _checked_edges(who: str, names: Any) -> Mapping[str, str]:
    """Return the names of edges by axis, in the order of the axes; `InputError` for others."""
    if not isinstance(names, Mapping):
        raise InputError(who, "measured_from", "a table of axes and edges", shown(names))
    for axis in names:
        choice(who, "measured_from", axis, POSITION_AXES)
    own = {axis: names[axis] for axis in POSITION_AXES if axis in names}
    checked = {k: A_NAME.checked(who, f"measured_from.{k}", v) for k, v in own.items()}
    return ReadOnlyDict(checked)


@dataclass(frozen=True, eq=False)
class Rig(Tabular):
    """The sensors mounted on one vehicle.

    `InputError` when there is no sensor, two share a name, or a fusion group mixes kinds or AP
    curves.
    """

    sensors: Sequence[Sensor]

    def __post_init__(self) -> None:
        sensors = listed(self.sensors)
        if sensors is None:
            raise InputError("rig", "sensors", "a list of sensors", shown(self.sensors))
        object.__setattr__(self, "sensors", tuple(sensors))
        if not self.sensors:
            raise InputError("rig", "sensors", "at least one sensor", "none")
        for sensor in self.sensors:
            require_kind("rig", "sensors", sensor, Sensor)
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

    def _rows(self) -> list[dict[str, Any]]:
        names = ("x [m]", "y [m]", "z [m]", "roll [deg]", "pitch [deg]", "yaw [deg]")
        return [
            {"sensor": s.name, "model": s.model.name, "kind": s.kind}
            | dict(zip(names, (*s.pose.position, *s.pose.rotation_deg), strict=True))
            for s in self.sensors
        ]

    @property
    def groups(self) -> dict[str, list[Sensor]]:
        """Sensors by early-fusion group, in the rig's order."""
        groups: dict[str, list[Sensor]] = {}
        for sensor in self.sensors:
            groups.setdefault(sensor.group, []).append(sensor)
        return groups

    def without_each(self) -> list["Rig"]:
        """Return the rigs without each one of the sensors; this one has at least two."""
        return [Rig([s for s in self if s is not failed]) for failed in self]

    def with_poses(self, poses: Sequence[Pose]) -> "Rig":
        """Return the rig with a new pose for each sensor; unmoved sensors are the same objects."""
        pairs = zip(self.sensors, poses, strict=True)
        return Rig([s if s.pose == pose else s.moved(pose) for s, pose in pairs])


@dataclass(frozen=True, slots=True)
class Housing:
    """A sensor's outer shape, upright in the sensor frame.

    `InputError` when the shape is unknown, or a size is not above 0.

    Parameters
    ----------
    shape : str
        ``"cylinder"``, its axis along z, or ``"box"``.
    size : (3,) float
        Along x, y and z [m]; for a cylinder: diameter, diameter, height.
    optical_center : (3,) float
        Origin of the sensor frame, relative to the middle of the housing's base [m].
    source : str
        Source of the figures, and assumptions.
    """

    shape: str
    size: tuple[float, float, float]
    optical_center: tuple[float, float, float]
    source: str = ""

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "shape", choice("housing", "shape", self.shape, SHAPES))
        put(self, "size", vector("housing", "size", self.size, count=3, rule=LENGTH))
        center = vector("housing", "optical_center", self.optical_center, count=3, rule=NEAR)
        put(self, "optical_center", center)
        if self.source:
            put(self, "source", A_TEXT.checked("housing", "source", self.source))

    @property
    def center(self) -> Floats:
        """(3,) middle of the housing in the sensor frame [m]."""
        return np.array([0.0, 0.0, self.size[2] / 2.0]) - np.array(self.optical_center)


def cuts_body(
    pose: Pose, housing: Housing, vehicle: Vehicle, seat: float = SEAT_M
) -> tuple[str, ...]:
    """Return the parts of the vehicle that intersect a sensor's housing.

    Parameters
    ----------
    pose : Pose
        Pose of the sensor, ground frame.
    seat : float
        Overlap up to this depth, from any side, that is allowed [m].

    Returns
    -------
    tuple of str
        Names of the parts, in the vehicle's order; empty if nothing intersects. A housing that is
        completely inside a closed body intersects no triangle, so this is not detected.
    """
    half = np.array(housing.size) / 2.0 - seat
    if half.min() <= 0.0:
        return ()
    rotation = pose.ground_from_sensor
    middle = np.array(pose.position) + rotate(rotation, housing.center)
    reach = float(np.sqrt(dot(np.array(housing.size), np.array(housing.size)))) / 2.0
    faces = vehicle.faces_near(middle, reach)
    near = rotate(rotation.T, vehicle.triangles[faces] - middle)  # along the housing's axes
    overlapping = ((near.min(axis=1) <= half) & (near.max(axis=1) >= -half)).all(axis=1)
    near = near[overlapping]
    faces = faces[overlapping]
    if not len(faces):
        return ()
    inside = (meets_box if housing.shape == "box" else meets_cylinder)(near, half)
    part_indices = np.unique(np.asarray(vehicle.parts)[faces[inside]])
    return tuple(vehicle.part_names[part] for part in part_indices)


def hull_of(pose: Pose, housing: Housing | None) -> Hull:
    """Return the convex hull of a housing at a pose; without a housing only the position."""
    if housing is None:
        return Hull(np.array(pose.position)[None], np.zeros((0, 3)), np.zeros((0, 3)))
    return upright_hull(housing.shape, pose, housing.center, np.array(housing.size))
