"""Places of a sensor of a rig on its own mount: where else it could be, the others staying.

Poses are those that a search would place: `Parametrization`. A sensor without a mount is moved over
the whole body, upright, at the distance that it has from it now.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError, require_name, shown
from ..geometry.poses import Pose, cross, dot
from ..scene.rig import Rig
from ..scene.vehicle import Vehicle
from .domains import (
    ANY_ANGLE,
    POSITION_AXES,
    BoxDomain,
    MountSurface,
    SurfaceDomain,
    rounded_length,
)
from .limit import FigureLimits
from .mounts import Mounting, SlotMount, SurfaceMount
from .parametrization import Parametrization, surface_of
from .placement import Placement, housings_of
from .places import IN_BODY, SurfacePlace, surface_points
from .search_space import SPAN, Rule, SearchSpace

BODY_MOUNT = "body"
"""Name of the mount that a sensor without one is on."""
FORWARD = {"forward": (1.0, 0.0, 0.0), "back": (-1.0, 0.0, 0.0)}
SIDEWAYS = {"left": (0.0, 1.0, 0.0), "right": (0.0, -1.0, 0.0)}
UPWARD = {"up": (0.0, 0.0, 1.0), "down": (0.0, 0.0, -1.0)}
DIRECTIONS = (FORWARD, SIDEWAYS, UPWARD)
"""Directions of the ground frame, both ways along each axis."""
TRIED = (1, 4, 16)
"""Times as many places are tried as are wanted, until so many are free: bounds forbid most of a
body."""
FREE_SHARE = 0.5
"""Share of the places wanted that is enough."""
EDGE_SHARE = 0.5
"""A step along a surface that comes less far than this share of it has met its edge."""


class PlacedRig(NamedTuple):
    """A place of a sensor, and the rig with the sensor there."""

    place: SurfacePlace
    rig: Rig


class PathPoint(NamedTuple):
    """A point of a path over a surface: how far along it [m], where, and its unit normal."""

    distance: float
    point: tuple[float, float, float]
    normal: tuple[float, float, float]


class OwnPlaces:
    """Places of a sensor on its mount: `at` and `turned` give poses, `reason` what forbids them.

    `InputError` when there is no such sensor, it follows another, it has no mount and there is no
    vehicle, or it is not on its mount.

    Parameters
    ----------
    rig : Rig
    name : str
        The sensor; the others stay, but for those that follow it.
    mounting : Mounting
    limits : FigureLimits
        Those on what can be built, and that the rig keeps now, forbid places.
    bounds : mapping of axis to (low, high)
        Of the sensor's position [m].
    axes : sequence of str, optional
        Axes of the ground frame along which a sensor without a mount moves. By default it moves
        over the whole body.
    anywhere : bool
        Whether a sensor that is not on its mount is moved as if it were, as far from it as it is
        now: one that is being dragged.
    surfaces : dict of SurfaceMount to MountSurface, optional
        Surfaces that are known of this vehicle; new ones are added.

    Attributes
    ----------
    mount : SurfaceMount or SlotMount
    mount_name : str
    surface : MountSurface or None
        None for a list of slots, and along axes.
    followers : tuple of str
        All sensors of the rig that follow another.
    broken : tuple of str
        Rules that the rig breaks as it is: they forbid nothing.
    """

    def __init__(
        self,
        rig: Rig,
        name: str,
        vehicle: Vehicle | None,
        mounting: Mounting,
        *,
        limits: FigureLimits,
        bounds: Mapping[str, tuple[float, float]] | None = None,
        axes: Sequence[str] | None = None,
        anywhere: bool = False,
        surfaces: dict[SurfaceMount, MountSurface] | None = None,
    ) -> None:
        require_name("region", "sensor", name, [sensor.name for sensor in rig])
        _refuse_follower(name, mounting)
        self.rig = rig
        self.name = name
        self.vehicle = vehicle
        surfaces = {} if surfaces is None else surfaces
        is_boxed = axes is not None and mounting.mount_of(name) is None
        if not is_boxed and (anywhere or mounting.mount_of(name) is None):
            mounting = _at_distance_now(rig, name, vehicle, mounting, surfaces=surfaces)
        self.mount_name = mounting.on.get(name, "")
        self.mount = mounting.mount_of(name)
        own = {axis: span for axis, span in (bounds or {}).items() if axis in POSITION_AXES}
        if is_boxed:
            own = {axis: own.get(axis, SPAN) for axis in axes or ()}
        is_slots = isinstance(self.mount, SlotMount)
        following = [link[1] for link in mounting.pairs]
        following += [follower for group in mounting.groups for follower in group[1:]]
        self.followers = tuple(following)
        self._space = SearchSpace(
            {name: {} if is_slots else own | ANY_ANGLE},
            mounting,
            vehicle,
            housings_of(rig),
            fixed=tuple(s.name for s in rig if s.name != name and s.name not in following),
            figure_limits=limits,
        )
        self._parametrization = Parametrization(rig, self._space, surfaces)
        self._start = self._parametrization.start.vector
        now = self._space.placement(rig)
        rules = self._parametrization.rules
        self._rules = tuple(rule for rule in rules if not rule.broken(now))
        self.broken = tuple(self._named(rule) for rule in rules if rule not in self._rules)
        domain = self._domain = self._parametrization.domain_of(name)
        self.surface = domain.surface if isinstance(domain, SurfaceDomain) else None

    @property
    def foot(self) -> PathPoint:
        """Where the sensor is on its surface now; `InputError` for one in a slot."""
        return self._path_point(0.0, np.array(self._start[:3]))

    def covered(self, count: int) -> list[PlacedRig]:
        """Return places all over the mount, the coarse cover first: of a surface at most `count`
        that no rule forbids, and those between that one does; all slots of a list."""
        if self.surface is None:
            assert isinstance(self.mount, SlotMount)
            count = len(self.mount.slots)
            return [self._slot_place((k + 0.5) / count) for k in range(count)]
        found: list[PlacedRig] = []
        for times in TRIED:
            found = self._tried(times * count)
            free = [number for number, each in enumerate(found) if not each.place.reason]
            if len(free) >= FREE_SHARE * count:
                return found if len(free) <= count else found[: free[count]]
        return found

    def _tried(self, count: int) -> list[PlacedRig]:
        assert self.surface is not None
        faces = self.surface.faces
        points, chosen = surface_points(self.surface.triangles[faces], count)
        found = zip(points, faces[chosen].tolist(), strict=True)
        return [self.place(point, face) for point, face in found if self.surface.carries(face)]

    def place(self, point: Floats, face: int) -> PlacedRig:
        """Return the place at a point (3,) of a face of the surface."""
        assert self.surface is not None
        x, y, z = point.tolist()
        nx, ny, nz = self.surface.outward(face).tolist()
        return self._own((x, y, z), (nx, ny, nz), self.at(point))

    def _slot_place(self, share: float) -> PlacedRig:
        rig = self._parametrization.candidate((share,)).rig
        return self._own(rig[self.name].pose.position, (0.0, 0.0, 1.0), rig)

    def _own(
        self, point: tuple[float, float, float], normal: tuple[float, float, float], rig: Rig
    ) -> PlacedRig:
        place = SurfacePlace(point, normal, rig[self.name].pose, self.reason(rig))
        return PlacedRig(place, rig)

    def at(self, point: Sequence[float] | Floats) -> Rig:
        """Return the rig with the sensor at the nearest point of the surface to (3,) [m]."""
        return self._parametrization.candidate((*map(float, point), *self._start[3:])).rig

    def moved(self, offset: Floats) -> Rig:
        """Return the rig with the sensor moved by an offset (3,) [m], and on its surface again; a
        sensor without one keeps its bounds. Slots have no offsets: `InputError`."""
        if self.surface is not None:
            return self.at(np.array(self._start[:3]) + offset)
        if not isinstance(self._domain, BoxDomain):
            raise InputError("region", "mount", "a surface", "a list of slots")
        vector = list(self._start)
        for number, axis in enumerate(self._domain.axes):
            if axis in POSITION_AXES:
                further = vector[number] + float(offset[POSITION_AXES.index(axis)])
                vector[number] = self._domain.variables[number].clipped(further)
        return self._parametrization.candidate(vector).rig

    def tangents(self) -> Floats:
        """Return orthogonal unit directions (K, 3) in which the sensor may move: two in its
        surface, or its axes; none in slots."""
        if self.surface is None:
            axes = self._domain.axes
            return np.eye(3)[[k for k, axis in enumerate(POSITION_AXES) if axis in axes]]
        normal = np.array(self.foot.normal)
        first = np.array(next(iter(self.directions().values())))
        first = first - float(dot(first, normal)) * normal
        first = first / np.sqrt(dot(first, first))
        return np.array([first, cross(normal, first)])

    def turned(self, axis: str, angle: float) -> Rig:
        """Return the rig with the sensor turned by an angle about an axis of its mount's frame:
        "roll", "pitch" or "yaw" [rad]. Slots have no angles: `InputError`."""
        if axis not in self._domain.axes:
            raise InputError("region", "mount", "a surface", "a list of slots")
        vector = list(self._start)
        vector[self._domain.axes.index(axis)] += angle
        return self._parametrization.candidate(vector).rig

    def reason(self, rig: Rig) -> str:
        """Return the first rule that a placement breaks as text; empty where it breaks none."""
        trial = Placement(rig, self.vehicle, self._space.housings)
        return next((self._named(rule) for rule in self._rules if rule.broken(trial)), "")

    def _named(self, rule: Rule) -> str:
        text = rule.text
        for own in (f" for {self.name!r}", f" of {self.name!r}"):
            text = text.removesuffix(own)
        return IN_BODY if text == "the body" else text

    def directions(self) -> dict[str, Floats]:
        """Return the unit directions (3,) by name in which the sensor may move along its surface:
        those of two axes of the ground frame, without the one nearest to the normal."""
        normal = np.abs(self.foot.normal)
        kept = [both for k, both in enumerate(DIRECTIONS) if k != int(normal.argmax())]
        return {name: np.array(way) for both in kept for name, way in both.items()}

    def path(self, direction: Floats, step: float, length: float) -> Iterator[PathPoint]:
        """Yield points of the surface along a direction (3,) from the foot, a `step` apart [m], up
        to `length` or to the surface's edge."""
        assert self.surface is not None
        here = np.array(self._start[:3])
        for number in range(1, int(length / step) + 1):
            there, _ = self.surface.closest(here + step * direction)
            if float(dot(there - here, direction)) < EDGE_SHARE * step * self._slant(direction):
                return
            here = there
            yield self._path_point(number * step, here)

    def _slant(self, direction: Floats) -> float:
        """Return how far a step along a direction comes on the surface at the foot: 1 where it lies
        in it."""
        along = float(dot(np.array(self.foot.normal), direction))
        return max(1.0 - along * along, 0.0)

    def _path_point(self, distance: float, point: Floats) -> PathPoint:
        assert self.surface is not None
        foot, face = self.surface.closest(point)
        x, y, z = foot.tolist()
        nx, ny, nz = self.surface.outward(face).tolist()
        return PathPoint(distance, (x, y, z), (nx, ny, nz))


def _body_below(
    pose: Pose, vehicle: Vehicle, name: str, surfaces: dict[SurfaceMount, MountSurface]
) -> SurfaceMount:
    """Return the whole body as a mount, without parts whose nearest face looks away from a pose:
    faces of such a part are turned inside out, or hidden below others."""
    parts = list(vehicle.part_names)
    position = np.array(pose.position)
    while True:
        mount = SurfaceMount(parts, 0.0, max_slope=math.pi)
        surface = surface_of(name, mount, vehicle, surfaces)
        foot, face = surface.closest(position)
        if len(parts) == 1 or float(dot(position - foot, surface.outward(face))) >= 0.0:
            return mount
        faces = np.flatnonzero(
            (vehicle.triangles == surface.triangles[face]).all(axis=(1, 2))
            & np.isin(vehicle.parts, [vehicle.part_names.index(part) for part in parts])
        )
        parts.remove(vehicle.part_names[int(vehicle.parts[faces[0]])])


def _refuse_follower(name: str, mounting: Mounting) -> None:
    links = [*mounting.pairs, *mounting.groups]
    leader = next((link[0] for link in links if name in link[1:]), None)
    if leader is not None:
        raise InputError("region", "sensor", f"{leader!r}, which it follows", shown(name))


def _at_distance_now(
    rig: Rig,
    name: str,
    vehicle: Vehicle | None,
    mounting: Mounting,
    *,
    surfaces: dict[SurfaceMount, MountSurface],
) -> Mounting:
    """Return the mounting with a sensor as far from its mount as it is now; without a mount it is
    on the whole body."""
    mount = mounting.mount_of(name)
    if isinstance(mount, SlotMount):
        return mounting
    if vehicle is None:
        raise InputError(
            "region", "vehicle", "a vehicle with a surface, or a list of slots", "none"
        )
    own = mounting.on.get(name, "")
    if mount is None:
        own = f"{BODY_MOUNT} of {name}" if BODY_MOUNT in mounting.mounts else BODY_MOUNT
        mount = _body_below(rig[name].pose, vehicle, own, surfaces)
    surface = surface_of(own, mount, vehicle, surfaces)
    housing = housings_of(rig).get(name)
    domain = SurfaceDomain(
        name, mount, surface, rig[name].pose, housing=housing, bounds={}, anywhere=True
    )
    away = domain.base(rig[name].pose) - np.array(domain.start[:3])
    mount = replace(mount, standoff=rounded_length(float(np.sqrt(dot(away, away)))))
    return replace(mounting, mounts={**mounting.mounts, own: mount}, on={**mounting.on, name: own})
