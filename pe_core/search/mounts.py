"""What a study says of where sensors may sit: mounts, pairs, groups, constraints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..text.fixed import FixedDict
from ..text.values import A_NAME, ANY, LENGTH, Number, choice, listed, pair
from .areas import MountArea

ORIENTATIONS = ("upright", "normal", "facing")
STANDOFF = Number(0.0, 10.0, unit="m")
DISTANCE = Number(0.0, cap=1e4, unit="m")
Range = tuple[float, float]
NO_MOUNT = "the name of an [[optimize.mount]]"


@dataclass(frozen=True, slots=True)
class SurfaceMount:
    """A mount: named parts of the vehicle's body, or an area of it, on which a sensor moves.

    Parameters
    ----------
    parts : sequence of str
        Names of the parts; none where an area is given.
    standoff : float
        From the surface, along its normal, to the middle of the base of the sensor's housing (of
        one that is facing: of its back); to the sensor's origin where its housing is not known [m].
    orientation : {"upright", "normal", "facing"}
        Whether the sensor's angles are to the ground frame, to one whose z axis is the surface's
        normal (a base plate), or to one whose x axis is (a camera in a bumper).
    area : MountArea, optional
        Faces of their own, in place of parts: what was painted in Blender, or has a material there.
    """

    parts: Sequence[str] = ()
    standoff: float = 0.0
    orientation: str = "upright"
    area: MountArea | None = None

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "mount"
        names = listed(self.parts)
        if not isinstance(self.area, MountArea | None):
            raise InputError(who, "area", "a MountArea", shown(self.area))
        if names is None or bool(names) == (self.area is not None):
            found = shown(self.parts) if self.area is None else "parts and an area"
            raise InputError(who, "parts", "names of the vehicle's parts", found)
        put(self, "parts", tuple(A_NAME.checked(who, "parts", name) for name in names))
        put(self, "standoff", STANDOFF.checked(who, "standoff", self.standoff))
        chosen = choice(who, "orientation", self.orientation, ORIENTATIONS)
        put(self, "orientation", chosen)


@dataclass(frozen=True, slots=True)
class Slot:
    """A named pose on a rack."""

    name: str
    pose: Pose

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("slot", "name", self.name))
        if not isinstance(self.pose, Pose):
            raise InputError("slot", "pose", "a Pose", type(self.pose).__name__)


@dataclass(frozen=True, slots=True)
class SlotMount:
    """A mount: a list of named poses, of which a sensor takes one. No two share a slot."""

    slots: Sequence[Slot]

    def __post_init__(self) -> None:
        slots = listed(self.slots)
        if not slots or not all(isinstance(s, Slot) for s in slots):
            raise InputError("mount", "slot", "at least one slot", shown(self.slots))
        _once("mount", "slot", [slot.name for slot in slots])
        object.__setattr__(self, "slots", tuple(slots))

    def nearest(self, position: Sequence[float]) -> Slot:
        """Return the slot that is nearest to a place (3,) [m]."""
        return min(self.slots, key=lambda slot: math.dist(slot.pose.position, position))


AnyMount = SurfaceMount | SlotMount


@dataclass(frozen=True, slots=True)
class NoGo:
    """A box where no part of a sensor may be; an axis that is not said has no ends [m]."""

    name: str
    x: Range | None = None
    y: Range | None = None
    z: Range | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", A_NAME.checked("no_go", "name", self.name))
        for axis in "xyz":
            if (sides := getattr(self, axis)) is not None:
                who = f"no_go {self.name!r}"
                object.__setattr__(self, axis, pair(who, axis, sides, ANY))
        if self.x is None and self.y is None and self.z is None:
            raise InputError(f"no_go {self.name!r}", "x, y, z", "at least one of them", "none")


@dataclass(frozen=True, slots=True)
class Constraints:
    """What every placement of a search keeps to.

    Parameters
    ----------
    max_height : float, optional
        Greatest height of a sensor's housing above the ground [m].
    max_width : float, optional
        Greatest overall width: no housing is farther than half of it from y = 0 [m].
    min_distance : float
        Least distance between any two sensors' origins [m].
    clear_housings : bool
        Housings are inside neither the body nor another sensor's. It goes without saying for a
        sensor on a surface.
    no_go : sequence of NoGo
    """

    max_height: float | None = None
    max_width: float | None = None
    min_distance: float = 0.0
    clear_housings: bool = False
    no_go: Sequence[NoGo] = ()

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "optimize"
        for name in ("max_height", "max_width"):
            if (value := getattr(self, name)) is not None:
                put(self, name, LENGTH.checked(who, name, value))
        put(self, "min_distance", DISTANCE.checked(who, "min_distance", self.min_distance))
        if not isinstance(self.clear_housings, bool):
            raise InputError(who, "clear_housings", "true or false", shown(self.clear_housings))
        areas = listed(self.no_go)
        if areas is None or not all(isinstance(area, NoGo) for area in areas):
            raise InputError(who, "no_go", "a list of boxes", shown(self.no_go))
        _once(who, "no_go", [area.name for area in areas])
        put(self, "no_go", tuple(areas))


@dataclass(frozen=True, slots=True)
class Mounting:
    """Where a rig's sensors may sit, beside their bounds.

    Parameters
    ----------
    mounts : mapping of name to SurfaceMount or SlotMount
    on : mapping of sensor name to name of its mount
        A sensor that is not named moves in its box of coordinates.
    pairs : sequence of (str, str)
        Two sensors each: the second is the first's mirror image across y = 0.
    groups : sequence of sequence of str
        Sensors that move as one: the first leads, the others keep their pose relative to it.
    constraints : Constraints

    Raises
    ------
    InputError
        When a name or a number is impossible, or a sensor is on no mount that there is.
    """

    mounts: Mapping[str, AnyMount] = field(default_factory=dict)
    on: Mapping[str, str] = field(default_factory=dict)
    pairs: Sequence[Sequence[str]] = ()
    groups: Sequence[Sequence[str]] = ()
    constraints: Constraints = field(default_factory=Constraints)

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "optimize"
        for key in ("mounts", "on"):
            if not isinstance(table := getattr(self, key), Mapping):
                raise InputError(who, key, "a mapping of names", shown(table))
        for name, mount in self.mounts.items():
            A_NAME.checked(who, "mount", name)
            if not isinstance(mount, (SurfaceMount, SlotMount)):
                raise InputError(who, f"mount {name!r}", "a mount", shown(mount))
        for sensor, name in self.on.items():
            if name not in self.mounts:
                known = f"one of {', '.join(self.mounts)}" if self.mounts else NO_MOUNT
                raise InputError(f"sensor {sensor!r}", "mount", known, shown(name))
        put(self, "mounts", FixedDict(self.mounts))
        put(self, "on", FixedDict(self.on))
        put(self, "pairs", _ties("pair", self.pairs, lambda count: count == 2, "two sensors"))
        put(self, "groups", _ties("group", self.groups, lambda count: count > 1, "sensors"))

    def mount_of(self, sensor: str) -> AnyMount | None:
        """Return a sensor's mount; None where it moves in a box of coordinates."""
        name = self.on.get(sensor)
        return None if name is None else self.mounts[name]

    def unbounded(self, sensor: str) -> str:
        """Return why a sensor has no bounds of its own, in words; empty for one that may have."""
        if isinstance(self.mount_of(sensor), SlotMount):
            return "a sensor on a list of slots"
        follows = any(sensor == pair[1] for pair in self.pairs)
        follows |= any(sensor in group[1:] for group in self.groups)
        return "a sensor that follows another" if follows else ""


def _ties(
    field: str, ties: Any, enough: Callable[[int], bool], expected: str
) -> tuple[tuple[str, ...], ...]:
    checked, given = [], listed(ties)
    if given is None:
        raise InputError("optimize", field, "a list of names' lists", shown(ties))
    for tie in given:
        names = listed(tie)
        if names is None or not enough(len(names)):
            raise InputError("optimize", field, f"the names of {expected}", shown(tie))
        names = [A_NAME.checked("optimize", field, name) for name in names]
        _once("optimize", field, names)
        checked.append(tuple(names))
    return tuple(checked)


def _once(source: str, field: str, names: Sequence[str]) -> None:
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(source, field, "names used once", repr(twice[0]))
