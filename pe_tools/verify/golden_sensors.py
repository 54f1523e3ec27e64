"""Golden cases of what sensors measure: beams, pixels, detections, and what occludes them."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import pe_core as pe
from pe_core.sensors import radar

from . import golden_scenes as scenes
from .golden_case import BY_HAND, ORACLE, GoldenCase
from .oracle import Floats, first_hits
from .radar_oracle import expected_detections

SIDE = 0.1
ROOT3 = math.sqrt(0.75)
PIXEL_SLACK = 1e-6
"""Largest difference of two pixel areas by different formulas, relative to 1 + area [px]."""
RADAR_SLACK = 0.02
"""Largest difference of expected detections m, relative to 1 + m: the oracle integrates over a
raster of 90 x 90 rays."""
MODE = {
    "name": "scan",
    "azimuth_deg": [-50, 0, 50],
    "range_m": [40, 100, 60],
    "elevation_deg": [-15, 0, 15],
    "elevation_scale": [0.5, 1.0, 0.6],
    "range_resolution_m": 0.5,
    "azimuth_resolution_deg": 2.0,
    "elevation_resolution_deg": 4.0,
    "min_range_m": 1.0,
}
RADAR = {"kind": "radar", "mode": [MODE], "list_length": 400}
ULTRASONIC = {"kind": "ultrasonic", "hfov_deg": 60, "vfov_deg": 30, "max_range_m": 2.0}
WALL = ((4.0, -3.0, 0.0), (4.1, 3.0, 3.0))
"""A wall 4 m ahead, as a body that occludes."""


def lidar_cases() -> Sequence[GoldenCase]:
    """Return the cases of LiDARs."""
    ahead = scenes.mounted(scenes.lidar(azimuths=1))
    short = scenes.mounted(scenes.lidar(azimuths=1, max_range=5.0))
    limited = scenes.lidar((-20.0, 0.0), 90, horizontal_fov_deg=(-60.0, 45.0))
    offset = scenes.lidar((-15.0, -5.0, 5.0), 60, offsets_deg=(-2.0, 0.0, 3.0))
    area = "LiDAR"
    return (
        _hand(
            area,
            "directions of beams",
            "two azimuths at 0 and 30 deg up: (cos e cos a, cos e sin a, sin e)",
            [1, 0, 0, -1, 0, 0, ROOT3, 0, 0.5, -ROOT3, 0, 0.5],
            found=lambda: _floats(scenes.lidar((0.0, 30.0), 2).directions),
        ),
        _hand(
            area,
            "a beam passes the cubes on its way",
            "one beam along x: cubes at 5.5 m and 9.5 m, not that 1 m aside",
            [1, 1, 0],
            found=lambda: _floats(
                pe.measure(ahead, [[5.5, 0, 0], [9.5, 0, 0], [5.5, 1.01, 0]], 1.0)
            ),
        ),
        _hand(
            area,
            "a cube owns its lower faces",
            "a beam along the face between two cubes belongs to the upper one alone",
            [1, 0],
            found=lambda: _floats(pe.measure(ahead, [[5.5, 0.5, 0], [5.5, -0.5, 0]], 1.0)),
        ),
        _hand(
            area,
            "range",
            "5 m: the cube that begins at 4.9 m counts, that at 5.1 m does not",
            [1, 0],
            found=lambda: _floats(pe.measure(short, [[5.4, 0, 0], [5.6, 0, 0]], 1.0)),
        ),
        _hand(
            area,
            "the paper's Pandar64",
            "Table I: 64 channels, 1,800 azimuths, 15 to -25 deg",
            [115_200, 15.0, -25.0],
            found=_pandar64,
        ),
        _counts("beams of an upright LiDAR", scenes.lidar_on_roof(), None),
        _counts("beams of a tilted LiDAR", scenes.lidar_on_roof((8.0, 14.0, 33.0)), None),
        _counts("beams within a field of view", scenes.mounted(limited, (0.3, 0.1, 1.8)), None),
        _counts("azimuth offsets of channels", scenes.mounted(offset, (0.3, 0.1, 1.8)), None),
        _counts("beams past the vehicle", scenes.lidar_on_roof((0.0, 6.0, 10.0)), scenes.body()),
    )


def camera_cases() -> Sequence[GoldenCase]:
    """Return the cases of cameras."""
    level = scenes.mounted(scenes.camera())
    turned = scenes.mounted(scenes.camera(70.0), (0.2, -0.1, 1.6), (3.0, 8.0, -25.0))
    area = "camera"
    return (
        _hand(
            area,
            "pixels of a cube ahead",
            "focal length 100 px: a face of 1 m at 10 m is 10 x 10 px",
            [100.0],
            found=lambda: _floats(pe.measure(level, [[10.5, 0, 0]], 1.0)),
            tolerance=PIXEL_SLACK,
        ),
        _hand(
            area,
            "pixels of a cube at the picture's edge",
            "its near face is in the picture from 95 to 100 px, 10 px high; its side from there to "
            "9.5 / 11 of 100 px, where it is 100 / 11 px high",
            [50.0 + (95.0 - 950.0 / 11.0) * (10.0 + 100.0 / 11.0) / 2.0],
            found=lambda: _floats(pe.measure(level, [[10.5, 10.0, 0.0]], 1.0)),
            tolerance=PIXEL_SLACK,
        ),
        _hand(
            area,
            "pixels of a cube behind",
            "none",
            [0.0],
            found=lambda: _floats(pe.measure(level, [[-10.5, 0, 0]], 1.0)),
        ),
        _areas("pixel areas of cubes all round", turned, None),
        _areas("pixel areas past the vehicle", scenes.camera_ahead(), scenes.body()),
        _hand(
            area,
            "a distorted lens",
            "k1 = 0.5: a tangent r = 0.5 is drawn at r (1 + k1 r^2) = 0.5625 focal lengths",
            [0.5625, 0.0],
            found=_distorted,
        ),
    )


def occlusion_cases() -> Sequence[GoldenCase]:
    """Return the cases of what hides what."""
    area = "occlusion"
    wall = pe.Vehicle(scenes.box_triangles(WALL))
    level = scenes.mounted(scenes.lidar(azimuths=4), (0.0, 0.0, 1.0))
    camera = scenes.mounted(scenes.camera(), (0.0, 0.0, 1.0))
    beyond = [[6.0, 0.0, 1.0], [3.0, 0.0, 1.0]]
    return (
        _hand(
            area,
            "where beams end",
            "ahead on the wall at 4 m; to the left, behind and to the right at the range of 50 m",
            [4.0, 50.0, 50.0, 50.0],
            found=lambda: _floats(pe.beam_field(level, wall).ends),
        ),
        _hand(
            area,
            "a LiDAR sees nothing beyond a wall",
            "the cube at 6 m is hidden, that at 3 m is not",
            [0, 1],
            found=lambda: _floats(pe.measure(level, beyond, 0.5, wall)),
        ),
        _hand(
            area,
            "a camera sees nothing beyond a wall",
            "the cube at 6 m is hidden; the face at 2.75 m of that at 3 m is (50 / 2.75)^2 px",
            [0.0, (50.0 / 2.75) ** 2],
            found=lambda: _floats(pe.measure(camera, beyond, 0.5, wall)),
            tolerance=PIXEL_SLACK,
        ),
        _hand(
            area,
            "glass hides nothing from a camera",
            "the same wall of glass",
            [1.0],
            found=lambda: [float(pe.measure(camera, beyond, 0.5, _glass_wall())[0] > 0.0)],
        ),
        GoldenCase(
            "first hits of rays",
            area,
            ORACLE,
            "300 rays in all directions on a box: each ray against each triangle",
            right=lambda: _floats(np.minimum(first_hits(*_rays(), _triangles())[0], 99.0)),
            found=lambda: _floats(
                np.minimum(scenes.body().first_hit(tuple(_rays()[0]), _rays()[1]).distance, 99.0)
            ),
            tolerance=1e-9,
        ),
        GoldenCase(
            "beams that end on the vehicle",
            area,
            ORACLE,
            "of a whole score: beams of the LiDAR on the roof, and how many the box stops",
            right=_plain_occluded,
            found=_occluded,
            tolerance=0.0,
        ),
    )


def echo_cases() -> Sequence[GoldenCase]:
    """Return the cases of radars and ultrasonic sensors."""
    own = pe.catalog.from_table("own", RADAR)
    heard = scenes.mounted(pe.catalog.from_table("own", ULTRASONIC), (2.4, 0.0, 0.5))
    front = pe.Sensor("front", own, pe.Pose.from_degrees((2.6, 0.1, 0.55), (0, 0, 0)))
    return (
        _hand(
            "radar",
            "probability of detection",
            "Swerling 1: Pfa^(1 / (1 + SNR)) = 1e-6^(1 / 6) = 0.1",
            [0.1],
            found=lambda: _floats(radar.detection_probability([5.0], 1e-6)),
        ),
        _hand(
            "radar",
            "the radar equation",
            "twice the distance: a 16th of the SNR; a 16th of the cross section likewise",
            [1.0 / 16.0, 1.0],
            found=_radar_equation,
        ),
        GoldenCase(
            "expected detections of objects",
            "radar",
            ORACLE,
            "cars, pedestrians and trucks within its field: ray by ray in decibels",
            right=lambda: _relative(expected_detections(RADAR, front.pose, _objects())),
            found=lambda: _relative(pe.measure_objects(front, _objects())),
            tolerance=RADAR_SLACK,
        ),
        _hand(
            "ultrasonic",
            "echoes of posts",
            "1 m ahead; beyond 2 m; behind; 34 deg aside of a cone of 30",
            [1, 0, 0, 0],
            found=lambda: [
                float(pe.measure_objects(heard, _post(x, y))[0])
                for x, y in ((3.4, 0.0), (4.56, 0.0), (1.4, 0.0), (3.4, 0.72))
            ],
        ),
    )


def _hand(
    area: str,
    name: str,
    about: str,
    right: Sequence[float],
    found: Callable[[], Sequence[float]],
    tolerance: float = 1e-9,
) -> GoldenCase:
    return GoldenCase(name, area, BY_HAND, about, right=right, found=found, tolerance=tolerance)


def _floats(values: object) -> list[float]:
    return [float(value) for value in np.ravel(np.asarray(values, dtype=float))]


def _counts(name: str, sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> GoldenCase:
    """Return the case of a LiDAR's counts in cubes of 0.1 m."""
    centers = scenes.points_round(sensor)
    return GoldenCase(
        name,
        "LiDAR",
        ORACLE,
        "counts in 180 cubes: each beam clipped against each cube",
        right=lambda: _floats(scenes.plain_measure(sensor, centers, SIDE, vehicle)),
        found=lambda: _floats(pe.measure(sensor, centers, SIDE, vehicle)),
        tolerance=0.0,
    )


def _areas(name: str, sensor: pe.Sensor, vehicle: pe.Vehicle | None) -> GoldenCase:
    """Return the case of a camera's pixel areas of cubes of 0.1 m."""
    centers = scenes.points_round(sensor)
    return GoldenCase(
        name,
        "camera",
        ORACLE,
        "180 cubes: the hull of eight projected corners, clipped to the picture",
        right=lambda: _relative(scenes.plain_measure(sensor, centers, SIDE, vehicle)),
        found=lambda: _relative(pe.measure(sensor, centers, SIDE, vehicle)),
        tolerance=PIXEL_SLACK,
    )


def _relative(measured: object) -> list[float]:
    """Return ln(1 + m): differences of it are relative to 1 + m."""
    return _floats(np.log1p(np.asarray(measured, dtype=float)))


def _pandar64() -> list[float]:
    model: Any = pe.catalog.load("Pandar64")
    return [model.beam_count, *np.degrees([max(model.elevations), min(model.elevations)]).tolist()]


def _distorted() -> list[float]:
    """Return where a lens draws a point half as far to the right as ahead, in focal lengths."""
    lens = pe.BrownConrady(fx=1.0, fy=1.0, cx=0.0, cy=0.0, k1=0.5)
    right, down = lens.project(np.array([1.0]), np.array([-0.5]), np.array([0.0]))
    return [float(right[0]), float(down[0])]


def _glass_wall() -> pe.Vehicle:
    triangles = scenes.box_triangles(WALL)
    parts = np.zeros(len(triangles), dtype=np.int32)
    return pe.Vehicle(triangles, parts, ("wall",), glass=("wall",))


def _triangles() -> Floats:
    return scenes.box_triangles(scenes.BODY)


def _rays() -> tuple[Floats, Floats]:
    """Return an origin (3,) above the box, and unit directions (300, 3) all round."""
    directions = np.random.default_rng(3).normal(size=(300, 3))
    directions /= np.sqrt((directions**2).sum(axis=1))[:, None]
    return np.array([0.31, -0.17, 1.9]), directions


def _plain_occluded() -> list[float]:
    sensor = scenes.lidar_on_roof()
    model: Any = sensor.model
    _, ends = scenes.beam_ends(sensor, scenes.body())
    return [len(ends), int((ends < model.max_range).sum())]


def _occluded() -> list[float]:
    rig = pe.Rig([scenes.lidar_on_roof()])
    score = pe.Evaluator(scenes.SPACE, pe.Prior.uniform(), scenes.body()).score(rig)
    (own,) = score.per_sensor.values()
    return [own.beams, own.occluded]


def _radar_equation() -> list[float]:
    def snr(rcs: float, distance: float) -> float:
        return float(radar.signal_to_noise(rcs, distance, 100.0, (10.0, 20.0)))

    whole = snr(16.0, 40.0)
    return [snr(16.0, 80.0) / whole, snr(1.0, 20.0) / whole]


def _objects() -> pe.Objects:
    sizes = [(4.6, 1.9, 1.7), (0.8, 0.7, 1.75), (7.5, 2.55, 3.0), (4.6, 1.9, 1.7)]
    places = [(30.0, 4.0), (14.0, -3.0), (45.0, -12.0), (9.0, 9.0)]
    centers = [(x, y, size[2] / 2.0) for (x, y), size in zip(places, sizes, strict=True)]
    names = ("car", "pedestrian", "truck")
    yaws = np.array([0.3, 1.0, -0.2, 2.0])
    labels = np.array([0, 1, 2, 0])
    return pe.Objects(np.array(centers), np.array(sizes), yaws, labels, class_names=names)


def _post(x: float, y: float) -> pe.Objects:
    center = np.array([[x, y, 0.5]])
    size = np.array([[0.1, 0.1, 1.0]])
    return pe.Objects(center, size, np.zeros(1), np.zeros(1, dtype=int), class_names=("post",))
