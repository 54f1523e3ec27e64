"""What the design variables of one sensor mean: a pose in a box, on a surface, or in a slot.

A domain has `variables`, its design variables along `axes`, and `start`, their values at the start.
`placed` maps values to a pose. It also returns the values after rounding, or after projection onto
the surface: the search continues from these. `snap_to_mount` finds a pose on a mount to start from.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.arrays import Flags, Floats, Ints
from ..base.errors import InputError, one_of, shown
from ..geometry.poses import Pose, cross, dot, rotate, rotation_matrix, rpy_from_matrix
from ..geometry.ray_traversal import TriangleTree
from ..scene.rig import POSITION_AXES as POSITION_AXES
from ..scene.rig import Housing, Sensor
from ..scene.vehicle import Vehicle, closest_points, open_shares
from .mounts import UPRIGHT, AnyMount, SlotMount, SurfaceMount

TURNS = ("roll", "pitch", "yaw")
AXES = (*POSITION_AXES, *TURNS)
POSITION_DECIMALS = 5
ANGLE_DECIMALS_DEG = 4
"""Placements are rounded to 0.01 mm and 0.0001 deg, so that a file, or Blender's single precision,
holds exactly the placement that was scored."""
ROUNDING_M = 0.5 * 10.0**-POSITION_DECIMALS
ROUNDING_RAD = math.radians(0.5 * 10.0**-ANGLE_DECIMALS_DEG)
"""Rounding may move a placement at a bound so far beyond it."""
METRE = "m"
RADIAN = "rad"
SHARE = "share"
NEAR_M = 0.02  # A search begins with faces this near: most points are on the surface
SLACK = 1.0 + 1e-9
"""A search within a computed distance must find that distance again, in spite of rounding."""
LEVEL_WITHIN = 1e-9
"""A face at its largest slope may be steeper by rounding [cosine]."""
PROBED_FACES = 8
"""If so many faces have the same open side, all faces are taken to have it."""
Bounds = tuple[float, float]
START_M = 0.003
START_TURN = 0.002
"""A start is on its mount if it is no farther away than a gasket is thick, and turned by at most
0.1 deg [m, rad]."""
ANY_ANGLE = {axis: (-math.tau, math.tau) for axis in ("roll", "pitch", "yaw")}


def pose_values(pose: Pose) -> dict[str, float]:
    """Return a pose by axis: x, y, z [m], roll, pitch, yaw [rad]."""
    return dict(zip(AXES, (*pose.position, *pose.rpy), strict=True))


def pose_from_values(values: Mapping[str, float]) -> Pose:
    """Return the pose with coordinates by axis [m, rad], rounded as placements are."""
    position = [round(values[a], POSITION_DECIMALS) + 0.0 for a in POSITION_AXES]
    degrees = [round(math.degrees(values[a]), ANGLE_DECIMALS_DEG) + 0.0 for a in TURNS]
    return Pose.from_degrees(position, degrees)


def within_turns(angle: float, bounds: Bounds) -> float:
    """Return an angle with the whole turns added that bring it into bounds, or near them [rad]."""
    low, high = bounds
    if low - ROUNDING_RAD <= angle <= high + ROUNDING_RAD:
        return angle
    return angle + math.tau * round(((low + high) / 2.0 - angle) / math.tau)


def start_values(values: Mapping[str, float], bounds: Mapping[str, Bounds]) -> dict[str, float]:
    """Return coordinates by axis, the angles as their bounds count them: modulo a turn."""
    return {
        axis: within_turns(value, bounds[axis]) if axis in bounds and axis in TURNS else value
        for axis, value in values.items()
    }


def rounded_length(length: float) -> float:
    """Return a length, rounded as positions are [m]."""
    return round(length, POSITION_DECIMALS) + 0.0


def rounded(pose: Pose) -> Pose:
    """Return a pose, rounded as placements are."""
    return pose_from_values(pose_values(pose))


@dataclass(frozen=True, slots=True)
class DesignVariable:
    """A number that a search varies, from `low` to `high`; both belong to the range. Its unit is
    "m", "rad" or "share": from 0 to 1, a share selects an element of a list and is cyclic.
    `mirrored` is its factor, 1 or -1, in the mirror image of a pose across y = 0."""

    low: float
    high: float
    unit: str
    mirrored: float = 1.0

    def clipped(self, value: float) -> float:
        """Return a value clipped to the range; a share is taken modulo 1."""
        if self.unit == SHARE:
            return value % 1.0
        return min(max(value, self.low), self.high)


def variable_of(axis: str, bounds: tuple[float, float]) -> DesignVariable:
    """Return the design variable of a coordinate, with its bounds [m or rad]."""
    unit = METRE if axis in POSITION_AXES else RADIAN
    low, high = bounds
    return DesignVariable(low, high, unit, -1.0 if axis in ("y", "roll", "yaw") else 1.0)


class MountSurface:
    """The faces of a mount, which are parts of the vehicle's body or an area of their own. An
    upright sensor has those alone whose open side looks up. Which side of a face is open is found
    when the face is the closest of all for the first time: that takes a millisecond a face.

    `InputError` when there is no vehicle or no such part, the parts or the area have no faces, or
    none for an upright sensor.
    """

    def __init__(self, who: str, mount: SurfaceMount, vehicle: Vehicle | None) -> None:
        self.vehicle, self.triangles = _faces(who, mount, vehicle)
        self._who = who
        self._mount = mount
        self._tree = TriangleTree(self.triangles)
        self._outward: dict[int, Floats] = {}
        # The side of the probed faces if all agree, as in most meshes; else 0.0.
        probed = np.linspace(0, len(self.triangles) - 1, PROBED_FACES).astype(int)
        sides = {self._side_of(face) for face in np.unique(probed).tolist()}
        self._side = sides.pop() if len(sides) == 1 else 0.0
        self._usable, self._decided = self._slopes()
        self._corners = self._usable_corners()
        self.bounds = self._corners.min(axis=0), self._corners.max(axis=0)
        """Lowest and highest corner, each (3,) [m]."""

    @property
    def faces(self) -> Ints:
        """(N,) indices of the faces that may carry a sensor, as far as their side is known."""
        return np.flatnonzero(self._usable)

    def closest(self, point: Floats) -> tuple[Floats, int]:
        """Return the point (3,) of the surface that is closest to a point, and its face."""
        while True:
            foot, face, distance = self._closest_within(point, NEAR_M)
            if distance > NEAR_M:  # no face is so near: one is as near as the nearest corner
                away = self._corners - point
                reach = float(np.sqrt(dot(away, away).min())) * SLACK + 1e-12
                foot, face, _ = self._closest_within(point, reach)
            if self.carries(face):
                return foot, face
            self._corners = self._usable_corners()

    def _closest_within(self, point: Floats, reach: float) -> tuple[Floats, int, float]:
        """Return the closest point (3,) of the faces that may be within reach, its face, and how
        far away it is; inf where there is none [m]. If that is at most the reach, no other face is
        nearer."""
        near = self._tree.near(point, reach)
        near = near[self._usable[near]]
        if not len(near):
            return point, -1, math.inf
        feet = closest_points(point, self.triangles[near])
        square = dot(feet - point, feet - point)
        best = int(np.argmin(square))
        return feet[best], int(near[best]), math.sqrt(float(square[best]))

    def carries(self, face: int) -> bool:
        """Whether a sensor of the mount may be on a face: an upright one on none that is steep,
        looks down or is hidden on both sides."""
        if not self._decided[face]:
            self._decided[face] = True
            self._usable[face] = self._is_open(face) and self.outward(face)[2] >= self._least_up
        return bool(self._usable[face])

    def is_nearer(self, point: Floats, distance: float) -> bool:
        """Whether the mount's parts or area, all faces of them, are nearer to a point (3,) than a
        distance [m]."""
        feet = closest_points(point, self.triangles[self._tree.near(point, distance)])
        return bool((dot(feet - point, feet - point) < distance**2).any())

    def outward(self, face: int) -> Floats:
        """Return the unit normal (3,) of a face on its open side."""
        if face not in self._outward:
            side = self._side or self._side_of(face)
            self._outward[face] = side * self._normal(face)
        return self._outward[face]

    @property
    def _least_up(self) -> float:
        """The least upward part of an outward unit normal; no normal has less than -1."""
        is_upright = self._mount.orientation == UPRIGHT
        return math.cos(self._mount.max_slope if is_upright else math.pi) - LEVEL_WITHIN

    def _slopes(self) -> tuple[Flags, Flags]:
        """Return (F,) which faces may carry a sensor, and (F,) of which that is sure already."""
        edges = self.triangles[:, 1:] - self.triangles[:, :1]
        normals = cross(edges[:, 0], edges[:, 1])
        up = normals[:, 2] / np.sqrt(dot(normals, normals))
        if self._side:
            usable = self._side * up >= self._least_up
            return usable, np.ones(len(up), dtype=bool)
        usable = np.abs(up) >= self._least_up
        return usable, ~usable | (-np.abs(up) >= self._least_up)

    def _usable_corners(self) -> Floats:
        """(N, 3) corners of the faces that may carry a sensor [m]; `InputError` if none may."""
        if not self._usable.any():
            slope = degrees_text(self._mount.max_slope)
            expected = f"faces that look up and slope at most {slope}, for an upright sensor"
            raise InputError(self._who, "max_slope", expected, "steeper ones alone, or hidden ones")
        return np.unique(self.triangles[self._usable].reshape(-1, 3), axis=0)

    def _normal(self, face: int) -> Floats:
        """Return the unit normal (3,) of a face; its corners are counter-clockwise round it."""
        corners = self.triangles[face]
        normal = cross(corners[1] - corners[0], corners[2] - corners[0])
        return normal / np.sqrt(dot(normal, normal))

    def _side_of(self, face: int) -> float:
        """Return 1.0 where a face's open side is that of its normal, else -1.0. A sheet that is as
        open on both sides has the upper one."""
        along, against = self._open_shares(face)
        is_turned = along == against > 0.0 and self._normal(face)[2] < 0.0
        return -1.0 if along < against or is_turned else 1.0

    def _is_open(self, face: int) -> bool:
        """Whether rays leave a face on either side."""
        return max(self._open_shares(face)) > 0.0

    def _open_shares(self, face: int) -> tuple[float, float]:
        """Return which shares of rays miss the body on the side of a face's normal, and on the
        other."""
        middle = self.triangles[face].sum(axis=0) / 3.0
        return open_shares(self.vehicle, middle, self._normal(face))


def _faces(who: str, mount: SurfaceMount, vehicle: Vehicle | None) -> tuple[Vehicle, Floats]:
    """Return the vehicle and the mount's triangles that have an area."""
    if mount.area is not None:
        if vehicle is None:
            raise InputError(who, "area", "a vehicle that it is an area of", "none")
        return vehicle, _with_area(who, "area", mount.area.triangles, "the area")
    names = () if vehicle is None else vehicle.part_names
    for part in mount.parts:
        if vehicle is None or part not in names:
            expected = one_of(names, part) if names else "a vehicle with such a part"
            raise InputError(who, "parts", expected, shown(part))
    assert vehicle is not None  # a mount has at least one part
    chosen = np.isin(vehicle.parts, [names.index(part) for part in mount.parts])
    return vehicle, _with_area(who, "parts", vehicle.triangles[chosen], ", ".join(mount.parts))


def _with_area(who: str, field: str, triangles: Floats, named: str) -> Floats:
    """Return the triangles that have an area; raise `InputError` if there is none."""
    normals = cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    proper = triangles[dot(normals, normals) > 0.0]
    if not len(proper):
        expected = "parts with faces" if field == "parts" else "faces"
        raise InputError(who, field, expected, f"none in {named}")
    return proper


class BoxDomain:
    """Free coordinates of a sensor, each in its bounds."""

    def __init__(self, pose: Pose, bounds: Mapping[str, Bounds]) -> None:
        values = start_values(pose_values(pose), bounds)
        self._pose = pose
        self.axes = tuple(axis for axis in AXES if axis in bounds)
        self.variables = tuple(variable_of(axis, bounds[axis]) for axis in self.axes)
        self.start = tuple(values[axis] for axis in self.axes)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at these coordinates, rounded."""
        if not self.axes:
            return self._pose, ()
        moved = pose_values(self._pose) | dict(zip(self.axes, values, strict=True))
        pose = pose_from_values(moved)
        rounded_values = pose_values(pose)
        return pose, tuple(rounded_values[axis] for axis in self.axes)


class SlotDomain:
    """One of a list of poses; its variable is a share from 0 to 1 of the list."""

    axes = ("slot",)
    variables = (DesignVariable(0.0, 1.0, SHARE),)

    def __init__(self, who: str, mount: SlotMount, pose: Pose) -> None:
        self._slots = mount.slots
        taken = [k for k, slot in enumerate(self._slots) if is_same_pose(slot.pose, pose)]
        if not taken:
            expected = f"a start in a slot: {', '.join(slot.name for slot in self._slots)}"
            raise InputError(who, "position", expected, pose_text(pose))
        self.start = ((taken[0] + 0.5) / len(self._slots),)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose of the slot at a share, and the middle of the slot's shares."""
        count = len(self._slots)
        number = min(int(values[0] * count), count - 1)
        return rounded(self._slots[number].pose), ((number + 0.5) / count,)


class SurfaceDomain:
    """A point of a surface, and the free angles of the sensor.

    The first three variables are a point near the surface [m]; the sensor is mounted at the closest
    point of the surface. So it moves on surfaces of any shape, and across their parts. Its start is
    checked to be on the surface, unless it may be `anywhere`.
    """

    def __init__(
        self,
        who: str,
        mount: SurfaceMount,
        surface: MountSurface,
        pose: Pose,
        housing: Housing | None,
        bounds: Mapping[str, Bounds],
        anywhere: bool = False,
    ) -> None:
        self.mount = mount
        self.surface = surface
        self._standoff_point = standoff_point(mount, housing)
        self._angle_axes = tuple(axis for axis in TURNS if axis in bounds)
        self.axes = *POSITION_AXES, *self._angle_axes
        sides = zip(*(corner.tolist() for corner in surface.bounds), strict=True)
        variables = [variable_of(axis, side) for axis, side in zip("xyz", sides, strict=True)]
        variables += [variable_of(axis, bounds[axis]) for axis in self._angle_axes]
        self.variables = tuple(variables)
        foot, face = surface.closest(self.base(pose))
        normal = surface.outward(face)
        rpy: Sequence[float] = pose.rpy
        if mount.orientation != UPRIGHT:
            frame = frame_of(mount.orientation, normal)
            rpy = rpy_from_matrix(rotate(frame.T, pose.ground_from_sensor.T).T)
        self._angles = start_values(dict(zip(TURNS, rpy, strict=True)), bounds)
        self.start = (*foot.tolist(), *(self._angles[axis] for axis in self._angle_axes))
        if not anywhere:
            self._check_start(who, pose, bounds, foot, normal=normal)

    def base(self, pose: Pose) -> Floats:
        """Return the point (3,) of a sensor at a pose from which the stand-off is measured [m]."""
        return np.array(pose.position) + rotate(pose.ground_from_sensor, self._standoff_point)

    def placed(self, values: Sequence[float]) -> tuple[Pose, tuple[float, ...]]:
        """Return the pose at the closest point of the surface, and that point."""
        foot, face = self.surface.closest(np.array(values[:3]))
        normal = self.surface.outward(face)
        angles = {**self._angles, **dict(zip(self._angle_axes, values[3:], strict=True))}
        rpy = [angles[axis] for axis in TURNS]
        pose = pose_on(self.mount, foot, normal, rpy, point=self._standoff_point)
        return pose, (*foot.tolist(), *values[3:])

    def _check_start(
        self, who: str, start: Pose, bounds: Mapping[str, Bounds], foot: Floats, normal: Floats
    ) -> None:
        """Raise `InputError` for a start that is not on the surface, with a pose that would be."""
        away = self.base(start) - foot
        off = float(np.sqrt(dot(away, away))) - self.mount.standoff
        below = float(dot(away, normal)) < self.mount.standoff / 2.0 - START_M
        if abs(off) > START_M or below:
            pose, _ = self.placed(self.start)
            expected = f"a start on its mount, such as {pose_text(pose)}"
            raise InputError(who, "position", expected, pose_text(start))
        for axis in self._angle_axes:
            low, high = bounds[axis]
            if not low - START_TURN <= self._angles[axis] <= high + START_TURN:
                expected = f"bounds around the start, {degrees_text(self._angles[axis])}"
                found = f"{degrees_text(low)} to {degrees_text(high)}"
                raise InputError(who, f"bounds of {axis}", expected, found)


Domain = BoxDomain | SlotDomain | SurfaceDomain
"""The poses that one sensor may take, by values of design variables."""


def standoff_point(mount: SurfaceMount, housing: Housing | None) -> Floats:
    """Return the point (3,) of a sensor that a mount's stand-off is measured to, sensor frame [m].
    It is the middle of the base of the housing, or of its back on a mount that is facing; the
    sensor's origin where the housing is unknown."""
    if housing is None:
        return np.zeros(3)
    if mount.orientation == "facing":
        return housing.center - np.array([housing.size[0] / 2.0, 0.0, 0.0])
    return -np.array(housing.optical_center)


def pose_on(
    mount: SurfaceMount, foot: Floats, normal: Floats, rpy: Sequence[float], point: Floats
) -> Pose:
    """Return the pose on a mount at a point (3,) of it with a unit normal (3,), rounded. `rpy` are
    the angles relative to the mount's frame there [rad], `point` is `standoff_point`."""
    rotation = rotate(frame_of(mount.orientation, normal), rotation_matrix(*rpy).T).T
    position = foot + mount.standoff * normal - rotate(rotation, point)
    if mount.orientation != UPRIGHT:
        rpy = rpy_from_matrix(rotation)
    return pose_from_values(dict(zip(AXES, (*position.tolist(), *rpy), strict=True)))


def frame_of(orientation: str, normal: Floats) -> Floats:
    """Return the rotation (3, 3), ground from mount, of a mount where the unit normal is (3,)."""
    x, y, z = normal.tolist()
    if orientation == UPRIGHT:
        return np.eye(3)
    if orientation == "facing":
        return rotation_matrix(0.0, -math.asin(min(max(z, -1.0), 1.0)), math.atan2(y, x))
    if z < -1.0 + 1e-9:
        return rotation_matrix(math.pi, 0.0, 0.0)
    share = 1.0 / (1.0 + z)  # the shortest turn that brings the z axis to the normal
    return np.array(
        [
            [1.0 - share * x * x, -share * x * y, x],
            [-share * x * y, 1.0 - share * y * y, y],
            [-x, -y, z],
        ]
    )


def is_same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are equal within `START_M` and `START_TURN`."""
    away = np.array(a.position) - np.array(b.position)
    turned = np.abs(a.ground_from_sensor - b.ground_from_sensor).max()
    return bool(np.sqrt(dot(away, away)) <= START_M and turned <= START_TURN)


def pose_text(pose: Pose) -> str:
    """Return a pose as text for messages: position [m] and angles [deg]."""
    x, y, z = (round(w, 3) + 0.0 for w in pose.position)
    turn = ", ".join(f"{round(angle, 1) + 0.0:g}" for angle in pose.rotation_deg)
    return f"[{x:g}, {y:g}, {z:g}] turned [{turn}]"


def degrees_text(angle: float) -> str:
    """Return an angle [rad] as text for messages."""
    return f"{round(math.degrees(angle), 3) + 0.0:g} deg"


def snap_to_mount(
    sensor: Sensor, mount: AnyMount, vehicle: Vehicle | None = None, housing: Housing | None = None
) -> Pose:
    """Return the pose on a mount that is nearest to the pose of a sensor, rounded.

    On a surface with orientation "upright" the sensor keeps its angles; with "normal" it is level
    with the surface and keeps its heading; with "facing" it looks along the normal. Of slots, the
    nearest is taken. `vehicle` is the body that the mount is a part of. `InputError` when the mount
    has no faces, or there is no vehicle.
    """
    if isinstance(mount, SlotMount):
        return rounded(mount.nearest(sensor.pose.position).pose)
    who = f"sensor {sensor.name!r}"
    surface = MountSurface(who, mount, vehicle)
    domain = SurfaceDomain(
        who, mount, surface, sensor.pose, housing=housing, bounds=ANY_ANGLE, anywhere=True
    )
    *foot, roll, pitch, yaw = domain.start
    if mount.orientation == "normal":
        roll = pitch = 0.0
    elif mount.orientation == "facing":
        roll = pitch = yaw = 0.0
    return domain.placed((*foot, roll, pitch, yaw))[0]
