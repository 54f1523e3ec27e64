"""Scenes of the golden cases: a box for a vehicle, sensors of few beams, plain scores of rigs."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import pe_core as pe

from . import oracle
from .oracle import Floats

SIDE = 1.0
SPACE = pe.PerceptionSpace((-8.0, 8.0), (-6.0, 6.0), (0.0, 3.0), SIDE)
BODY = ((-2.0, -1.0, 0.0), (2.0, 1.0, 1.0))
"""Corners of the vehicle's box: its faces are faces of voxels."""
FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
PICTURE = (200, 100)
Metres3 = tuple[float, float, float]


def box_triangles(bounds: tuple[Metres3, Metres3]) -> Floats:
    """Return the triangles (12, 3, 3) of an axis-aligned box, from its lowest and highest corner
    [m]."""
    ends = np.array(bounds, dtype=float)
    corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
    return np.array([corners[[f[0], f[i], f[i + 1]]] for f in FACES for i in (1, 2)])


def body() -> pe.Vehicle:
    """Return the vehicle: a box of 4 x 2 x 1 m."""
    return pe.Vehicle(box_triangles(BODY))


def lidar(
    elevations_deg: Sequence[float] = (0.0,),
    azimuths: int = 4,
    max_range: float = 50.0,
    horizontal_fov_deg: tuple[float, float] = (-180.0, 180.0),
    offsets_deg: Sequence[float] | None = None,
) -> pe.Lidar:
    """Return a LiDAR of few beams."""
    offsets = np.zeros(len(elevations_deg)) if offsets_deg is None else np.radians(offsets_deg)
    return pe.Lidar(
        "few beams",
        np.radians(elevations_deg),
        azimuths,
        max_range,
        horizontal_fov=(math.radians(horizontal_fov_deg[0]), math.radians(horizontal_fov_deg[1])),
        azimuth_offsets=offsets,
    )


def camera(hfov_deg: float = 90.0) -> pe.Camera:
    """Return a camera of 200 x 100 pixels; at 90 deg its focal length is 100 pixels."""
    return pe.Camera("200 x 100", *PICTURE, math.radians(hfov_deg))


def mounted(
    model: Any, position: Metres3 = (0.0, 0.0, 0.0), rotation: Metres3 = (0.0, 0.0, 0.0)
) -> pe.Sensor:
    """Return a sensor at a position [m], with roll, pitch and yaw [deg]."""
    name = f"{type(model).__name__} at {position}"
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


def lidar_on_roof(rotation: Metres3 = (0.0, 0.0, 0.0)) -> pe.Sensor:
    """Return a LiDAR of 12 x 90 beams just above the box, off the planes of the grid."""
    return mounted(lidar(tuple(range(-40, 20, 5)), 90, 30.0), (0.43, 0.21, 1.33), rotation)


def second_lidar() -> pe.Sensor:
    """Return a LiDAR at the box's front, lower than the roof."""
    return mounted(lidar((-20.0, -10.0, 0.0, 10.0), 72, 30.0), (2.13, -0.17, 0.68))


def camera_ahead() -> pe.Sensor:
    """Return a camera at the box's front that looks ahead and down."""
    return mounted(camera(), (2.11, 0.07, 0.83), (0.0, 10.0, 0.0))


def rig() -> pe.Rig:
    """Return two LiDARs and a camera on the box."""
    return pe.Rig([lidar_on_roof(), second_lidar(), camera_ahead()])


def points_round(sensor: pe.Sensor, count: int = 60) -> Floats:
    """Return points (N, 3): near a sensor, far from it, and on beams or in the picture."""
    rng = np.random.default_rng(7)
    origin = np.array(sensor.pose.position)
    ahead = sensor.pose.ground_from_sensor[:, 0]
    near = origin + rng.normal(0.0, 0.6, (count, 3))
    far = rng.uniform((-12.0, -12.0, 0.0), (12.0, 12.0, 3.0), (count, 3))
    along = origin + rng.uniform(1.0, 12.0, (count, 1)) * (ahead + rng.normal(0, 0.5, (count, 3)))
    return np.concatenate([near, far, along])


def beam_ends(sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> tuple[Floats, Floats]:
    """Return directions (B, 3) of a LiDAR's beams and where they end (B,) [m], by brute force."""
    model: Any = sensor.model
    steps = np.arange(model.azimuth_count) * math.tau / model.azimuth_count
    low, high = model.horizontal_fov
    if high - low < math.tau - 1e-6:
        wrapped = (steps + math.pi) % math.tau - math.pi
        steps = np.sort(wrapped[(wrapped >= low - 1e-9) & (wrapped <= high + 1e-9)])
    azimuths = steps[None, :] + np.asarray(model.azimuth_offsets)[:, None]
    directions = oracle.beam_directions(model.elevations, azimuths, sensor.pose.rpy)
    ends = np.full(len(directions), model.max_range)
    if vehicle is not None:
        hits, _ = oracle.first_hits(np.array(sensor.pose.position), directions, vehicle.triangles)
        ends = np.minimum(ends, hits)
    return directions, ends


def plain_measure(
    sensor: pe.Sensor, centers: Floats, side: float, vehicle: pe.Vehicle | None
) -> Floats:
    """Return m (N,) of cubes by brute force: beams through them, or pixels that they cover."""
    model: Any = sensor.model
    origin = np.array(sensor.pose.position)
    if sensor.kind == "lidar":
        directions, ends = beam_ends(sensor, vehicle)
        counts = [oracle.count_beams(origin, directions, ends, c, side=side) for c in centers]
        return np.array(counts, dtype=float)
    areas = np.zeros(len(centers))
    for number, center in enumerate(centers):
        areas[number] = oracle.pixel_area(
            PICTURE, model.hfov, origin, sensor.pose.rpy, center, side=side
        )
        if areas[number] and vehicle is not None:
            hidden = oracle.hidden(origin, center, side, np.asarray(vehicle.triangles))
            areas[number] *= not hidden
    return areas


def plain_score(sensors: Sequence[pe.Sensor], literal: bool = False) -> tuple[float, float]:
    """Return entropy [nats] and coverage of sensors on the box in `SPACE`, each voxel as likely:
    equations 4 to 9 voxel by voxel, with floats of Python."""
    low, high = BODY
    total = 0.0
    seen = 0
    count = 0
    axes = [np.arange(SPACE.shape[k]) * SIDE + SPACE.origin[k] + SIDE / 2 for k in range(3)]
    centers = np.array([(x, y, z) for x in axes[0] for y in axes[1] for z in axes[2]])
    own = (centers[:, 0] > low[0]) & (centers[:, 0] < high[0]) & (centers[:, 1] > low[1])
    own &= (centers[:, 1] < high[1]) & (centers[:, 2] < high[2])
    centers = centers[~own]
    measured = [(s.kind, plain_measure(s, centers, SIDE, body())) for s in sensors]
    for number in range(len(centers)):
        beams = sum(m[number] for kind, m in measured if kind == "lidar")
        pixels = [m[number] for kind, m in measured if kind == "camera"]
        groups = [plain_precision(beams, 0.152, 0.659)] if len(pixels) < len(measured) else []
        groups += [plain_precision(m, 0.055, 0.155) for m in pixels]
        blind = (1.0 / 0.001 - 1.0) ** -2
        precision = sum(groups) if literal else blind + sum(p - blind for p in groups)
        total += 1.0 + math.log(math.tau) - math.log(precision)
        seen += beams > 0 or any(m > 0 for m in pixels)
        count += 1
    return total / count, seen / count


def plain_precision(m: float, a: float, b: float) -> float:
    """Return 1 / sigma^2 of a measurement by the curve AP = a ln m + b."""
    ap = 0.001 if m == 0 else min(max(a * math.log(m) + b, 0.001), 0.999)
    return (1.0 / ap - 1.0) ** -2
