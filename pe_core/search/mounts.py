"""Where sensors may be mounted, as a study declares it: mounts, pairs, groups, constraints."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from ..base.arrays import Floats, ReadOnlyDict
from ..base.errors import InputError, one_of, require_kind, shown
from ..base.notebook import ShortRepr
from ..base.setting import FLAG, Named, OneOf, Pair, Panel, Part, check_settings, setting
from ..base.values import A_NAME, A_PATH, ANY, Angle, Number, listed
from ..geometry.poses import Pose
from ..scene.vehicle import Vehicle

UPRIGHT = "upright"
ORIENTATIONS = (UPRIGHT, "normal", "facing")
SLOPE = Angle(0.0, 180.0)
STANDOFF = Number(0.0, 10.0, unit="m")
SIDES = Pair(ANY)
NO_MOUNT = "the name of an [[optimize.mount]]"


@dataclass(frozen=True, slots=True, eq=False)
class MountArea(ShortRepr):
    """Faces on which a sensor moves, independent of the parts of the body.

    `InputError` when the triangles are not (F, 3, 3), none of them has an area, or a coordinate is
    not finite.

    Parameters
    ----------
    triangles : (F, 3, 3) float
        Corners in the ground frame [m].
    file : str, optional
        The mesh file of the faces, as a study names it.
    parts : sequence of str
        The parts of that file; none: all of it.
    """

    triangles: Floats = field(repr=False)
    file: str | None = None
    parts: Sequence[str] = ()

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "mount"
        try:
            put(self, "triangles", Vehicle(self.triangles).triangles)  # checked as a body's are
        except InputError as error:
            raise InputError(who, "area", error.expected, error.found) from None
        if self.file is not None:
            put(self, "file", A_PATH.checked(who, "area", self.file))
        if (names := listed(self.parts)) is None:
            raise InputError(who, "parts", "names of the area's parts", shown(self.parts))
        put(self, "parts", tuple(A_NAME.checked(who, "parts", name) for name in names))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MountArea):
            return NotImplemented
        same = (self.file, self.parts) == (other.file, other.parts)
        return same and np.array_equal(self.triangles, other.triangles)

    def __hash__(self) -> int:
        return hash((self.file, self.parts, len(self.triangles)))


@dataclass(frozen=True, slots=True)
class SurfaceMount:
    """A mount: named parts of the vehicle's body, or an area of it, on which a sensor moves.

    Parameters
    ----------
    parts : sequence of str
        Names of the parts; empty if an area is given.
    standoff : float
        Distance along the normal from the surface to the middle of the base of the sensor's housing
        (with orientation "facing": of its back), or to the sensor's origin if its housing is not
        known [m].
    orientation : {"upright", "normal", "facing"}
        Whether the sensor's angles are relative to the ground frame, to a frame whose z axis is the
        surface's normal (a base plate), or to one whose x axis is (a camera in a bumper).
    area : MountArea, optional
        Faces in place of parts: painted in Blender, or with a certain material.
    max_slope : float
        With orientation "upright", faces that are steeper than this, measured from level, are no
        part of the mount: neither the sides of a roof nor its underside carry an upright sensor.
        From 180 degrees on, all faces are [rad].
    """

    parts: Sequence[str] = ()
    standoff: float = setting(
        0.0,
        STANDOFF,
        "From the surface to the middle of the housing's base",
        Panel("standoff", "Stand-off", precision=3),
    )
    orientation: str = setting(
        "upright",
        OneOf(ORIENTATIONS),
        "Reference of the sensor's angles",
        Panel(
            "orientation",
            "Orientation",
            menu=(
                ("Upright", "Angles are to the ground, however the surface slants"),
                ("Follows Normal", "Angles are to a base plate that lies on the surface"),
                ("Looks Out", "Angles are to the surface's normal, as of a camera in a bumper"),
            ),
        ),
    )
    area: MountArea | None = None
    max_slope: float = setting(
        math.radians(60.0),
        SLOPE,
        "Of an upright sensor: steeper faces are no part of the mount; 0 is level, 90 a wall",
        Panel("max_slope", "Max Slope", precision=1),
    )

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "mount"
        names = listed(self.parts)
        if not isinstance(self.area, MountArea | None):
            raise InputError(who, "area", "a MountArea", shown(self.area))
        if names is None or bool(names) == (self.area is not None):
            found = shown(self.parts) if self.area is None else "parts and an area"
            raise InputError(who, "parts", "names of the vehicle's parts", found)
        put(self, "parts", tuple(A_NAME.checked(who, "parts", name) for name in names))
        check_settings(self, who)


@dataclass(frozen=True, slots=True)
class Slot:
    """A named pose on a rack."""

    name: Named
    pose: Annotated[Pose, Part(inline=True)]

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("slot", "name", self.name))
        require_kind("slot", "pose", self.pose, Pose)


@dataclass(frozen=True, slots=True)
class SlotMount:
    """A mount: a list of named poses, of which a sensor takes one. No two sensors share a slot."""

    slots: Annotated[Sequence[Slot], Part(key="slot")]

    def __post_init__(self) -> None:
        slots = listed(self.slots)
        if not slots or not all(isinstance(s, Slot) for s in slots):
            raise InputError("mount", "slot", "at least one slot", shown(self.slots))
        _once("mount", "slot", [slot.name for slot in slots])
        object.__setattr__(self, "slots", tuple(slots))

    def nearest(self, position: Sequence[float]) -> Slot:
        """Return the slot that is nearest to a position (3,) [m]."""
        return min(self.slots, key=lambda slot: math.dist(slot.pose.position, position))


AnyMount = SurfaceMount | SlotMount


def _range_along(axis: str) -> Any:
    return setting(None, SIDES, f"From and to along {axis}")


@dataclass(frozen=True, slots=True)
class NoGo:
    """A box where no part of a sensor may be [m]; an axis without a range is unbounded."""

    name: Named
    x: tuple[float, float] | None = _range_along("x")
    y: tuple[float, float] | None = _range_along("y")
    z: tuple[float, float] | None = _range_along("z")

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("no_go", "name", self.name))
        check_settings(self, f"no_go {self.name!r}")
        if self.x is None and self.y is None and self.z is None:
            raise InputError(f"no_go {self.name!r}", "x, y, z", "at least one of them", "none")


@dataclass(frozen=True, slots=True)
class Constraints:
    """The constraints on every placement of a search besides `Limits`, as its fields say."""

    clear_housings: bool = setting(
        False,
        FLAG,
        "Housings do not reach into the body or into each other. On a surface this always holds",
        Panel("clear_housings", "Clear Housings"),
    )
    no_go: Sequence[NoGo] = ()

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "optimize"
        check_settings(self, who)
        areas = listed(self.no_go)
        if areas is None or not all(isinstance(area, NoGo) for area in areas):
            raise InputError(who, "no_go", "a list of boxes", shown(self.no_go))
        _once(who, "no_go", [area.name for area in areas])
        put(self, "no_go", tuple(areas))


@dataclass(frozen=True, slots=True)
class Mounting(ShortRepr):
    """Where the sensors of a rig may be mounted, besides their bounds.

    `InputError` when a name or a number is impossible, or a sensor is on a mount that does not
    exist.

    Parameters
    ----------
    on : mapping of sensor name to name of its mount
        A sensor that is not named moves within its bounds.
    pairs : sequence of (str, str)
        Two sensors each: the second is the first's mirror image across y = 0.
    groups : sequence of sequence of str
        Sensors that move as one: the first leads, the others keep their pose relative to it.
    """

    mounts: Annotated[Mapping[str, AnyMount], Part(key="mount", by_name=True)] = field(
        default_factory=dict
    )
    on: Annotated[Mapping[str, str], Part(stored=False)] = field(default_factory=dict)
    pairs: Sequence[Sequence[str]] = ()
    groups: Sequence[Sequence[str]] = ()
    constraints: Annotated[Constraints, Part(inline=True)] = field(default_factory=Constraints)

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "optimize"
        for key in ("mounts", "on"):
            if not isinstance(table := getattr(self, key), Mapping):
                raise InputError(who, key, "a mapping of names", shown(table))
        for name, mount in self.mounts.items():
            A_NAME.checked(who, "mount", name)
            if not isinstance(mount, (SurfaceMount, SlotMount)):
                raise InputError(who, f"mount {name!r}", "a mount", shown(mount))
        for sensor, name in self.on.items():
            if name not in self.mounts:
                known = one_of(self.mounts, name) if self.mounts else NO_MOUNT
                raise InputError(f"sensor {sensor!r}", "mount", known, shown(name))
        put(self, "mounts", ReadOnlyDict(self.mounts))
        put(self, "on", ReadOnlyDict(self.on))
        put(self, "pairs", _links("pairs", self.pairs, lambda count: count == 2, "two sensors"))
        put(self, "groups", _links("groups", self.groups, lambda count: count > 1, "sensors"))

    def mount_of(self, sensor: str) -> AnyMount | None:
        """Return a sensor's mount; None if it moves within its bounds."""
        name = self.on.get(sensor)
        return None if name is None else self.mounts[name]

    def unbounded(self, sensor: str) -> str:
        """Return why a sensor has no bounds of its own, as text; empty if it may have some."""
        if isinstance(self.mount_of(sensor), SlotMount):
            return "a sensor on a list of slots"
        is_following = any(sensor == pair[1] for pair in self.pairs)
        is_following |= any(sensor in group[1:] for group in self.groups)
        return "a sensor that follows another" if is_following else ""


def _links(
    field: str, links: Any, is_count: Callable[[int], bool], expected: str
) -> tuple[tuple[str, ...], ...]:
    checked = []
    given = listed(links)
    if given is None:
        raise InputError("optimize", field, "a list of names' lists", shown(links))
    for link in given:
        names = listed(link)
        if names is None or not is_count(len(names)):
            raise InputError("optimize", field, f"the names of {expected}", shown(link))
        names = [A_NAME.checked("optimize", field, name) for name in names]
        _once("optimize", field, names)
        checked.append(tuple(names))
    return tuple(checked)


def _once(source: str, field: str, names: Sequence[str]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(source, field, "names used once", repr(twice[0]))
