"""The measurement m of a radar by definition: expected detections, of objects and of voxels.

**Cells.** An object of length l, width w and height h at the distance R, whose axis makes the angle
a with the line of sight, is W = l |sin a| + w |cos a| wide; its mean depth along the line of sight
is l w / W. It covers N = max(1, depth / dR) max(1, W / (R dAz)) max(1, h / (R dEl)) resolution
cells of a mode, the last factor only where the mode measures elevations. Its RCS is shared equally
by the cells, and a cell is detected with the probability Pd of `detection`.

**Objects.** m is the sum over modes of N times the mean of Pd over the object's silhouette: 0 for
the part that the mode does not reach, that the vehicle or, in traffic, another object hides. It is
at most the length of the list. Points on the sides of the box that face the radar stand for the
silhouette, each with the solid angle of its piece of the side.

**A cautious radar** (a requirement's) errs low. m is no more than the probability of any detection,
until that is `SURE`: rare detections in many cells are none. The sides are divided into patches,
and each has the least Pd of its four corners: what an edge of the field, of the range or of the
vehicle cuts counts as not detected.

**Voxels.** A voxel has the share of its silhouette in that of a reference car with the same centre,
seen from all headings alike: m = m of the car, divided by k = (l + w) h / (2 s^2) (as in
`derived_object_curve`). The direction of the centre decides whether it is reached and hidden.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...base.arrays import Flags, Floats, Ints
from ...geometry.bins import blocks
from ...geometry.poses import dot
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..boxes import NUDGE_M, BoxRays, PlacedBoxes, Rivals, behind_others
from ..kernels import ObjectView
from ..kind import SIZES
from ..ray_fan import RayFan, angles_of, cast_fan
from ..ray_fan_kernels import BALL_MARGIN_M, FanRules
from .detection import LOW_DBSM, counted, detection_probability, signal_to_noise
from .model import Radar, RadarMode, radar_of

RivalsOf = Callable[[Ints], Rivals]
TARGET = "car"
"""Class of the object whose share a voxel has."""
ASPECTS = np.radians(np.arange(2.5, 180.0, 5.0))
"""Aspects over which the RCS of the reference car is averaged [rad]."""
SIDE_POINTS = 55, 34  # Points of a side of a box: neighbouring Fibonacci numbers
SIDE_PATCHES = 10
"""A side of a box is so many patches wide and high to a cautious radar: a body that an edge cuts
loses up to a tenth of the side."""
OBJECTS_AT_ONCE = 1024
SURE = 0.9
"""Probability of a detection from which an object counts as one point to a requirement."""
CONE_MARGIN = 1e-6  # Of the cosine and of the angle of the cone round the field of view
NEAR_M = 1e-6  # Replaces the distance 0


def fan_of(sensor: Sensor, vehicle: Vehicle | None) -> RayFan:
    """Return the fan of rays of a radar, through covers of the vehicle."""
    return cast_fan(sensor, vehicle, True)


def mode_signal(
    radar: Radar,
    mode: RadarMode,
    angles: tuple[Floats, Floats],
    distance: Floats,
    rcs: Floats,
    loss_db: Floats | None,
) -> Floats:
    """Return Pd (...,) of cells of `rcs` [m2] in directions at distances; 0 if not `counted`.
    `angles` are azimuths and elevations in the sensor frame [rad], `loss_db` the loss of covers one
    way, None for none."""
    azimuth, elevation = angles
    reach = mode.reach(azimuth, elevation)
    snr = signal_to_noise(
        rcs, distance, reach, radar.anchor, attenuation_db_km=radar.attenuation_db_km
    )
    if loss_db is not None:
        snr = snr * np.exp(-math.log(10.0) / 5.0 * loss_db)  # both ways
    pd = counted(detection_probability(snr, radar.false_alarm))
    return np.where((reach > 0.0) & mode.in_range(distance), pd, 0.0)


def cells_of(mode: RadarMode, sizes: tuple[Floats, Floats, Floats], distance: Floats) -> Floats:
    """Return the number (...,) of cells that objects cover: depth, width, height [m], distance."""
    depth, width, height = sizes
    cells = np.ones(distance.shape)
    if mode.range_resolution is not None:
        cells = cells * np.maximum(1.0, depth / mode.range_resolution)
    if mode.azimuth_resolution is not None:
        cells = cells * np.maximum(1.0, width / (distance * mode.azimuth_resolution))
    if mode.elevation_resolution is not None:
        cells = cells * np.maximum(1.0, height / (distance * mode.elevation_resolution))
    return np.asarray(cells)


def measure_voxels(sensor: Sensor, centers: Floats, side: float, fan: RayFan) -> Floats:
    """Return m (V,) of cubes with centres (V, 3) and a side [m]."""
    offsets = centers - (np.asarray(sensor.pose.position) + NUDGE_M)
    distance = np.maximum(np.sqrt(dot(offsets, offsets)), NEAR_M)
    m = np.zeros(len(centers))
    radar = radar_of(sensor)
    reached = (distance <= radar.max_range) & (distance >= radar.min_range)
    cosine = math.cos(min(radar.cone, math.pi))
    if cosine > -1.0:  # cheap, and never too few
        ahead = sensor.pose.ground_from_sensor[:, 0]
        reached &= dot(offsets, ahead) >= (cosine - CONE_MARGIN) * distance
    which = np.flatnonzero(reached)
    if len(which):
        angles = angles_of(sensor, offsets[which])
        m[which] = measure_directions(radar, angles, distance[which], side, fan=fan)
    return m


def measure_directions(
    radar: Radar, angles: tuple[Floats, Floats], distance: Floats, side: float, fan: RayFan
) -> Floats:
    """Return m (...,) of cubes in directions, sensor frame, at distances (...,) [m]."""
    free, loss = seen_through(fan, angles, distance)
    m = target_detections(radar, angles, distance, loss)
    m[~free] = 0.0
    length, width, height = SIZES[TARGET]
    return m * min(1.0, 2.0 * side * side / ((length + width) * height))


def target_detections(
    radar: Radar, angles: tuple[Floats, Floats], distance: Floats, loss_db: Floats | None
) -> Floats:
    """Return m (...,) of a reference car, the mean of all headings, that nothing hides."""
    length, width, height = SIZES[TARGET]
    across = 2.0 * (length + width) / math.pi
    sizes = np.full(1, length * width / across), np.full(1, across), np.full(1, height)
    rcs = float(radar.reflectivity(TARGET).square_metres(ASPECTS).mean())
    m = np.zeros(distance.shape)
    for mode in radar.modes:
        ahead = mode.faces(angles[0])
        some = np.flatnonzero(ahead.any(axis=1) if ahead.ndim > 1 else ahead)
        part = (angles[0][some], angles[1][some])
        far = distance[some]
        cells = cells_of(mode, sizes, far)
        loss = None if loss_db is None else loss_db[some]
        m[some] += cells * mode_signal(radar, mode, part, far, rcs=rcs / cells, loss_db=loss)
    return m if radar.list_length is None else np.minimum(m, radar.list_length)


def reached_by_balls(sensor: Sensor, centers: Floats, balls: Floats) -> Flags:
    """Whether balls (N,) round points (N, 3) [m] may reach into the field; never too few."""
    radar = radar_of(sensor)
    offsets = centers - np.asarray(sensor.pose.position)
    distance = np.maximum(np.sqrt(dot(offsets, offsets)), NEAR_M)
    reached = (distance - balls <= radar.max_range) & (distance + balls >= radar.min_range)
    ahead = dot(offsets, sensor.pose.ground_from_sensor[:, 0])
    angle = np.arccos(np.clip(ahead / distance, -1.0, 1.0))
    wide = np.arcsin(np.minimum(balls / distance, 1.0))
    return np.asarray(reached & ((angle - wide <= radar.cone + CONE_MARGIN) | (distance <= balls)))


def seen_through(
    fan: RayFan, angles: tuple[Floats, Floats], distance: Floats
) -> tuple[Flags, Floats | None]:
    """Return whether the vehicle hides nothing before the distances (...,), and the loss [dB]."""
    if fan.is_free:
        return np.ones(distance.shape, bool), None
    azimuth, elevation = angles
    bins = fan.bins(azimuth, elevation)
    return fan.distance.reshape(-1)[bins] >= distance, fan.loss_db.reshape(-1)[bins]


def measure_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """Return m (N,) of objects."""
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    scenes = objects.scenes if traffic else np.arange(len(objects))
    fan = fan_of(sensor, vehicle)
    everything = np.arange(len(objects))
    return objects_seen(
        sensor, objects, fan, boxes, which=everything, near=lambda own: Rivals.of(scenes, own)
    )


def objects_seen(
    sensor: Sensor, objects: Objects, fan: RayFan, boxes: PlacedBoxes, which: Ints, near: RivalsOf
) -> Floats:
    """Return m (N,) of objects `which`, 0 of others; `near` returns boxes that may hide some."""
    m = np.zeros(len(objects))
    for some in blocks(len(which), OBJECTS_AT_ONCE):
        own = which[some]
        m[own] = _block(sensor, objects, boxes, own, fan=fan, near=near(own))
    return m


def _block(
    sensor: Sensor, objects: Objects, boxes: PlacedBoxes, own: Ints, fan: RayFan, near: Rivals
) -> Floats:
    """Return m (P,) of the objects `own` (P,)."""
    radar = radar_of(sensor)
    own_boxes = boxes.take(own)
    sizes, far, aspect = seen_sizes(own_boxes)
    rcs = np.zeros(len(own))
    labels = objects.labels[own]
    for number in np.unique(labels).tolist():
        some = labels == number
        reflectivity = radar.reflectivity(objects.class_names[number])
        rcs[some] = reflectivity.square_metres(aspect[some])
    silhouette = _BodyOutline.of(own_boxes, radar.is_cautious)
    sides = silhouette.rays
    angles = angles_of(sensor, sides.directions)
    free, loss = seen_through(fan, angles, sides.distance)
    free &= ~behind_others(boxes, near, sides)
    m = np.zeros(len(own))
    missed = np.ones(len(own))
    for mode in radar.modes:
        cells = cells_of(mode, sizes, far)
        pd = mode_signal(
            radar, mode, angles, sides.distance, rcs=(rcs / cells)[sides.item], loss_db=loss
        )
        mean = silhouette.mean(free * pd, len(own))
        m += cells * mean
        missed *= np.maximum(1.0 - mean, 0.0) ** cells  # at most so often no cell detects it
    if radar.is_cautious:
        m = np.where(1.0 - missed >= SURE, m, np.minimum(m, 1.0 - missed))
    return m if radar.list_length is None else np.minimum(m, radar.list_length)


@dataclass(frozen=True, slots=True)
class _BodyOutline:
    """Points on the sides of boxes that face the radar, which stand for the boxes' silhouettes.

    `rays` (R,) lead to the points, `solid` (R,) are solid angles [sr]. If `is_cautious`, the points
    are the corners of patches.
    """

    rays: BoxRays
    solid: Floats
    is_cautious: bool

    @classmethod
    def of(cls, boxes: PlacedBoxes, is_cautious: bool) -> "_BodyOutline":
        if is_cautious:
            return cls(*boxes.side_corners(SIDE_PATCHES), True)
        return cls(*boxes.side_points(SIDE_POINTS), False)

    def mean(self, values: Floats, count: int) -> Floats:
        """Return the mean of values (R,) over the silhouettes of `count` boxes; of a cautious radar
        a lower bound."""
        items = self.rays.item
        solid = self.solid
        if self.is_cautious:
            items = items[:: (SIDE_PATCHES + 1) ** 2].repeat(SIDE_PATCHES**2)
            solid = np.mean(_corners_of_patches(solid), axis=0)
            values = np.min(_corners_of_patches(values), axis=0)
        whole = np.maximum(np.bincount(items, solid, count), np.finfo(float).tiny)
        return np.asarray(np.bincount(items, solid * values, count) / whole)


def _corners_of_patches(values: Floats) -> Floats:
    """Return values (R,) at the corners of patches by corner and patch, (4, P)."""
    grids = values.reshape(-1, SIDE_PATCHES + 1, SIDE_PATCHES + 1)
    corners = grids[:, :-1, :-1], grids[:, 1:, :-1], grids[:, :-1, 1:], grids[:, 1:, 1:]
    return np.stack([each.reshape(-1) for each in corners])


def seen_sizes(boxes: PlacedBoxes) -> tuple[tuple[Floats, Floats, Floats], Floats, Floats]:
    """Return mean depth, width and height (N,) of boxes as seen [m], their distance, and aspect.
    The aspect is the angle between the heading and the direction to the radar [rad]."""
    length, width, height = (2.0 * boxes.halves).T
    x, y, _ = boxes.offsets.T
    flat = np.maximum(np.sqrt(x * x + y * y), NEAR_M)
    across = (length * np.abs(y) + width * np.abs(x)) / flat
    far = np.maximum(np.sqrt(dot(boxes.offsets, boxes.offsets)), NEAR_M)
    return (length * width / across, across, height), far, np.arctan2(np.abs(y), -x)


def measure_view(sensor: Sensor, view: ObjectView, fan: RayFan) -> Floats:
    """Return m (N,) of the objects whose balls reach into the field of view, 0 of others."""
    objects = view.objects
    boxes = PlacedBoxes.of(objects, sensor.pose.position)
    balls = np.sqrt(dot(objects.sizes, objects.sizes)) / 2.0 + BALL_MARGIN_M
    which = np.flatnonzero(reached_by_balls(sensor, objects.centers, balls))
    alone = np.arange(len(objects))

    def near(own: Ints) -> Rivals:
        if not view.traffic:
            return Rivals.of(alone, own)
        return Rivals.near(boxes, objects.scenes, balls, own)

    return objects_seen(sensor, objects, fan, boxes, which=which, near=near)


def measure_columns(
    sensor: Sensor, columns: Floats, heights: Floats, side: float, fan: RayFan
) -> Floats:
    """Return m (C, Z) of cubes in columns (C, 2) at heights (Z,) [m]. What depends on the column
    alone is computed once a column; so does the azimuth of a level radar. Sums are in the order of
    `rotate` and `dot`: the same bits as of single cubes."""
    position = np.asarray(sensor.pose.position) + NUDGE_M
    x, y = (columns - position[:2]).T[:, :, None]
    z = heights - position[2]
    ahead, left, up = (
        row[0] * x + row[1] * y + (row[2] * z if row[2] else 0.0)
        for row in sensor.pose.ground_from_sensor.T
    )
    angles = np.arctan2(left, ahead), np.arctan2(up, np.sqrt(ahead * ahead + left * left))
    distance = np.maximum(np.sqrt(x * x + y * y + z * z), NEAR_M)
    return measure_directions(radar_of(sensor), angles, distance, side, fan=fan)


def detects_points(sensor: Sensor, points: Floats, fan: RayFan) -> Flags:
    """Whether points (N, 3) of posts are detected with the probability of the data sheet. A post
    has the RCS in one cell that 95 % of all pedestrians exceed, the weakest class."""
    radar = radar_of(sensor)
    offsets = points - (np.asarray(sensor.pose.position) + NUDGE_M)
    distance = np.maximum(np.sqrt(dot(offsets, offsets)), NEAR_M)
    angles = angles_of(sensor, offsets)
    free, loss = seen_through(fan, angles, distance)
    rcs = np.full(len(points), 10.0 ** (LOW_DBSM["pedestrian"] / 10.0))
    found = np.zeros(len(points), bool)
    for mode in radar.modes:
        pd = mode_signal(radar, mode, angles, distance, rcs=rcs, loss_db=loss)
        found |= pd >= radar.detection_probability * (1.0 - 1e-12)
    return found & free


def field_of(sensor: Sensor, fan: RayFan) -> Flags:
    """Return which rays (E, A) of a fan are in the field of any mode."""
    elevations, azimuths = fan.angles
    shape = fan.distance.shape
    across = np.broadcast_to(azimuths, shape).reshape(-1)
    up = np.broadcast_to(elevations[:, None], shape).reshape(-1)
    modes = radar_of(sensor).modes
    inside = np.logical_or.reduce([mode.reach(across, up) > 0.0 for mode in modes])
    return np.asarray(inside).reshape(shape)


RULES = FanRules(
    through_covers=True,
    field=field_of,
    reached=reached_by_balls,
    voxels=measure_voxels,
    columns=measure_columns,
    posts=detects_points,
    objects=measure_view,
)
