"""KITTI's calibration: projection matrices, and the transform from the LiDAR to the first camera.
The file does not locate the vehicle; an imported LiDAR is at the origin. All cameras have the same
orientation."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.errors import InputError
from pe_core.base.values import Number
from pe_core.geometry.poses import Pose
from pe_core.sensors.camera import Pinhole

from .foreign_values import Export, figures, spaced, text_of
from .frames import BODY_FROM_OPTICAL, checked_rotation, pose_of, product, turned
from .lens_pictures import Picture, pinhole_of
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor
from .portable_kinds import CAMERA, LIDAR

FILE = "calib.txt"
MAX_CAMERAS = 4
RECTIFIED = ("R0_rect", "R_rect")
TO_CAMERA = ("Tr_velo_to_cam", "Tr_velo_cam", "Tr")
ODOMETRY = "Tr"
"""Key of the transform to the rectified first camera; odometry files have no R_rect beside it."""
KEY = re.compile(r"\s*([^\s:]*):?(.*)$")
"""A key and its numbers, separated by a colon, or by a blank in files of the tracking benchmark."""
PARALLEL = 1e-9
ENTRY = Number(cap=1e9)  # An entry of a matrix


def write(sensors: PortableRig, _into: MergeTarget | None) -> Export:
    """Return the calibration of one LiDAR and up to four cameras, and a message. Another number of
    LiDARs or cameras, or orientations that differ, raise `InputError`."""
    rig_cameras, rig_lidars = ([s for s in sensors if s.kind == kind] for kind in (CAMERA, LIDAR))
    if len(rig_lidars) != 1 or not 1 <= len(rig_cameras) <= MAX_CAMERAS:
        found = f"{len(rig_lidars)} LiDARs and {len(rig_cameras)} cameras"
        expected = f"one LiDAR and 1 to {MAX_CAMERAS} cameras: KITTI's file has no room for others"
        raise InputError("kitti", "sensors", expected, found)
    first = product(rig_cameras[0].pose.ground_from_sensor, BODY_FROM_OPTICAL)
    for sensor in rig_cameras[1:]:
        axes = product(sensor.pose.ground_from_sensor, BODY_FROM_OPTICAL)
        if np.abs(axes - first).max() > PARALLEL:
            expected = f"a camera that looks as {rig_cameras[0].name!r} does, as KITTI's do"
            turn = sensor.pose.rotation_deg
            raise InputError(f"sensor {sensor.name!r}", "rotation", expected, turn)
    origin = rig_cameras[0].pose.position
    rows = {f"P{k}": _projection(sensor, origin, first) for k, sensor in enumerate(rig_cameras)}
    rows[RECTIFIED[0]] = np.eye(3)
    lidar = rig_lidars[0].pose
    shift = _seen(first, origin, lidar.position)
    rotation = product(first.T, lidar.ground_from_sensor)
    rows[TO_CAMERA[0]] = np.hstack([rotation, np.array(shift)[:, None]])
    text = "".join(f"{key}: {spaced(matrix.ravel().tolist())}\n" for key, matrix in rows.items())
    names = ", ".join(f"P{k} {sensor.name}" for k, sensor in enumerate(rig_cameras))
    lines = [f"KITTI's file has no vehicle: poses are to {rig_lidars[0].name}; {names}"]
    return {FILE: text.encode()}, lines


def _seen(axes: Floats, origin: Sequence[float], position: Sequence[float]) -> tuple[float, ...]:
    """Return a position in the frame with these axes and origin [m]."""
    return turned(axes.T, [a - b for a, b in zip(position, origin, strict=True)])


def _projection(sensor: PortableSensor, origin: Sequence[float], axes: Floats) -> Floats:
    """Return P = K [I | -t], (3, 4); t is the position in the first camera's optical frame [m]."""
    p = sensor.picture or Picture(Pinhole(1.0, 1.0, 0.0, 0.0))
    cx, cy = p.center
    x, y, z = _seen(axes, origin, sensor.pose.position)
    return np.array(
        [
            [p.fx, 0.0, cx, -(p.fx * x + cx * z)],
            [0.0, p.fy, cy, -(p.fy * y + cy * z)],
            [0.0, 0.0, 1.0, -z],
        ]
    )


def read(path: Path) -> ForeignRig:
    """Read the LiDAR, which is the origin, and the cameras."""
    rows = _rows(path)
    is_odometry = ODOMETRY in rows and not any(key in rows for key in RECTIFIED)
    rectified = np.eye(3) if is_odometry else _matrix(path, rows, RECTIFIED, (3, 3))
    to_camera = _matrix(path, rows, TO_CAMERA, (3, 4))
    rotation = checked_rotation(path, TO_CAMERA[0], product(rectified, to_camera[:, :3]))
    shift = turned(rectified, to_camera[:, 3].tolist())
    sensors = [PortableSensor("velodyne", Pose((0.0, 0.0, 0.0)), LIDAR)]
    empty = []
    for key in sorted(key for key in rows if key[:1] == "P" and key[1:].isdigit()):
        p = _matrix(path, rows, (key,), (3, 4))
        if not p.any():  # a data set in KITTI's form that has fewer cameras
            empty.append(key)
            continue
        lens, note = pinhole_of(path, key, p[:, :3])
        z = -float(p[2, 3])
        y = -(float(p[1, 3]) + lens.cy * z) / lens.fy
        x = -(float(p[0, 3]) + float(p[0, 1]) * y + lens.cx * z) / lens.fx
        position = x, y, z
        offset = [a - b for a, b in zip(position, shift, strict=True)]
        pose = pose_of(product(rotation.T, BODY_FROM_OPTICAL.T), turned(rotation.T, offset))
        name = f"camera_{key[1:]}"
        sensors.append(
            PortableSensor(name, pose, CAMERA, model=None, picture=Picture(lens), told=note)
        )
    lines = [f"{', '.join(empty)}: all numbers are 0; no such camera is read"] if empty else []
    return ForeignRig(tuple(sensors), lines)


def _rows(path: Path) -> dict[str, list[float]]:
    rows = {}
    for number, line in enumerate(text_of(path).splitlines()):
        key, values = KEY.match(line).groups()  # type: ignore[union-attr]
        if key and values.strip() and key != "calib_time":
            rows[key] = figures(path, f"line {number + 1}, {key}", values, count=None, rule=ENTRY)
    return rows


def _matrix(
    path: Path, rows: dict[str, list[float]], keys: tuple[str, ...], shape: tuple[int, int]
) -> Floats:
    key = next((name for name in keys if name in rows), None)
    if key is None:
        raise InputError(path, keys[0], f"{shape[0]} x {shape[1]} numbers", "nothing")
    if len(rows[key]) != shape[0] * shape[1]:
        raise InputError(path, key, f"{shape[0] * shape[1]} numbers", len(rows[key]))
    return np.array(rows[key]).reshape(shape)
