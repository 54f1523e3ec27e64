"""KITTI's calibration: cameras' projections, and the LiDAR to the first of them.

There is no vehicle in it: read back, the LiDAR is the origin. All cameras look the same way.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..scene.geometry import Pose
from ..text.values import Number
from .carried import CAMERA, LIDAR, CarriedSensor, cameras, lidars
from .figures import figures
from .files import Written, spaced, text_of
from .frames import (
    BODY_FROM_OPTICAL,
    Floats,
    checked_rotation,
    pose_of,
    product,
    turned,
)
from .pictures import pinhole_picture

FILE, MOST_CAMERAS = "calib.txt", 4
RECTIFIED, TO_CAMERA = ("R0_rect", "R_rect"), ("Tr_velo_to_cam", "Tr_velo_cam", "Tr")
ODOMETRY = "Tr"
"""To the first camera as it is rectified: the benchmark of odometry has no R beside it."""
KEY = re.compile(r"\s*([^\s:]*):?(.*)$")
"""A line's key and its numbers: after a colon, or in the benchmark of tracking a blank."""
PARALLEL = 1e-9
ENTRY = Number(cap=1e9)
"""An entry of a matrix."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return the calibration of a LiDAR and up to four cameras that look the same way.

    Raises
    ------
    InputError
        When there is not one LiDAR, no camera or too many, or cameras look different ways.
    """
    eyes, lidar = cameras(sensors), lidars(sensors)
    if len(lidar) != 1 or not 1 <= len(eyes) <= MOST_CAMERAS:
        found = f"{len(lidar)} LiDARs and {len(eyes)} cameras"
        expected = f"one LiDAR and 1 to {MOST_CAMERAS} cameras: KITTI's file has no room for others"
        raise InputError("kitti", "sensors", expected, found)
    first = product(eyes[0].pose.ground_from_sensor, BODY_FROM_OPTICAL)
    for each in eyes[1:]:
        axes = product(each.pose.ground_from_sensor, BODY_FROM_OPTICAL)
        if np.abs(axes - first).max() > PARALLEL:
            expected = f"a camera that looks as {eyes[0].name!r} does, as KITTI's do"
            raise InputError(f"sensor {each.name!r}", "rotation", expected, each.pose.rotation_deg)
    rows = {f"P{k}": _projection(each, eyes[0], first) for k, each in enumerate(eyes)}
    rows[RECTIFIED[0]] = np.eye(3)
    rows[TO_CAMERA[0]] = _to_camera(lidar[0], eyes[0], first)
    text = "".join(f"{key}: {spaced(matrix.ravel().tolist())}\n" for key, matrix in rows.items())
    names = ", ".join(f"P{k} {each.name}" for k, each in enumerate(eyes))
    lines = [f"KITTI's file has no vehicle: poses are to {lidar[0].name}; {names}"]
    return {FILE: text.encode()}, lines


def _projection(each: CarriedSensor, first: CarriedSensor, axes: Floats) -> Floats:
    """Return P of a camera: K [I | -t], t from the first camera in its optical frame."""
    p = each.picture or pinhole_picture(1.0, 1.0, 0.0, 0.0)
    cx, cy = p.center
    apart = [a - b for a, b in zip(each.pose.position, first.pose.position, strict=True)]
    x, y, z = turned(axes.T, apart)
    return np.array(
        [
            [p.fx, 0.0, cx, -(p.fx * x + cx * z)],
            [0.0, p.fy, cy, -(p.fy * y + cy * z)],
            [0.0, 0.0, 1.0, -z],
        ]
    )


def _to_camera(lidar: CarriedSensor, camera: CarriedSensor, axes: Floats) -> Floats:
    """Return the first camera's optical frame from the LiDAR's."""
    rotation = product(axes.T, lidar.pose.ground_from_sensor)
    apart = [a - b for a, b in zip(lidar.pose.position, camera.pose.position, strict=True)]
    return np.hstack([rotation, np.array(turned(axes.T, apart))[:, None]])


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the LiDAR, at the origin, and the cameras round it."""
    rows = _rows(path)
    is_odometry = ODOMETRY in rows and not any(key in rows for key in RECTIFIED)
    rectified = np.eye(3) if is_odometry else _matrix(path, rows, RECTIFIED, (3, 3))
    to_camera = _matrix(path, rows, TO_CAMERA, (3, 4))
    rotation = checked_rotation(path, TO_CAMERA[0], product(rectified, to_camera[:, :3]))
    shift = turned(rectified, to_camera[:, 3].tolist())
    found = [CarriedSensor("velodyne", Pose((0.0, 0.0, 0.0)), LIDAR)]
    for key in sorted(key for key in rows if key[:1] == "P" and key[1:].isdigit()):
        p = _matrix(path, rows, (key,), (3, 4))
        fx, fy, cx, cy = (float(p[k]) for k in ((0, 0), (1, 1), (0, 2), (1, 2)))
        if fx <= 0.0 or fy <= 0.0:
            raise InputError(path, key, "focal lengths above 0", f"{fx:g}, {fy:g}")
        z = -float(p[2, 3])
        place = (-(float(p[0, 3]) + cx * z) / fx, -(float(p[1, 3]) + cy * z) / fy, z)
        apart = [a - b for a, b in zip(place, shift, strict=True)]
        pose = pose_of(product(rotation.T, BODY_FROM_OPTICAL.T), turned(rotation.T, apart))
        picture = pinhole_picture(fx, fy, cx, cy)
        found.append(CarriedSensor(f"camera_{key[1:]}", pose, CAMERA, None, picture))
    return tuple(found)


def _rows(path: Path) -> dict[str, list[float]]:
    rows = {}
    for number, line in enumerate(text_of(path).splitlines()):
        key, values = KEY.match(line).groups()  # type: ignore[union-attr]
        if key and values.strip() and key != "calib_time":
            rows[key] = figures(path, f"line {number + 1}, {key}", values, None, ENTRY)
    return rows


def _matrix(
    path: Path, rows: dict[str, list[float]], keys: tuple[str, ...], shape: tuple[int, int]
) -> Floats:
    key = next((each for each in keys if each in rows), None)
    if key is None:
        raise InputError(path, keys[0], f"{shape[0]} x {shape[1]} numbers", "nothing")
    if len(rows[key]) != shape[0] * shape[1]:
        raise InputError(path, key, f"{shape[0] * shape[1]} numbers", len(rows[key]))
    return np.array(rows[key]).reshape(shape)
