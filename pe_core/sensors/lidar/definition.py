"""The measurement m of a LiDAR by definition: every beam is tested, of voxels and of objects.

Fast kernels are held to these functions by tests.

Some beams run exactly along a face or through an edge of a voxel.

Such ties are common: designers put sensors at round numbers, and azimuth 0 and elevation 0 are
beams. The definition and every kernel resolve a tie alike, because all of them take the sensor's
position by one rule. Its coordinates in voxels are rounded to SNAP_DECIMALS, which makes round
numbers exact. Then NUDGE is added: too small to matter, too large for rounding to undo. As a result
a voxel owns its lower faces. A sensor on a voxel's edge or corner is only a nudge away from the
neighbouring voxels, so the nudge has to be exact there: it is a multiple of NUDGE_UNIT, which
floats represent exactly in coordinates of several thousand voxels.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import Floats, Ints, join_columns
from ...geometry.bins import blocks
from ...geometry.poses import dot, rotate
from ...scene.objects import Objects
from ...scene.rig import Sensor
from ...scene.vehicle import Vehicle
from ..boxes import CELLS, LAYERS, NO_END, BodyParts, PlacedBoxes
from .model import ROAD, lidar_of
from .returns import expected_points, share_of_points

SNAP_DECIMALS = 9
NUDGE_UNIT = 2.0**-40
"""In voxels; the resolution of the fixed point numbers of `lidar.grid_sweep`."""
NUDGE = np.array([21660, 33205, 54756]) * NUDGE_UNIT
"""1.97, 3.02 and 4.98 times 1e-8 voxels: nanometres. They differ by axis, so that diagonals are
decided as well: a beam whose components had the ratio of two nudges would still run through edges
of voxels. Beams at round angles have ratios such as 2 : 3 and 2 : 5 (30 degrees up, pitched by 90).
These nudges have no ratio that angles in steps of 15 degrees give; they are off by so much that the
rounding in a sweep through thousands of planes (`lidar.grid_sweep`) cannot decide."""
ZERO_COMPONENT = 1e-30
"""Replaces a direction component of exactly 0, so that division by it gives a huge number."""
MAX_BEAM_TESTS = 1 << 23
"""Beams times voxels (or boxes) tested together: a bound of the memory."""
CULL_MARGIN_RAD = 1e-6  # Cones round cubes are widened by this against rounding [rad]
BALL = np.sqrt(3.0) / 2.0  # Radius of the ball around a cube, in sides


def offsets_in_voxels(centers: Floats, position: Sequence[float], side: float) -> Floats:
    """Return centres (V, 3) as seen from the sensor, in voxel sides."""
    whole = np.round((centers - np.asarray(position)) / side - 0.5, SNAP_DECIMALS)
    return whole + (0.5 - NUDGE)


def position_in_voxels(position: Sequence[float], origin: Sequence[float], side: float) -> Floats:
    """Return the sensor's position (3,) as seen from the space's lowest corner, in voxel sides."""
    cells = (np.asarray(position) - np.asarray(origin)) / side
    return np.round(cells, SNAP_DECIMALS) + NUDGE


def without_zeros(directions: Floats) -> Floats:
    """Return directions with components of 0, or of less, replaced by `ZERO_COMPONENT`. What is
    nearer to 0 than that (an angle of 1e-320 degrees) would overflow where it divides."""
    zeros = np.abs(directions) < ZERO_COMPONENT
    return np.where(zeros, ZERO_COMPONENT, directions) if zeros.any() else directions


def beam_directions(sensor: Sensor) -> Floats:
    """Return the unit directions (B, 3) of a LiDAR's beams, ground frame; eq. 1."""
    return rotate(sensor.pose.ground_from_sensor, lidar_of(sensor).directions)


def beam_axes(sensor: Sensor, beams: Ints | None = None) -> list[Floats]:
    """Return the components of `beam_directions`, an array (B,) an axis; the same bits. Given the
    indices of beams (N,), those of these alone."""
    x, y, z = lidar_of(sensor).direction_axes
    if beams is not None:
        x, y, z = (w.take(beams) for w in (x, y, z))
    axes = []
    for row in sensor.pose.ground_from_sensor:
        axis = row[0] * x
        axis += row[1] * y
        axis += row[2] * z
        axes.append(axis)
    return axes


def beam_ends(sensor: Sensor, directions: Floats, vehicle: Vehicle | None) -> Floats:
    """Return the distance (B,) at which each beam ends: on the vehicle or at maximum range [m]."""
    max_range = lidar_of(sensor).max_range
    if vehicle is None:
        return np.full(len(directions), max_range)
    glass = sensor.model.sees_through_glass
    hits = vehicle.first_hit(sensor.pose.position, directions, glass)
    return np.minimum(hits.distance, max_range)


def count_beams(sensor: Sensor, centers: Floats, side: float, vehicle: Vehicle | None) -> Floats:
    """Count the beams through cubes: m of voxels.

    A beam counts in a cube that it enters before it ends, and leaves (or ends in) no nearer than
    the minimum range.

    `centers` (V, 3) are in the ground frame [m], `side` in metres; returns (V,) numbers.
    """
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle) / side
    min_range = lidar_of(sensor).min_range / side
    offsets = offsets_in_voxels(centers, sensor.pose.position, side)
    counts = np.zeros(len(centers))
    for some in blocks(len(centers), max(1, MAX_BEAM_TESTS // len(directions))):
        block = offsets[some]
        distance = np.sqrt(dot(block, block))
        voxel, beam = _near_pairs(block, distance, np.full(len(block), BALL), directions)
        enter, leave = cube_crossing(block[voxel], directions[beam])
        through = (enter < leave) & (enter <= ends[beam])
        through &= np.minimum(leave, ends[beam]) >= min_range
        counts[some] = np.bincount(voxel[through], minlength=len(block))
    return with_returns(sensor, counts, centers)


def with_returns(
    sensor: Sensor, counts: NDArray, centers: Floats, objects: Objects | None = None
) -> NDArray:
    """Return the points that counts (V,) of beams are worth at centres (V, 3), if not all return.
    `objects` are what is there; None: voxels."""
    if lidar_of(sensor).returns != ROAD:
        return counts
    return counts * share_of_points(centers - np.asarray(sensor.pose.position), objects)


def _near_pairs(
    offsets: Floats, distance: Floats, balls: Floats, directions: Floats
) -> tuple[Ints, Ints]:
    """Return (thing, beam) pairs (P,) whose beam meets the ball round the thing; no other hits it.
    `offsets` (V, 3) and `distance` (V,) are those of the things' centres from the sensor."""
    safe = np.maximum(distance, balls)
    min_cosine = np.where(distance > balls, np.cos(np.arcsin(balls / safe) + CULL_MARGIN_RAD), -2.0)
    cosine = offsets @ directions.T / safe[:, None]
    thing, beam = np.nonzero(cosine >= min_cosine[:, None])
    return thing, beam


def cube_crossing(offsets: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Return the distances (P,) at which rays from the origin enter and leave unit cubes. `offsets`
    (P, 3) are the cubes' centres, in sides. The first distance is at least 0; it is not below the
    second where the ray misses."""
    components = without_zeros(directions)
    t0 = (offsets - 0.5) / components
    t1 = (offsets + 0.5) / components
    enter = np.minimum(t0, t1)
    leave = np.maximum(t0, t1)
    return np.maximum(enter.max(axis=1), 0.0), leave.min(axis=1)


@dataclass(frozen=True, slots=True)
class BoxHits:
    """Beams that enter boxes, (H,) each: box, beam, and distance at which it enters [m]."""

    box: Ints
    beam: Ints
    enter: Floats


def count_on_objects(
    sensor: Sensor, objects: Objects, vehicle: Vehicle | None, traffic: bool
) -> Floats:
    """Count the beams that end on objects (N,): m of objects. In `traffic` the objects of a scene
    occlude each other."""
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle)
    hits = _box_hits(PlacedBoxes.of(objects, sensor.pose.position), directions, ends)
    lidar = lidar_of(sensor)
    if lidar.returns == ROAD:
        scenes = objects.scenes if traffic else np.arange(len(objects))
        return expected_points((hits.box, hits.beam, hits.enter), objects, scenes, lidar.min_range)
    if traffic:
        hits = first_of_scene(hits, objects.scenes)
    in_range = hits.enter >= lidar.min_range
    return np.bincount(hits.box[in_range], minlength=len(objects)).astype(float)


def count_on_parts(sensor: Sensor, parts: BodyParts, vehicle: Vehicle | None) -> Floats:
    """Count the beams that meet cells of bodies (N,) in the band in which they surely end.

    A beam ends between where it enters the shell round the body and where it enters a box inside
    it. Where both are in one band, the beam counts in every cell of that band that it meets; in
    other bands, which it would enter farther on if the body were hollow, it does not.
    """
    directions = beam_directions(sensor)
    ends = beam_ends(sensor, directions, vehicle)
    hits = _box_hits(PlacedBoxes.of(parts.objects, sensor.pose.position), directions, ends)
    counts = counts_in_bands(hits, parts, lidar_of(sensor).min_range)
    return with_returns(sensor, counts, parts.cells.centers, parts.cells)


def counts_in_bands(hits: BoxHits, parts: BodyParts, min_range: float) -> Floats:
    """Return the number (N,) of the hits of each cell that are in the band of the beam's end.
    Without beams that may end below the minimum range [m]."""
    body, layer, band = (w[hits.box] for w in (parts.objects.scenes, parts.layers, parts.bands))
    order = np.lexsort((hits.box, hits.enter, layer, hits.beam, body))
    body = body[order]
    beam = hits.beam[order]
    layer = layer[order]
    band = band[order]
    enter = hits.enter[order]
    box = hits.box[order]
    is_ray = np.ones(len(order), bool)
    is_layer = np.ones(len(order), bool)
    is_ray[1:] = (beam[1:] != beam[:-1]) | (body[1:] != body[:-1])
    is_layer[1:] = is_ray[1:] | (layer[1:] != layer[:-1])
    ray = np.cumsum(is_ray) - 1
    count = int(is_ray.sum())
    ends = np.full((LAYERS, count), NO_END)  # the band in which the ray enters each layer
    ends[layer[is_layer], ray[is_layer]] = band[is_layer]
    nearest = np.full(count, np.inf)
    np.minimum.at(nearest, ray, enter)
    wanted = parts.has_layer[:, body]
    kept = (layer == CELLS) & (nearest[ray] >= min_range)
    kept &= (~wanted | (ends[:, ray] == band)).all(axis=0)
    return np.bincount(box[kept], minlength=len(parts.cells)).astype(float)


def first_of_scene(hits: BoxHits, scenes: Ints) -> BoxHits:
    """Return the nearest hit of each beam in each scene; of equal hits that of the lowest box."""
    if not len(hits.box):
        return hits
    key = scenes[hits.box].astype(np.int64) * (int(hits.beam.max()) + 1) + hits.beam
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    group = np.repeat(np.arange(len(first)), np.diff(first, append=len(order)))
    enter = hits.enter[order]
    nearest = np.flatnonzero(enter == np.minimum.reduceat(enter, first)[group])
    group = group[nearest]
    box = hits.box[order[nearest]]
    one = np.lexsort((box, group)) if len(box) > len(first) else slice(None)
    kept = order[nearest[one]]
    kept = kept[np.diff(group[one], prepend=-1) > 0]
    return BoxHits(hits.box[kept], hits.beam[kept], hits.enter[kept])


def _box_hits(boxes: PlacedBoxes, directions: Floats, ends: Floats) -> BoxHits:
    """Return all hits of boxes: beams that enter a box before they end at `ends` (B,) [m]."""
    offsets = boxes.in_ground(boxes.offsets)
    parts = []
    distance = np.sqrt(dot(offsets, offsets))
    balls = np.sqrt(dot(boxes.halves, boxes.halves))
    for block in blocks(len(offsets), max(1, MAX_BEAM_TESTS // len(directions))):
        box, beam = _near_pairs(offsets[block], distance[block], balls[block], directions)
        box += block.start
        enter, leave = boxes.crossing(box, directions[beam])
        hit = np.flatnonzero((enter < leave) & (enter <= ends[beam]))
        parts.append((box[hit], beam[hit], enter[hit]))
    return BoxHits(*join_columns(parts))
