"""What a LiDAR sees: its field as a mesh, a range image, its mask, the beams to one location."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats
from ...geometry.poses import rotate
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..field_of_view import ViewPatch, grid_faces
from ..kind import BETWEEN_BEAMS, OUT_OF_RANGE, OUT_OF_VIEW
from .definition import BALL, beam_directions, cube_crossing, offsets_in_voxels
from .model import Lidar, lidar_of

MIN_EXTENT = math.radians(0.2)
"""A field of view without height or width, as of a single channel, is drawn with this one [rad]."""
POLE = math.radians(89.0)
"""A field of view beyond this elevation is drawn up to the pole [rad]."""
MIN_AZIMUTHS = 8
"""A model of fewer azimuths than this is a pattern: its beams may have any azimuth."""
WIDE_GAP_RAD = math.radians(5.0)
"""A gap between azimuths wider than this, and than 1.5 steps, bounds a field of view [rad]."""


def beam_patch(lidar: Lidar, step: float) -> ViewPatch:
    """Return the region between a LiDAR's beams as triangles of about `step` [rad]."""
    band = _lattice_band if lidar.azimuth_count >= MIN_AZIMUTHS else _pattern_band
    azimuths, low, high, closed = band(lidar, step)
    middle = (low + high) / 2.0
    half = np.maximum((high - low) / 2.0, MIN_EXTENT / 2.0)
    low = np.maximum(middle - half, -np.pi / 2.0)
    high = np.minimum(middle + half, np.pi / 2.0)
    rows = max(math.ceil(float((high - low).max()) / step), 1) + 1
    elevation = low + np.linspace(0.0, 1.0, rows)[:, None] * (high - low)
    x = np.cos(elevation) * np.cos(azimuths)
    y = np.cos(elevation) * np.sin(azimuths)
    directions = np.stack([x, y, np.sin(elevation)], axis=-1).reshape(-1, 3)
    index = np.arange(len(directions)).reshape(rows, -1)
    for row, angles in ((0, -low), (-1, high)):
        if closed and float(angles.min()) > POLE:
            index[row] = index[row, 0]
            directions[index[row, 0]] = 0.0, 0.0, 1.0 if row else -1.0
    return ViewPatch(directions, grid_faces(index, closed=closed))


def _lattice_band(lidar: Lidar, step: float) -> tuple[Floats, Floats, Floats, bool]:
    """Azimuths of columns, lowest and highest elevation at each [rad], and whether they close."""
    steps = lidar.azimuth_steps
    offsets = lidar.azimuth_offsets
    closed = len(steps) == lidar.azimuth_count
    first = float(steps[0]) * lidar.azimuth_step + float(offsets.min())
    last = float(steps[-1]) * lidar.azimuth_step + float(offsets.max())
    azimuths = _columns(first, last, step, closed)
    flat = np.ones(len(azimuths))
    return azimuths, flat * lidar.elevations.min(), flat * lidar.elevations.max(), closed


def _pattern_band(lidar: Lidar, step: float) -> tuple[Floats, Floats, Floats, bool]:
    """As `_lattice_band`, for beams at any azimuth: no column lies in the widest gap."""
    azimuths = np.mod(lidar.azimuth_offsets, 2.0 * np.pi)
    elevations = lidar.elevations
    order = np.argsort(azimuths, kind="stable")
    azimuths = azimuths[order]
    elevations = elevations[order]
    gaps = np.diff(azimuths, append=azimuths[0] + 2.0 * np.pi)
    after = int(np.argmax(gaps)) + 1
    closed = float(gaps.max()) < 4.0 * step
    azimuths = np.concatenate([azimuths[after:], azimuths[:after] + 2.0 * np.pi])
    elevations = np.concatenate([elevations[after:], elevations[:after]])
    columns = _columns(float(azimuths[0]), float(azimuths[-1]), step, closed)
    spacing = columns[1] - columns[0]
    column = np.rint((azimuths - columns[0]) / spacing).astype(np.int64) % len(columns)
    low = np.full(len(columns), np.inf)
    high = np.full(len(columns), -np.inf)
    np.minimum.at(low, column, elevations)
    np.maximum.at(high, column, elevations)
    filled = np.isfinite(low)
    period = 2.0 * np.pi
    low = np.interp(columns, columns[filled], low[filled], period=period)
    return columns, low, np.interp(columns, columns[filled], high[filled], period=period), closed


def _columns(first: float, last: float, step: float, closed: bool) -> Floats:
    """Azimuths of columns about `step` apart, from first to last or all round [rad]."""
    if closed:
        count = max(math.ceil(2.0 * math.pi / step), 3)
        return first + np.arange(count) * (2.0 * math.pi / count)
    middle = (first + last) / 2.0
    half = max((last - first) / 2.0, MIN_EXTENT / 2.0)
    return np.linspace(middle - half, middle + half, max(math.ceil(2.0 * half / step), 1) + 1)


@dataclass(frozen=True, slots=True)
class RangePicture:
    """A range image: how far a LiDAR's beams reach, and what ends them.

    A row is a channel, the highest first; a column is an azimuth, the leftmost first. The middle of
    a full circle is straight ahead. A channel's azimuth offset moves its beams, not its columns.

    `distance` (C, A): Distance at which each beam ends on the vehicle, on a thing or on the ground
        (z = 0) [m]; inf where there is no echo between minimum and maximum range.
    `occluded` (C, A): Whether the vehicle ends the beam, also nearer than the minimum range.
    `things` (C, A): The part of `things` that ends the beam; -1 where none does, or without an
        echo.
    `elevations` (C,): Elevations of the rows, descending [rad].
    `azimuths` (A,): Azimuths of the columns, descending: positive is left [rad].
    """

    distance: Floats
    occluded: NDArray[np.bool_]
    things: NDArray[np.int64]
    elevations: Floats
    azimuths: Floats


def range_picture(
    sensor: Sensor, vehicle: Vehicle | None, things: Vehicle | None = None
) -> RangePicture:
    """Return the range image of a mounted LiDAR. `sensor`: A LiDAR. `vehicle`: The vehicle it is
    mounted on. `things`: Other bodies in the scene, as parts of one mesh."""
    lidar = lidar_of(sensor)
    position = sensor.pose.position
    directions = rotate(sensor.pose.ground_from_sensor, lidar.directions)
    ground = np.full(len(directions), np.inf)
    if position[2] > 0.0:
        np.divide(position[2], -directions[:, 2], out=ground, where=directions[:, 2] < 0.0)
    body = np.full(len(directions), np.inf)
    if vehicle is not None:
        body = vehicle.first_hit(position, directions).distance
    thing = np.full(len(directions), np.inf)
    part = np.full(len(directions), -1)
    if things is not None:
        hits = things.first_hit_from(np.asarray(position), directions)
        thing = hits.distance
        part = np.where(hits.face >= 0, np.asarray(things.parts)[hits.face], -1).astype(np.int64)
    surroundings = np.minimum(ground, thing)
    distance = np.minimum(body, surroundings)
    no_echo = (distance > lidar.max_range) | (distance < lidar.min_range)
    on_thing = (part >= 0) & (thing < np.minimum(body, ground)) & ~no_echo
    occluded = (body <= surroundings) & (body <= lidar.max_range)
    rows = np.argsort(-lidar.elevations, kind="stable")
    columns = np.argsort(-columns_around(lidar), kind="stable")

    def as_image(values: NDArray) -> NDArray:
        return values.reshape(len(rows), len(columns))[np.ix_(rows, columns)]

    return RangePicture(
        as_image(np.where(no_echo, np.inf, distance)),
        as_image(occluded),
        as_image(np.where(on_thing, part, -1)),
        lidar.elevations[rows],
        azimuths=columns_around(lidar)[columns],
    )


def columns_around(lidar: Lidar) -> Floats:
    """Return the azimuths (A,) of the columns, above -180 to 180 degrees [rad]."""
    azimuths = lidar.azimuth_steps * lidar.azimuth_step
    turned: Floats = np.pi - np.mod(np.pi - azimuths, 2.0 * np.pi)
    return turned


def sample_beams(sensor: Sensor, max_count: int) -> Floats:
    """Return the directions (R, 3) of at most `max_count` beams, ground frame, evenly picked."""
    directions = lidar_of(sensor).directions
    if len(directions) > max_count:
        directions = directions[np.linspace(0, len(directions) - 1, max_count).astype(np.int64)]
    return rotate(sensor.pose.ground_from_sensor, directions)


def beams_to(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats]:
    """Return the directions (R, 3) of beams through a cube in range, and where they enter [m]."""
    directions, enter, leave = _through(sensor, center, side)
    lidar = lidar_of(sensor)
    in_range = (enter <= lidar.max_range / side) & (leave >= lidar.min_range / side)
    return directions[in_range], enter[in_range] * side


def reason_missed(sensor: Sensor, center: Floats, side: float) -> str:
    """Return why no beam passes through a cube: out of range, out of view or between beams."""
    lidar = lidar_of(sensor)
    offset = center - np.asarray(sensor.pose.position)
    gap = np.maximum(np.abs(offset) - side / 2.0, 0.0)
    if float(np.sqrt((gap * gap).sum())) > lidar.max_range:
        return OUT_OF_RANGE
    if len(_through(sensor, center, side)[0]):
        return OUT_OF_RANGE
    return BETWEEN_BEAMS if _in_view(lidar, sensor, offset, side) else OUT_OF_VIEW


def _through(sensor: Sensor, center: Floats, side: float) -> tuple[Floats, Floats, Floats]:
    """Directions of beams through a cube, and where they enter and leave it, in sides."""
    directions = beam_directions(sensor)
    offset = offsets_in_voxels(center[None], sensor.pose.position, side)
    enter, leave = cube_crossing(np.broadcast_to(offset, directions.shape), directions)
    through = enter < leave
    return directions[through], enter[through], leave[through]


def _in_view(lidar: Lidar, sensor: Sensor, offset: Floats, side: float) -> bool:
    """Whether a cube lies between the lowest and highest channel, and among the azimuths."""
    x, y, z = rotate(sensor.pose.ground_from_sensor.T, offset).tolist()
    distance = math.hypot(x, y, z)
    flat = math.hypot(x, y)
    if distance <= BALL * side:
        return True
    margin = math.asin(BALL * side / distance)
    low = float(lidar.elevations.min())
    high = float(lidar.elevations.max())
    if not low - margin <= math.atan2(z, flat) <= high + margin:
        return False
    half_width = math.asin(min(1.0, BALL * side / flat)) if flat else math.pi
    return _distance_to_azimuths(lidar, math.atan2(y, x)) <= half_width


def _distance_to_azimuths(lidar: Lidar, azimuth: float) -> float:
    """Angle from an azimuth to the field of view, sensor frame [rad]; 0 inside."""
    beams = lidar.directions
    azimuths = np.unique(np.arctan2(beams[:, 1], beams[:, 0]))
    distances = np.abs((azimuths - azimuth + math.pi) % (2.0 * math.pi) - math.pi)
    before = float(np.min((azimuth - azimuths) % (2.0 * math.pi)))
    after = float(np.min((azimuths - azimuth) % (2.0 * math.pi)))
    step = lidar.azimuth_step if lidar.azimuth_count > 1 else 0.0
    inside = before + after <= max(WIDE_GAP_RAD, 1.5 * step)
    return 0.0 if inside else float(distances.min())
