"""The ultrasonic sensor: its model, measurement m, table, and row of the registry.

m is 1 where an echo comes back, else 0.

An object returns an echo if a point on its sides that face the sensor is in the cone and in range,
the ray to it is no farther from the side's normal than the largest incidence, and neither the
vehicle nor, in traffic, another object is before it. Points of a lattice on each side, and the
side's nearest point, are tested. A cube of the space is one point, its centre, at any incidence.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np

from ...base.arrays import Flags, Floats
from ...base.values import A_NAME, Angle, Number, degrees_in_file
from ...geometry.poses import dot
from ...metric.entropy import AP_MIN, ApCurve
from ...scene.objects import Objects
from ...scene.rig import Sensor, SensorModel
from ...scene.vehicle import Vehicle
from ..boxes import NUDGE_M, BoxRays, PlacedBoxes, Rivals, behind_others
from ..field_of_view import NEAREST, SHORTEST_RANGE_M, FieldPicture, checked_ranges
from ..kernels import ObjectView
from ..kind import OUT_OF_RANGE, OUT_OF_VIEW, SIZES, Kind
from ..ray_fan import AngleWindow, RayFan, angles_of, cast_fan, field_picture_of
from ..ray_fan_kernels import FanRules

RANGE = Number(SHORTEST_RANGE_M, cap=1e3, unit="m", noun="length")
CONE = Angle(0.01, 178.0)
INCIDENCE = Angle(0.01, 90.0)
RIGHT_ANGLE = math.pi / 2.0
SIDE_POINTS = 144, 89
"""Points of a side of a box: neighbouring Fibonacci numbers."""
NEAR_M = 1e-6
INCIDENCE_MARGIN = 1e-9
NO_AP = ApCurve(1e-12, AP_MIN)
"""AP 0.001 whatever is measured: adds nothing to an entropy. No AP of a detector on ultrasonic
sensors was found; a study may have its own curve."""
DEGREES = Number(0.0, 180.0, above=True, unit="degrees", noun="angle")


@dataclass(frozen=True, eq=False)
class Ultrasonic(SensorModel):
    """Intrinsics of an ultrasonic sensor.

    `InputError` when an angle or a range is impossible.

    `name`: Catalogue name, or the user's own.
    `max_range`: [m]
    `hfov, vfov`: Angles of the elliptic cone, across and up, from edge to edge [rad].
    `min_range`: Nothing is measured nearer [m].
    `max_incidence`: Largest angle between a ray and the normal of a surface at which an echo comes
        back [rad].
    """

    kind: ClassVar[str] = "ultrasonic"

    name: str
    max_range: float
    hfov: float
    vfov: float
    min_range: float = NEAREST
    max_incidence: float = RIGHT_ANGLE

    def __post_init__(self) -> None:
        name = A_NAME.checked("ultrasonic", "name", self.name)
        put = object.__setattr__
        near, far = checked_ranges(name, self.min_range, self.max_range, RANGE)
        for key, rule in (("hfov", CONE), ("vfov", CONE), ("max_incidence", INCIDENCE)):
            put(self, key, rule.checked(name, key, getattr(self, key)))
        put(self, "min_range", near)
        put(self, "max_range", far)

    @property
    def window(self) -> AngleWindow:
        """Azimuths and elevations between which the cone is [rad]."""
        across = self.hfov / 2.0
        up = self.vfov / 2.0
        return (-across, across), (-up, up)


def ultrasonic_of(sensor: Sensor) -> Ultrasonic:
    """Return the model of a sensor that is an ultrasonic sensor."""
    return cast(Ultrasonic, sensor.model)


def fan_of(sensor: Sensor, vehicle: Vehicle | None) -> RayFan:
    """Return the fan of rays of a sensor; covers stop sound."""
    return cast_fan(sensor, vehicle, False)


def returns_echo(sensor: Sensor, fan: RayFan, offsets: Floats) -> Flags:
    """Whether points (N, 3) from the sensor, ground axes [m], are in the cone, near and free."""
    model = ultrasonic_of(sensor)
    distance = np.maximum(np.sqrt(dot(offsets, offsets)), NEAR_M)
    found = (distance >= model.min_range) & (distance <= model.max_range)
    found &= dot(offsets, sensor.pose.ground_from_sensor[:, 0]) > 0.0
    some = np.flatnonzero(found)
    azimuth, elevation = angles_of(sensor, offsets[some])
    inside = in_cone(model, azimuth, elevation)
    if not fan.is_free:
        bins = fan.bins(azimuth, elevation)
        inside &= fan.distance.reshape(-1)[bins] >= distance[some]
    found[some] = inside
    return np.asarray(found)


def in_cone(model: Ultrasonic, azimuth: Floats, elevation: Floats) -> Flags:
    """Whether directions (N,) are in the elliptic cone."""
    across = azimuth / (model.hfov / 2.0)
    up = elevation / (model.vfov / 2.0)
    return np.asarray(across * across + up * up <= 1.0)


def measure_voxels(sensor: Sensor, centers: Floats, side: float, fan: RayFan) -> Floats:
    """Return m (V,) of cubes of any side with centres (V, 3) [m]: 1 or 0."""
    offsets = centers - (np.asarray(sensor.pose.position) + NUDGE_M)
    return returns_echo(sensor, fan, offsets).astype(float)


def measure_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """Return m (N,) of objects: 1 or 0."""
    return objects_heard(sensor, objects, fan_of(sensor, vehicle), traffic)


def objects_heard(sensor: Sensor, objects: Objects, fan: RayFan, traffic: bool) -> Floats:
    """Return m (N,) of objects by the rays of a fan: only those near the sensor can be heard."""
    model = ultrasonic_of(sensor)
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    gap = np.maximum(np.abs(boxes.offsets) - boxes.halves, 0.0)
    near = np.flatnonzero(dot(gap, gap) <= model.max_range**2)
    m = np.zeros(len(objects))
    if not len(near):
        return m
    own = boxes.take(near)
    sides, _ = own.side_points(SIDE_POINTS)
    high = own.offsets + own.halves
    low = own.offsets - own.halves
    nearest = np.clip(0.0, low, high)
    distance = np.sqrt(dot(nearest, nearest))
    item = np.flatnonzero(distance > NEAR_M)
    ground = own.in_ground(nearest[item], item)
    rays = _joined(sides, BoxRays(item, ground / distance[item, None], distance[item]))
    heard = returns_echo(sensor, fan, rays.directions * rays.distance[:, None])
    heard &= _cosine(own, rays) >= math.cos(model.max_incidence) - INCIDENCE_MARGIN
    if traffic:
        heard &= ~behind_others(boxes, Rivals.of(objects.scenes, near), rays)
    m[near] = np.bincount(rays.item[heard], minlength=len(near)) > 0
    return m


def _cosine(boxes: PlacedBoxes, rays: BoxRays) -> Floats:
    """Return the cosine (R,) of the incidence of rays on the side of the box that they end on."""
    local = np.stack(boxes.along(rays.item, rays.directions), axis=1)
    ends = local * rays.distance[:, None] - boxes.offsets[rays.item]
    beyond = np.abs(np.abs(ends) - boxes.halves[rays.item])
    facing = np.abs(boxes.offsets[rays.item]) > boxes.halves[rays.item]
    on_side = facing & (beyond <= 1e-6 * (1.0 + boxes.halves[rays.item]))
    return np.asarray(np.where(on_side, np.abs(local), 0.0).max(axis=1))


def _joined(one: BoxRays, two: BoxRays) -> BoxRays:
    return BoxRays(
        np.concatenate([one.item, two.item]),
        np.concatenate([one.directions, two.directions]),
        np.concatenate([one.distance, two.distance]),
    )


def cone_of(sensor: Sensor, fan: RayFan) -> Flags:
    """Return which rays (E, A) of a fan are in the cone."""
    elevations, azimuths = fan.angles
    return in_cone(ultrasonic_of(sensor), azimuths[None, :], elevations[:, None])


def reached_by_balls(sensor: Sensor, centers: Floats, balls: Floats) -> Flags:
    """Whether balls (N,) round points (N, 3) [m] may be in range; never too few."""
    offsets = centers - np.asarray(sensor.pose.position)
    reach = ultrasonic_of(sensor).max_range + balls
    return np.asarray(dot(offsets, offsets) <= reach * reach)


def measure_columns(
    sensor: Sensor, columns: Floats, heights: Floats, side: float, fan: RayFan
) -> Floats:
    """Return m (C, Z) of cubes in columns (C, 2) at heights (Z,) [m]: 1 or 0."""
    up = len(heights)
    across = len(columns)
    centers = np.column_stack([np.repeat(columns, up, axis=0), np.tile(heights, across)])
    return measure_voxels(sensor, centers, side, fan).reshape(across, up)


def hears_points(sensor: Sensor, points: Floats, fan: RayFan) -> Flags:
    """Whether points (N, 3) of posts return an echo: sound meets a post level."""
    offsets = points - (np.asarray(sensor.pose.position) + NUDGE_M)
    steepest = min(ultrasonic_of(sensor).max_incidence, np.pi / 2.0 - 1e-9)
    flat = np.sqrt((offsets[:, :2] ** 2).sum(axis=1))
    level = np.abs(offsets[:, 2]) <= np.tan(steepest) * flat
    return returns_echo(sensor, fan, offsets) & level


def measure_view(sensor: Sensor, view: ObjectView, fan: RayFan) -> Floats:
    """Return m (N,) of objects: 1 or 0."""
    return objects_heard(sensor, view.objects, fan, view.traffic)


RULES = FanRules(
    through_covers=False,
    field=cone_of,
    reached=reached_by_balls,
    voxels=measure_voxels,
    columns=measure_columns,
    posts=hears_points,
    objects=measure_view,
)


class _AnyClass(Mapping[str, ApCurve]):
    """`NO_AP` for a class of any name."""

    def __getitem__(self, name: str) -> ApCurve:
        return NO_AP

    def __iter__(self) -> Iterator[str]:
        return iter(SIZES)

    def __len__(self) -> int:
        return len(SIZES)


def read(name: str, table: Mapping[str, Any], folder: Path) -> Ultrasonic:
    """Build an ultrasonic sensor from its table."""
    angles = {
        key: math.radians(DEGREES.checked(name, f"{key}_deg", table.get(f"{key}_deg", default)))
        for key, default in (("hfov", None), ("vfov", None), ("max_incidence", 90.0))
    }
    reach = RANGE.checked(name, "max_range_m", table.get("max_range_m"))
    return Ultrasonic(name, reach, min_range=table.get("min_range_m", NEAREST), **angles)


def write(model: Ultrasonic) -> dict[str, Any]:
    """Return the table of an ultrasonic sensor."""
    table: dict[str, Any] = {
        "hfov_deg": degrees_in_file(model.hfov),
        "vfov_deg": degrees_in_file(model.vfov),
        "max_range_m": model.max_range,
    }
    if model.min_range > NEAREST:
        table["min_range_m"] = model.min_range
    if model.max_incidence < RIGHT_ANGLE:
        table["max_incidence_deg"] = degrees_in_file(model.max_incidence)
    return table


def figures(model: Ultrasonic) -> list[str]:
    """Return the cone and the range, a line each."""
    lines = [
        f"cone            {math.degrees(model.hfov):g} x {math.degrees(model.vfov):g} deg",
        f"range           {model.min_range:g} to {model.max_range:g} m",
    ]
    if model.max_incidence < RIGHT_ANGLE:
        lines.append(f"incidence       up to {math.degrees(model.max_incidence):g} deg")
    return lines


def summary(model: Ultrasonic) -> str:
    """Return the cone and the range in one line."""
    cone = f"{math.degrees(model.hfov):.0f} x {math.degrees(model.vfov):.0f} deg"
    return f"{cone}, {model.max_range:g} m"


def missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return one of: out of range, out of view."""
    offset = np.asarray(center)[None] - np.asarray(sensor.pose.position)
    inside = in_cone(ultrasonic_of(sensor), *angles_of(sensor, offset))[0]
    return OUT_OF_RANGE if inside else OUT_OF_VIEW


def field_picture(sensor: Sensor, vehicle: Vehicle | None) -> FieldPicture:
    """Return where a thin post at the sensor's height returns an echo."""
    model = ultrasonic_of(sensor)
    position = np.asarray(sensor.pose.position)
    fans = fan_of(sensor, vehicle), RayFan.free(model.window)

    def measured(centers: Floats) -> tuple[Floats, Floats]:
        with_body, without = (returns_echo(sensor, fan, centers - position) for fan in fans)
        return with_body.astype(float), without.astype(float)

    target = "post", float(position[2])
    return field_picture_of(sensor, model.window, model.max_range, target, measured=measured)


ULTRASONIC = Kind(
    name="ultrasonic",
    label="Ultrasonic",
    plural="Ultrasonic Sensors",
    unit="echoes",
    model=Ultrasonic,
    curve=NO_AP,
    object_curves=_AnyClass(),
    counts_points=True,
    stand_off_m=0.03,
    lowest_m=0.01,  # flat ground returns no echo
    keys=frozenset({"hfov_deg", "vfov_deg", "max_range_m", "min_range_m", "max_incidence_deg"}),
    occlusion_text="cone occluded",
    measure_objects=measure_objects,
    read=read,
    write=write,
    data_sheet=figures,
    summary=summary,
    missed=missed,
    field_picture=field_picture,
    **RULES.functions,
)
