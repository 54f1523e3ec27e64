"""The roof of a vehicle: the mount on it, and a pose on that mount for a new study's sensor."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.geometry.grids import PerceptionSpace
from pe_core.scene import Housing, Pose, Rig, Sensor, Vehicle, cuts_body
from pe_core.scene.mesh import BodyShape
from pe_core.scene.vehicle_description import is_called
from pe_core.search import MountArea, Mounting, SurfaceMount, snap_to_mount
from pe_core.study import Search, Study

MOUNT = "roof"
ROOF = ("roof",)
NO_ROOF = ("rack", "rail", "bar", "box", "light", "sign", "hatch", "lin", "head", "pod", "antenna")
"""Beginnings of words in the names of parts: roofs, and parts on or under a roof that are none."""
COLUMNS = 100
STEP_M = 0.05
"""Columns of the height map along the vehicle, at least; the greatest side of one [m]."""
ROOF_PERCENTILE = 90.0
LEVEL_SHARE = 0.06
"""The roof's level is that of the highest tenth of the plan view; the roof is within this share of
the vehicle's height of it."""
NEAR_SHARE = 0.1  # Radius of the middle of the roof, as a share of the vehicle's length
SAME_HEIGHT_M = 0.01  # Places of the roof count as equally high within this
MAX_PLACES = 40
STANDOFFS_M = (0.04, 0.1, 0.2)
"""Heights of the bracket under a housing: a base plate of 40 mm, or more where that is needed."""
STEEP = 0.5
"""Minimum vertical part of the unit normal of a roof's triangle: up to 60 degrees from level."""


@dataclass(frozen=True)
class Roof:
    """Where the roof of a vehicle is: points (N, 3) of it [m], the best place for a sensor first.
    `level` is its height above the ground, `tolerance` its greatest distance from that, `front` the
    x of the foremost point [m]."""

    places: Floats
    level: float
    tolerance: float
    front: float


@dataclass(frozen=True)
class RoofSensor:
    """A sensor on the roof; `mount` is None where no surface of the roof has room for it."""

    sensor: Sensor
    mount: SurfaceMount | None

    def search(self) -> Search:
        """Return the search that moves the sensor on its mount, or near its pose."""
        name = self.sensor.name
        if self.mount is None:
            return Search(free={name: ("x", "y", "pitch")})
        mounting = Mounting({MOUNT: self.mount}, {name: MOUNT})
        return Search(free={name: ("pitch",)}, mounting=mounting)


def find_roof(vehicle: Vehicle) -> Roof:
    """Return the roof of a vehicle in the ground frame; a floor in its mesh does not count."""
    shape = BodyShape(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))
    body = vehicle if shape.is_ours is None else Vehicle(vehicle.triangles[shape.is_ours])
    low, high = shape.bounds
    space = _columns(low, high)
    tops = body.top(space)
    column = np.argwhere(np.isfinite(tops))
    if not len(column):  # a body that has no extent seen from above
        middle = (low + high) / 2.0
        return Roof(np.array([[middle[0], middle[1], high[2]]]), float(high[2]), 0.0, high[0])
    tops = tops[column[:, 0], column[:, 1]]
    points = np.stack([space.centers(0)[column[:, 0]], space.centers(1)[column[:, 1]], tops], 1)
    level = float(np.percentile(tops, ROOF_PERCENTILE))
    tolerance = LEVEL_SHARE * float(high[2] - low[2])
    roof = points[np.abs(tops - level) <= tolerance]
    return Roof(_best_first(roof, low, high), level, tolerance, float(roof[:, 0].max()))


def _columns(low: Floats, high: Floats) -> PerceptionSpace:
    """Return columns over a body; one of them is in the middle along each axis."""
    sides = (high - low)[:2]
    step = max(min(STEP_M, float(sides.max()) / COLUMNS), 1e-3)
    ranges = []
    for a, b in zip(low[:2], high[:2], strict=True):
        middle = float(a + b) / 2.0
        half = (2 * math.ceil(float(b - a) / step / 2.0) + 1) * step / 2.0
        ranges.append((middle - half, middle + half))
    x, y = ranges
    return PerceptionSpace(x, y, (0.0, step), step)


def _best_first(roof: Floats, low: Floats, high: Floats) -> Floats:
    """Return points of a roof: the highest near its middle first, then by distance from it."""
    middle = (roof[:, :2].min(axis=0) + roof[:, :2].max(axis=0)) / 2.0
    middle[1] = (low[1] + high[1]) / 2.0
    away = np.hypot(*(roof[:, :2] - middle).T)
    near = away <= NEAR_SHARE * float(high[0] - low[0])
    height = np.where(near, np.round(roof[:, 2] / SAME_HEIGHT_M), -np.inf)
    return roof[np.lexsort((np.round(away, 6), -height))]


def roof_sensor(vehicle: Vehicle, sensor: Sensor, housing: Housing | None, file: str) -> RoofSensor:
    """Return a sensor on the roof of a vehicle: on a named part, else on an area of the mesh. Its
    housing intersects no part of the vehicle. Without such a place it is above the highest point of
    the vehicle, without a mount. The angles of its pose are kept. `file` names the area's file in
    the study."""
    roof = find_roof(vehicle)
    for mount in _mounts(vehicle, roof, file):
        for place in roof.places[:MAX_PLACES]:
            for standoff in STANDOFFS_M:
                found = _placed(
                    vehicle, sensor, housing, replace(mount, standoff=standoff), place=place
                )
                if found is not None:
                    return found
    below = 0.0 if housing is None else housing.optical_center[2]
    x, y, _ = roof.places[0].tolist()
    z = float(vehicle.bounds[1][2]) + STANDOFFS_M[0] + below
    return RoofSensor(_moved(sensor, (x, y, z)), None)


def _placed(
    vehicle: Vehicle, sensor: Sensor, housing: Housing | None, mount: SurfaceMount, place: Floats
) -> RoofSensor | None:
    """Return the sensor on a mount at a place of the roof; None where it has no room there."""
    above = 0.0 if housing is None else housing.optical_center[2]
    wanted = place + np.array([0.0, 0.0, mount.standoff + above])
    try:
        pose = snap_to_mount(_moved(sensor, wanted.tolist()), mount, vehicle, housing)
        found = RoofSensor(_moved(sensor, pose.position), mount)
        pose = found.sensor.pose
        if housing is not None and cuts_body(pose, housing, vehicle):
            return None
        Study(Rig([found.sensor]), vehicle, search=found.search()).coding()
    except InputError:
        return None
    away = np.array(pose.position) - wanted
    return found if float(np.sqrt((away * away).sum())) <= 2.0 * STEP_M else None


def _moved(sensor: Sensor, position: Sequence[float]) -> Sensor:
    """Return a sensor at a position, rounded to millimetres: within what a mount allows."""
    x, y, z = (round(value, 3) for value in position)
    return replace(sensor, pose=Pose.from_degrees((x, y, z), sensor.pose.rotation_deg))


def _mounts(vehicle: Vehicle, roof: Roof, file: str) -> Iterator[SurfaceMount]:
    """Yield mounts on the roof: the parts named as roof, and the faces at the roof's height."""
    tops = vehicle.triangles[:, :, 2].max(axis=1)
    lowest = roof.level - roof.tolerance
    at_level = {vehicle.part_names[k] for k in np.unique(vehicle.parts[tops >= lowest])}
    parts = [n for n in vehicle.part_names if n in at_level and is_called(n, ROOF, NO_ROOF)]
    if parts:
        yield SurfaceMount(parts)
    yield SurfaceMount(area=MountArea(vehicle.triangles[_roof_faces(vehicle, roof)], file))


def _roof_faces(vehicle: Vehicle, roof: Roof) -> NDArray[np.bool_]:
    """(F,) triangles that are level and at the roof's height: with all corners, or else with one.
    Open meshes have no inside, so triangles that face down count, too."""
    triangles = vehicle.triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    is_level = np.abs(normals[:, 2]) > STEEP * np.sqrt((normals * normals).sum(axis=1))
    is_at = np.abs(triangles[:, :, 2] - roof.level) <= max(roof.tolerance, 1e-9)
    for faces in (is_level & is_at.all(axis=1), is_level & is_at.any(axis=1)):
        if faces.any():
            return faces
    return is_at.any(axis=1) | (triangles[:, :, 2].max(axis=1) >= roof.level)
