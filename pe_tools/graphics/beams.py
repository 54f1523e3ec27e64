"""Beams of LiDARs: cast at the vehicle, chosen, and drawn as lines and as rings on the ground. The
vehicle has to stay visible. So a free beam is faint near the vehicle, strongest where it leaves the
vehicle's surroundings, and fades out from there."""

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.base.arrays import Floats, Ints
from pe_core.scene import Sensor, Vehicle, rotate
from pe_core.sensors import Lidar
from pe_core.sensors.lidar.model import lidar_of

from .primitives import Primitives

PREVIEW_BEAMS = 12_000
MAX_BEAMS = 1_500_000
"""Maximum number of beams that are cast for a preview while the sensor moves, and when idle."""
A_FEW = 5
AZIMUTHS_OF_FEW = 60
"""Channels and azimuths of a few beams: they show the field of view without hiding the scene."""
FEWEST_AZIMUTHS = 8
"""A LiDAR with fewer has no channels to speak of: each beam has its own elevation."""

Colors = NDArray[np.floating]

BoxBounds = tuple[Floats, Floats]  # Lowest and highest corner, (3,) each [m]

OVER_THE_CAR = 0.06
"""How strong a free beam is over the vehicle, beside where it leaves its surroundings."""
SURROUNDINGS_M = 0.5
STUB_M = 0.7
RING_AZIMUTHS = 360
RING_FAR_M = 45.0
"""Places along a ring on the ground, and where rings have faded to nothing."""
RING_JUMP = 1.35
"""Neighbours on a ring whose distances differ by more than this factor are not joined."""


@dataclass(frozen=True, slots=True, eq=False)
class Cast:
    """Beams of a mounted LiDAR: some of its channels, each at the same azimuths. `rows` (R,) are
    channels and `columns` (K,) indices of azimuths, both ascending. Beam ``r * K + k`` has
    `directions` (R * K, 3) unit, ground frame; `ends` (R * K,) at the vehicle or the maximum range
    [m]; `face` (R * K,) the triangle of the vehicle that stops it, else -1."""

    sensor: Sensor
    rows: Ints
    columns: Ints
    directions: Floats
    ends: Floats
    face: Ints

    @property
    def occluded(self) -> NDArray[np.bool_]:
        """(R * K,) whether the vehicle stops the beam."""
        return self.face >= 0

    @property
    def points(self) -> Floats:
        """(R * K, 3) where the beams end, ground frame [m]."""
        ends: Floats = self.directions * self.ends[:, None]
        return ends + np.asarray(self.sensor.pose.position)


def cast(sensor: Sensor, vehicle: Vehicle | None, most: int = MAX_BEAMS) -> Cast:
    """Cast at most that many of a LiDAR's beams, evenly chosen, against the vehicle."""
    lidar = lidar_of(sensor)
    rows, columns = grid(lidar, most)
    numbers = (rows[:, None] * len(lidar.azimuth_steps) + columns).ravel()
    directions = rotate(sensor.pose.ground_from_sensor, lidar.directions[numbers])
    if vehicle is None or not len(numbers):
        ends = np.full(len(numbers), lidar.max_range)
        face = np.full(len(numbers), -1)
        return Cast(sensor, rows, columns, directions, ends=ends, face=face)
    hits = vehicle.first_hit(sensor.pose.position, directions, lidar.sees_through_glass)
    met = hits.distance < lidar.max_range
    ends = np.where(met, hits.distance, lidar.max_range)
    return Cast(sensor, rows, columns, directions, ends=ends, face=np.where(met, hits.face, -1))


def grid(lidar: Lidar, most: int) -> tuple[Ints, Ints]:
    """Channels (R,) and azimuths (K,) of an even choice of at most `most` beams, both ascending."""
    rows = evenly(len(lidar.elevations), most)
    return rows, around(lidar, most // max(len(rows), 1))


def around(lidar: Lidar, count: int) -> Ints:
    """At most `count` of the azimuths, evenly spread; a sector includes its first and last one."""
    azimuths = len(lidar.azimuth_steps)
    count = min(count, azimuths)
    if azimuths == lidar.azimuth_count and count:
        return np.arange(count) * azimuths // count  # a circle: the last is the first's neighbour
    return evenly(azimuths, count)


def evenly(total: int, count: int) -> Ints:
    """(N,) at most `count` evenly spread numbers below a total, with the first and the last."""
    if total <= count:
        return np.arange(total)
    return np.linspace(0, total - 1, max(count, 0)).round().astype(np.int64)


class ChannelMode(enum.StrEnum):
    """The channels whose beams are shown."""

    FEW = "FEW"
    ONE = "ONE"
    EVERY = "EVERY"
    ALL = "ALL"


@dataclass(frozen=True, slots=True)
class BeamChoice:
    """At most `budget` beams: of the `number`-th channel from below, or of every such channel."""

    budget: int
    channels: ChannelMode = ChannelMode.ALL
    number: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Beams:
    """Some beams of a mounted LiDAR. `directions` (N, 3) unit, ground frame; `ends` (N,) the
    vehicle or the maximum range [m]; `occluded` (N,) whether the vehicle occludes the beam;
    `channel` (N,) its channel; `share` the share of occluded beams among all beams of the
    choice."""

    directions: Floats
    ends: Floats
    occluded: NDArray[np.bool_]
    channel: Ints
    share: float


def shown_beams(found: Cast, choice: BeamChoice) -> Beams:
    """Return at most `budget` beams of a cast, with the true share of occluded ones. That share is
    the sensor's; of one channel, that channel's own."""
    lidar = lidar_of(found.sensor)
    few = choice.channels == ChannelMode.FEW
    rows = np.flatnonzero(np.isin(found.rows, channels_of(lidar, choice)))
    occluded = found.occluded
    meant = occluded.reshape(len(found.rows), -1)
    meant = meant[rows] if choice.channels == ChannelMode.ONE else meant
    share = float(meant.mean()) if meant.size else 0.0
    budget = min(choice.budget, A_FEW * AZIMUTHS_OF_FEW) if few else choice.budget
    chosen = _fair(found, rows, share, budget)
    channel = found.rows[chosen // max(len(found.columns), 1)]
    return Beams(
        found.directions[chosen], found.ends[chosen], occluded[chosen], channel, share=share
    )


def channels_of(lidar: Lidar, choice: BeamChoice) -> Ints:
    """(C,) numbers of the channels that are shown, ascending."""
    count = len(lidar.elevations)
    if choice.channels == ChannelMode.ALL or len(lidar.azimuth_steps) < FEWEST_AZIMUTHS:
        return evenly(count, choice.budget)
    upwards = np.argsort(lidar.elevations, kind="stable")
    number = max(choice.number, 1)
    if choice.channels == ChannelMode.ONE:
        return upwards[[min(number, count) - 1]]
    if choice.channels == ChannelMode.EVERY:
        return np.sort(upwards[::number][: choice.budget])
    # Those nearest to evenly spread elevations, from the highest to the lowest.
    few = max(min(A_FEW, choice.budget), 1)
    elevations = lidar.elevations
    wanted = np.linspace(elevations.min(), elevations.max(), few)
    return np.unique(np.abs(elevations[:, None] - wanted).argmin(axis=0))


def _fair(found: Cast, rows: Ints, share: float, budget: int) -> Ints:
    """Indices within a cast: free beams in a regular pattern, and occluded ones by their share."""
    occluded = found.occluded
    width = len(found.columns)
    columns = np.searchsorted(
        found.columns, around(lidar_of(found.sensor), budget // max(len(rows), 1))
    )
    columns = np.unique(np.minimum(columns, max(width - 1, 0)))
    pattern = (rows[:, None] * width + columns).ravel()
    of_rows = (rows[:, None] * width + np.arange(width)).ravel()
    free_count = min(round(budget * (1.0 - share)), int((~occluded[of_rows]).sum()))
    free = _some(free_count, pattern[~occluded[pattern]], np.flatnonzero(~occluded))
    wanted = round(len(free) * share / (1.0 - share)) if len(free) else budget
    room = budget - len(free)
    count = min(max(wanted, 1), max(room, 1)) if share > 0.0 else 0
    hit = _some(count, of_rows[occluded[of_rows]], np.flatnonzero(occluded))
    return np.concatenate([free[: budget - len(hit)], hit])


def _some(count: int, preferred: Ints, fallback: Ints) -> Ints:
    """Return at most `count` numbers, evenly from `preferred`; from `fallback` if that is empty."""
    pool = preferred if len(preferred) else fallback
    return pool[evenly(len(pool), count)]


def free_lines(
    sensor: Sensor, beams: Beams, length_m: float, colors: Colors, around: BoxBounds | None = None
) -> Primitives:
    """Lines of the free beams, two pieces each, in (N, 4) colours. The lines end at the range, the
    ground (z = 0) or `length_m`, and fade out towards that length. Inside the box `around` they are
    faint."""
    free = ~beams.occluded
    directions = beams.directions[free]
    ends = np.minimum(np.minimum(beams.ends[free], length_m), ground_distance(sensor, directions))
    leave = np.minimum(_housing_exits(sensor, directions, around), ends)
    points = np.empty((len(ends), 4, 3))
    points[:] = sensor.pose.position
    points[:, 1:3] += (directions * leave[:, None])[:, None]
    points[:, 3] += directions * ends[:, None]
    shown = np.repeat(np.asarray(colors[free], np.float32)[:, None], 4, axis=1)
    shown[:, 0, 3] *= OVER_THE_CAR
    shown[:, 1:3, 3] *= (1.0 - leave / length_m)[:, None]
    shown[:, 3, 3] *= 1.0 - ends / length_m
    return Primitives.of(points, shown)


def occluded_lines(sensor: Sensor, beams: Beams, colors: Colors) -> Primitives:
    """Lines of the occluded beams, one piece each, in (N, 4) colours. A shorter line is drawn
    `STUB_M` long, because it would not be visible otherwise."""
    occluded = beams.occluded
    ends = np.maximum(beams.ends[occluded], STUB_M)
    points = np.empty((len(ends), 2, 3))
    points[:] = sensor.pose.position
    points[:, 1] += beams.directions[occluded] * ends[:, None]
    return Primitives.of(points, np.repeat(colors[occluded], 2, axis=0))


def ground_rings(found: Cast, rows: NDArray[np.int64], colors: Colors) -> Primitives:
    """Rings where whole channels meet the ground, without occluded parts, in (R, 4) colours. `rows`
    (R,) are numbers of channels; channels that were not cast are left out."""
    width = len(found.columns)
    if not width:
        return Primitives.empty()
    kept = np.flatnonzero(np.isin(rows, found.rows))
    lines = np.searchsorted(found.rows, rows[kept])
    columns = np.unique(np.linspace(0, width - 1, min(RING_AZIMUTHS, width)).round().astype(int))
    beams = lines[:, None] * width + columns
    distance = ground_distance(found.sensor, found.directions[beams.ravel()]).reshape(beams.shape)
    meets = (found.face[beams] < 0) & (distance <= lidar_of(found.sensor).max_range)
    far = np.where(meets, distance, np.inf)
    return _joined(found, beams, far, colors[kept])


def ground_distance(sensor: Sensor, directions: Floats) -> Floats:
    """(N,) distance along each direction to z = 0 [m]; inf for a beam that does not meet it."""
    height = sensor.pose.position[2]
    down = -directions[:, 2]
    if height <= 0.0:
        return np.full(len(directions), np.inf)
    distance = np.full(len(directions), np.inf)
    return np.divide(height, down, out=distance, where=down > 0.0)


def _joined(found: Cast, beams: NDArray[np.int64], far: Floats, colors: Colors) -> Primitives:
    """Join near neighbours of each ring (R, K), and the last point with the first."""
    circle = len(lidar_of(found.sensor).azimuth_steps) == lidar_of(found.sensor).azimuth_count
    after = np.roll(far, -1, axis=1)
    near = np.maximum(far, after) < RING_JUMP * np.minimum(far, after)
    near &= np.minimum(far, after) < RING_FAR_M
    near[:, -1] &= circle
    row, column = np.nonzero(near)
    following = (column + 1) % far.shape[1]
    ends = np.stack([beams[row, column], beams[row, following]], axis=1)
    distance = np.stack([far[row, column], far[row, following]], axis=1)
    points = np.asarray(found.sensor.pose.position) + (found.directions[ends] * distance[..., None])
    shown = np.repeat(np.asarray(colors[row], np.float32)[:, None], 2, axis=1)
    shown[..., 3] *= np.clip(1.0 - distance / RING_FAR_M, 0.0, 1.0)
    return Primitives.of(points, shown)


def _housing_exits(sensor: Sensor, directions: Floats, around: BoxBounds | None) -> Floats:
    """(N,) distance at which directions leave a box and its surroundings; 0 outside of it [m]."""
    if around is None or not len(directions):
        return np.zeros(len(directions))
    place = np.asarray(sensor.pose.position)
    low = around[0] - SURROUNDINGS_M
    high = around[1] + SURROUNDINGS_M
    with np.errstate(divide="ignore", invalid="ignore"):
        walls = np.stack([(low - place) / directions, (high - place) / directions])
    enter = np.nanmax(walls.min(axis=0), axis=1)
    leave = np.nanmin(walls.max(axis=0), axis=1)
    return np.where((leave > 0.0) & (leave >= enter), leave, 0.0)
