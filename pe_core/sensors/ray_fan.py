"""A fan of rays: where the vehicle is, direction by direction, as seen from a radar or ultrasonic.

The rays are the middles of a lattice of azimuths and elevations in the sensor frame. The ray of the
bin that a point is in decides whether the vehicle hides the point: these sensors resolve directions
by degrees, so bins of a fraction of a degree are exact enough, and each sensor needs its rays only
once. Parts of the vehicle that are covers (`Vehicle.covers`) let the rays of radars through, at a
loss.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import Flags, Floats, Ints, mapped
from ..geometry.poses import rotate
from ..scene.rig import Sensor, SensorModel
from ..scene.vehicle import Vehicle
from .field_of_view import FREE, FieldPicture, ViewPatch, count_by_part, grid_faces
from .kernels import Occlusion

AngleWindow = tuple[tuple[float, float], tuple[float, float]]
"""Lowest and highest azimuth, and lowest and highest elevation [rad]."""

MAX_STEP_RAD = math.radians(0.5)  # Largest bin of a fan
BINS = 240  # A window is divided into at least so many bins along its longer side
MAX_STEPS = 720  # Of a patch, along a side
PICTURE_ROWS = 180
PICTURE_COLUMNS = 241
"""Ranges and azimuths of a picture; one of the azimuths is the middle."""


@dataclass(frozen=True, eq=False)
class RayFan:
    """What the rays of a fan meet; arrays are (E, A): by elevation, lowest first, and azimuth.

    `distance` is that to what occludes [m], inf for a free ray; `part` the part of the vehicle that
    occludes, or `FREE`; `loss_db` the loss by covers, one way; `through` says which rays pass each
    cover.
    """

    window: AngleWindow
    distance: Floats
    part: NDArray[np.int32]
    loss_db: Floats
    part_names: tuple[str, ...] = ()
    through: Mapping[str, Flags] = field(default_factory=dict)

    def bins(self, azimuth: Floats, elevation: Floats) -> Ints:
        """Return the flat bin (N,) of directions, sensor frame [rad]; outside: the nearest one."""
        (left, right), (low, high) = self.window
        rows, columns = self.distance.shape
        column = ((azimuth - left) * (columns / (right - left))).astype(np.int64)
        row = ((elevation - low) * (rows / (high - low))).astype(np.int64)
        bins = np.clip(row, 0, rows - 1) * columns + np.clip(column, 0, columns - 1)
        return np.asarray(bins)

    @classmethod
    def free(cls, window: AngleWindow) -> "RayFan":
        """Return a fan whose rays are all free."""
        shape = shape_of(window)
        part = np.full(shape, FREE, np.int32)
        return cls(window, np.full(shape, np.inf), part, np.zeros(shape))

    @cached_property
    def is_free(self) -> bool:
        """Whether nothing occludes a ray, and no ray loses power."""
        return not (np.isfinite(self.distance).any() or self.loss_db.any())

    @cached_property
    def angles(self) -> tuple[Floats, Floats]:
        """Elevations (E,) and azimuths (A,) of the rays, ascending [rad]."""
        (left, right), (low, high) = self.window
        rows, columns = self.distance.shape
        return _middles(low, high, rows), _middles(left, right, columns)

    def occlusion(self, inside: Flags) -> Occlusion:
        """Count the rays of the field of view, `inside` (E, A), that end on the vehicle."""
        by_part = count_by_part(self.part[inside], self.part_names)
        return Occlusion(int(inside.sum()), sum(by_part.values()), by_part)


def window_of(model: SensorModel) -> AngleWindow:
    """Return the azimuths and elevations between which a model of a kind with a fan measures."""
    window: AngleWindow = model.window  # type: ignore[attr-defined]  # of these kinds alone
    return window


def angles_of(sensor: Sensor, offsets: Floats) -> tuple[Floats, Floats]:
    """Return azimuths and elevations (N,) of offsets (N, 3), ground axes, in the sensor frame. Of
    columns of an array NumPy takes another arctangent where the result happens to lie behind them
    in memory, and its last bit may differ: the coordinates are copied."""
    x, y, z = np.ascontiguousarray(rotate(sensor.pose.ground_from_sensor.T, offsets).T)
    return np.arctan2(y, x), np.arctan2(z, np.sqrt(x * x + y * y))


def directions(window: AngleWindow, shape: tuple[int, int]) -> Floats:
    """Return the directions (E * A, 3) of a fan's rays, sensor frame; scalar sines: same bits."""
    (left, right), (low, high) = window
    flat, up = _circle(_middles(low, high, shape[0]))
    ahead, aside = _circle(_middles(left, right, shape[1]))
    vectors = [np.outer(flat, ahead), np.outer(flat, aside), np.outer(up, np.ones(shape[1]))]
    return np.stack(vectors, axis=-1).reshape(-1, 3)


def shape_of(window: AngleWindow) -> tuple[int, int]:
    """Return the numbers of elevations and azimuths of the fan of a window."""
    (left, right), (low, high) = window
    step = min(MAX_STEP_RAD, max(right - left, high - low) / BINS)
    return tuple(max(1, math.ceil((b - a) / step)) for a, b in ((low, high), (left, right)))  # type: ignore[return-value]


class FanCache:
    """The fans of sensors on one vehicle: a sensor that has not moved needs no rays."""

    def __init__(self, vehicle: Vehicle | None, through_covers: bool) -> None:
        self._vehicle = vehicle
        self._through = through_covers
        self._fans: dict[str, tuple[Sensor, RayFan]] = {}

    def fan(self, sensor: Sensor) -> RayFan:
        """Return the fan of a sensor; models of the same window, as in a weather, share it."""
        cached = self._fans.get(sensor.name)
        if cached is not None:
            same_window = cached[1].window == window_of(sensor.model)
            if same_window and cached[0].pose == sensor.pose:
                return cached[1]
        fan = cast_fan(sensor, self._vehicle, self._through)
        self._fans[sensor.name] = sensor, fan
        return fan

    def keep_only(self, sensors: Collection[Sensor]) -> None:
        """Remove all other sensors."""
        names = {sensor.name for sensor in sensors}
        self._fans = {name: cached for name, cached in self._fans.items() if name in names}


def cast_fan(sensor: Sensor, vehicle: Vehicle | None, through_covers: bool) -> RayFan:
    """Cast the fan of a sensor. A ray loses the dB of each cover that it meets, once for a part,
    however many skins it has."""
    window = window_of(sensor.model)
    free = RayFan.free(window)
    if vehicle is None:
        return free
    distance = free.distance
    part = free.part
    loss = free.loss_db
    shape = shape_of(window)
    rays = rotate(sensor.pose.ground_from_sensor, directions(window, shape))
    names = tuple(vehicle.part_names)
    position = sensor.pose.position
    covers = dict(vehicle.covers) if through_covers else {}
    body = without_parts(vehicle, tuple(covers))
    if body is not None:
        hits = body.first_hit(position, rays)
        distance = hits.distance.reshape(shape)
        hit = hits.face.reshape(shape)
        owners = np.array([names.index(name) for name in body.part_names], np.int32)
        part = np.where(hit >= 0, owners[np.asarray(body.parts)[hit]], FREE).astype(np.int32)
    through = {}
    for name, db in covers.items():
        only = without_parts(vehicle, tuple(other for other in names if other != name))
        if only is not None:
            met = only.first_hit_from(np.asarray(position), rays).distance.reshape(shape)
            through[name] = met < distance
            loss += db * through[name]
    return RayFan(window, distance, part, loss, part_names=names, through=through)


_reduced: WeakKeyDictionary[Vehicle, dict[tuple[str, ...], Vehicle | None]] = WeakKeyDictionary()


def without_parts(vehicle: Vehicle, parts: tuple[str, ...]) -> Vehicle | None:
    """Return the vehicle without some parts, cached; None if nothing is left."""
    if not parts:
        return vehicle
    cache = _reduced.setdefault(vehicle, {})
    if parts not in cache:
        names = list(vehicle.part_names)
        gone = [names.index(name) for name in parts]
        kept = np.flatnonzero(~np.isin(vehicle.parts, gone))
        cache[parts] = None
        if len(kept):
            left = [k for k in range(len(names)) if k not in gone]
            numbers = np.searchsorted(left, np.asarray(vehicle.parts)[kept]).astype(np.int32)
            shown = np.asarray(vehicle.triangles)[kept]
            own = [names[k] for k in left]
            cache[parts] = Vehicle(shown, numbers, own, clearance=vehicle.clearance)
    return cache[parts]


def _middles(low: float, high: float, count: int) -> Floats:
    return low + (np.arange(count) + 0.5) * ((high - low) / count)


def _circle(angles: Floats) -> tuple[Floats, Floats]:
    return mapped(math.cos, angles), mapped(math.sin, angles)


def field_picture_of(
    sensor: Sensor,
    window: AngleWindow,
    max_range: float,
    target: tuple[str, float],
    measured: Callable[[Floats], tuple[Floats, Floats]],
) -> FieldPicture:
    """Return a picture; `target` is a name and the height of a centre [m]. `measured` takes centres
    (N, 3), ground frame, and returns m with the vehicle and without it."""
    (right, left), _ = window
    azimuths = left - (np.arange(PICTURE_COLUMNS) + 0.5) * (left - right) / PICTURE_COLUMNS
    step = max_range / PICTURE_ROWS
    ranges = max_range - step * (np.arange(PICTURE_ROWS) + 0.5)
    ahead = sensor.pose.ground_from_sensor[:2, 0]
    heading = math.atan2(float(ahead[1]), float(ahead[0]))
    angles = [(math.cos(heading + a), math.sin(heading + a)) for a in azimuths.tolist()]
    flat = ranges[:, None, None] * np.array(angles)
    x, y, _ = sensor.pose.position
    height = np.full((*flat.shape[:2], 1), target[1])
    centers = np.concatenate([flat + np.array([x, y]), height], axis=-1).reshape(-1, 3)
    seen, free = (m.reshape(PICTURE_ROWS, PICTURE_COLUMNS) for m in measured(centers))
    return FieldPicture(
        seen, (free > 0.0) & (seen <= 0.0), ranges, azimuths, height_m=target[1], target=target[0]
    )


def patch_of(window: AngleWindow, step: float) -> ViewPatch:
    """Return a window of azimuths and elevations as triangles of about `step` [rad]."""
    (left, right), (low, high) = window
    closed = right - left >= 2.0 * math.pi - 1e-9
    columns = min(max(math.ceil((right - left) / step), 3 if closed else 1), MAX_STEPS)
    rows = min(max(math.ceil((high - low) / step), 1), MAX_STEPS) + 1
    azimuths = np.linspace(left, right, columns + 1)[: columns if closed else None]
    up, across = np.meshgrid(np.linspace(low, high, rows), azimuths, indexing="ij")
    vectors = [np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)]
    index = np.arange(up.size).reshape(up.shape)
    return ViewPatch(np.stack(vectors, axis=-1).reshape(-1, 3), grid_faces(index, closed=closed))


def fan_rays(sensor: Sensor, window: AngleWindow, inside: Flags, most: int) -> Floats:
    """Return at most `most` directions (R, 3) of the rays `inside` (E, A), ground frame."""
    rays = directions(window, shape_of(window))[inside.reshape(-1)]
    if len(rays) > most:
        rays = rays[np.linspace(0, len(rays) - 1, most).astype(np.int64)]
    return rotate(sensor.pose.ground_from_sensor, rays)
