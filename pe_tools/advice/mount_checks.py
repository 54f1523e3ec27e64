"""Checks of a sensor's mounting position: inside the body, off the body, or occluded by it."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pe_core import catalog
from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.geometry.grids import PerceptionSpace
from pe_core.geometry.poses import Pose, dot
from pe_core.geometry.raycast import Hits
from pe_core.scene.rig import Sensor, cuts_body
from pe_core.scene.vehicle import Vehicle, closest_points, is_enclosed
from pe_core.scoring.score import SensorScore
from pe_core.sensors import coinciding, kind_of
from pe_tools.wording import metres

from .advice import Advice
from .vehicle_checks import OFF_AXIS_M, Bodywork

CLEAR_M = 0.5
CLEAR_ABOVE_M = 0.75
"""Greatest distance from the body of a mounted sensor [m]. Above the body it is larger: there are
racks and masts, and a search tries positions up to that height."""
NEAR_M = 0.05  # First radius of the search for the nearest triangle, beyond the bounding box [m]
LOOKS_AT_M = 0.3  # If half of a sensor's rays end nearer than this [m], it looks only at the body
MAX_OCCLUDED_SHARE = 1.0 / 3.0
"""Occluded share from which there is a warning: more than the quarter that a sensor at a corner of
the vehicle loses."""
MAX_RAYS = 4096  # Rays of a sensor that are cast at most
UPSIDE_DOWN = -0.2
"""Vertical component of a sensor's unit upward axis below which its picture is upside down."""
IMAGE_GAP_M = 0.1  # A mirror image may be this much farther from the body than its original [m]


def occluded_shares(
    sensor: Sensor | None, own: SensorScore | None = None, vehicle: Vehicle | None = None
) -> dict[str, float]:
    """Return the share of a sensor's rays that each part of the vehicle blocks, highest first.
    Without `own`, the sensor's part of a score, or where it counts no beams (cameras), an even
    sample of the sensor's rays is cast; without the sensor, only counted beams are used. Shares, 0
    to 1, are by name of the part; parts that block nothing are left out."""
    if own is not None and own.beams:
        return _shares(own.beams, own.occluded_by)
    if sensor is None or vehicle is None:
        return {}
    return _cast_shares(sensor, vehicle, _first_hits(sensor, vehicle))


def _cast_shares(sensor: Sensor, vehicle: Vehicle, hits: Hits) -> dict[str, float]:
    reach = getattr(sensor.model, "max_range", math.inf)
    faces = hits.face[hits.distance < reach]
    counts = np.bincount(np.asarray(vehicle.parts)[faces], minlength=len(vehicle.part_names))
    return _shares(len(hits.face), dict(zip(vehicle.part_names, counts.tolist(), strict=True)))


def _shares(rays: int, by_part: Mapping[str, int]) -> dict[str, float]:
    shares = {name: count / rays for name, count in by_part.items() if count}
    return dict(sorted(shares.items(), key=lambda item: (-item[1], item[0])))


def _first_hits(sensor: Sensor, vehicle: Vehicle) -> Hits:
    """Return the first hits of a sample of a sensor's rays."""
    rays = kind_of(sensor).rays(sensor, MAX_RAYS)
    return vehicle.first_hit(sensor.pose.position, rays, sensor.model.sees_through_glass)


@dataclass(frozen=True)
class SensorAtBody:
    """A sensor on a vehicle's body, with its part of the score (`own`) where there is one."""

    sensor: Sensor
    body: Bodywork
    own: SensorScore | None = None

    @cached_property
    def hits(self) -> Hits:
        """First hits of a sample of the sensor's rays on the body."""
        return _first_hits(self.sensor, self.body.vehicle)

    @cached_property
    def occluded_by(self) -> dict[str, float]:
        """Share of the sensor's rays that each part blocks, highest first."""
        if self.own is not None and self.own.beams:
            return _shares(self.own.beams, self.own.occluded_by)
        return _cast_shares(self.sensor, self.body.vehicle, self.hits)

    @cached_property
    def gap(self) -> float:
        """Distance from the sensor to the nearest point of the body [m]."""
        return distance_to(self.body.itself, np.asarray(self.sensor.pose.position))

    @property
    def above(self) -> bool:
        """Whether the sensor is above the vehicle's bounding box."""
        low, high = self.body.itself.bounds
        x, y, z = self.sensor.pose.position
        return bool(low[0] <= x <= high[0] and low[1] <= y <= high[1] and z > high[2])

    @cached_property
    def inside(self) -> bool:
        """Whether the body encloses the sensor: rays hit it in nearly all directions."""
        position = np.asarray(self.sensor.pose.position)
        return is_enclosed(self.body.itself, position, self.sensor.model.sees_through_glass)


def odd_mounting(mounted: SensorAtBody) -> Iterator[Advice]:
    """Yield warnings about how a sensor is mounted on the vehicle."""
    sensor = mounted.sensor
    body = mounted.body.vehicle
    covers = {} if body is None else kind_of(sensor).covers_met(sensor, body)
    for part, (db, share) in covers.items():
        yield Advice(sensor.name, "cover", {"db": db, "share": share}, part)
    if covers:  # behind a cover a sensor is meant to be inside
        return
    if mounted.inside:
        yield Advice(sensor.name, "inside")
        return
    housing = catalog.housing(sensor.model.name)
    parts = () if housing is None else cuts_body(sensor.pose, housing, mounted.body.itself)
    if housing is not None and parts:
        values = {"size": list(housing.size), "parts": list(parts)}
        yield Advice(sensor.name, "housing", values, parts[0])
    if mounted.gap > (CLEAR_ABOVE_M if mounted.above else CLEAR_M):
        yield Advice(sensor.name, "clear", {"gap": mounted.gap})
    if not mounted.occluded_by:
        return
    part, part_share = next(iter(mounted.occluded_by.items()))
    median = float(np.median(mounted.hits.distance)) if len(mounted.hits.face) else math.inf
    share = sum(mounted.occluded_by.values())
    if median <= LOOKS_AT_M:
        yield Advice(sensor.name, "looks_at", {"distance": median}, part)
    elif share >= MAX_OCCLUDED_SHARE:
        unit = kind_of(sensor).unit
        values = {"share": share, "part_share": part_share, "unit": unit}
        yield Advice(sensor.name, "occluded", values, part)


def odd_place(sensor: Sensor, space: PerceptionSpace) -> Iterator[Advice]:
    """Yield warnings about a sensor's pose that do not depend on the vehicle."""
    x, y, z = sensor.pose.position
    if z < 0.0:
        yield Advice(sensor.name, "underground", {"depth": -z})
    bounds = (space.x, space.y, (min(0.0, space.z[0]), space.z[1]))
    outside = (not low <= w <= high for w, (low, high) in zip((x, y, z), bounds, strict=True))
    if z >= 0.0 and any(outside):
        yield Advice(sensor.name, "outside", {"x": x, "y": y, "z": z})
    up = float(sensor.pose.ground_from_sensor[2, 2])
    kind = kind_of(sensor)
    if kind.has_top and up < UPSIDE_DOWN:
        values = {"kind": kind.label.lower()}
        yield Advice(sensor.name, "upside_down", values, fix="roll_sensor", amount=(180.0,))


def odd_together(sensors: Sequence[Sensor]) -> Iterator[Advice]:
    """Yield a warning for each group of sensors of one kind that are at one place."""
    for first, *others in coinciding(sensors):
        values = {"others": tuple(sensor.name for sensor in others)}
        yield Advice(first.name, "coincides", values)


def distance_to(vehicle: Vehicle, point: Floats) -> float:
    """Return the distance from a point (3,) to the nearest triangle of a vehicle [m]."""
    gap = nearest_point(vehicle, point) - point
    return float(np.sqrt(dot(gap, gap)))


def nearest_point(vehicle: Vehicle, point: Floats) -> Floats:
    """Return the point (3,) of a vehicle's surface that is nearest to a point (3,) [m]."""
    low, high = vehicle.bounds
    gap = np.maximum(np.maximum(low - point, point - high), 0.0)
    radius = NEAR_M + float(np.sqrt(dot(gap, gap)))
    while True:
        near = vehicle.triangles[vehicle.faces_near(point, radius)]
        if len(near):
            points = closest_points(point, near)
            square = dot(points - point, points - point)
            nearest = int(np.argmin(square))
            if np.sqrt(square[nearest]) <= radius:
                return points[nearest]
        radius *= 2.0


def check_mirror_image(vehicle: Vehicle, sensor: Sensor, image: Pose) -> None:
    """Check that a sensor's mirror image is on the vehicle where the sensor is. A vehicle that is
    not centred, or an image in the air beside it, raises `InputError`."""
    field = f"sensor {sensor.name!r}: mirror image"
    body = Bodywork(vehicle)
    off_m = body.shape.middle[1]
    if abs(off_m) > OFF_AXIS_M:
        expected = "a vehicle whose axis is y = 0 (see the warning 'not centred')"
        raise InputError("scene", field, expected, f"its axis at y = {off_m:.2f} m")
    gap, image_gap = (
        distance_to(body.itself, np.asarray(pose.position)) for pose in (sensor.pose, image)
    )
    if image_gap > gap + IMAGE_GAP_M:
        expected = f"one as near to the vehicle as the sensor, {metres(gap)}"
        raise InputError("scene", field, expected, f"one {metres(image_gap)} off it")
