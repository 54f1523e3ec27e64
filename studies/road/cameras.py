"""Boxes that the engine calls hidden from a camera: do the LiDARs beside it see them?"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core.scene.objects import Objects
from pe_core.sensors import ObjectMeasurementCache
from pe_core.sensors.camera import Camera, Pinhole
from pe_tools.exchange import pose_from_quaternion

from ..results_file import Json
from .logs import Log, read_table
from .statistics import tracks_interval

RING = "ring_"
WHOLE = 0.95
"""A box with this share of its pixels is not hidden."""
BLOCK = 16
"""Frames measured together."""


def read_cameras(folder: Path) -> tuple[str, pe.Rig]:
    """Return the first log with a calibration, and its ring cameras as pinholes."""
    path = sorted(folder.glob("*/calibration/egovehicle_SE3_sensor.feather"))[0]
    poses = read_table(path, "sensor_name qw qx qy qz tx_m ty_m tz_m")
    size = "width_px height_px fx_px fy_px cx_px cy_px"
    pictures = read_table(path.with_name("intrinsics.feather"), f"sensor_name {size}")
    where = {name: k for k, name in enumerate(poses["sensor_name"])}
    sensors = []
    for k, name in enumerate(pictures["sensor_name"]):
        if name.startswith(RING):
            width, height, *lens = (float(pictures[key][k]) for key in size.split())
            rotation = [float(poses[f"q{axis}"][where[name]]) for axis in "wxyz"]
            place = [float(poses[f"t{axis}_m"][where[name]]) for axis in "xyz"]
            model = Camera(name, int(width), int(height), lens=Pinhole(*lens))
            pose = pose_from_quaternion(rotation, place, optical=True)
            sensors.append(pe.Sensor(name, model, pose))
    return path.parts[-3], pe.Rig(sensors)


def hidden_and_seen(log: Log, rig: pe.Rig) -> Json:
    """Return of hidden and of whole boxes how many there are, and the share with LiDAR points.

    *Hidden*: some camera has it in its field, and all that do see 0 pixels in traffic. *Whole*: one
    sees at least 95 % of its pixels.
    """
    alone, traffic = (np.zeros((len(rig), len(log.points))) for _ in range(2))
    scenes = log.objects.scenes
    for first in range(0, int(scenes.max()) + 1, BLOCK):
        kept = np.flatnonzero((scenes >= first) & (scenes < first + BLOCK))
        if len(kept):
            some = log.objects.some(kept)
            alone[:, kept], traffic[:, kept] = _pixels(some, rig, False), _pixels(some, rig, True)
    in_field = (alone > 0.0).any(axis=0)
    groups = {
        "hidden": in_field & (traffic == 0.0).all(axis=0),
        "whole": ((traffic >= WHOLE * alone) & (alone > 0.0)).any(axis=0),
    }
    found: Json = {"log": log.name, "cameras": len(rig)}
    for name, flags in groups.items():
        boxes = np.flatnonzero(flags)
        low, high = tracks_interval(lambda n, _: float(np.mean(n > 0)), log, log.points, boxes)
        found[name] = {
            "boxes": len(boxes),
            "tracks": len(np.unique(log.tracks[boxes])),
            "with_points": round(float(np.mean(log.points[boxes] > 0)), 3),
            "interval": [round(low, 3), round(high, 3)],
            "median_points": float(np.median(log.points[boxes])),
        }
    return found


def _pixels(objects: Objects, rig: pe.Rig, traffic: bool) -> np.ndarray:
    measured = ObjectMeasurementCache(objects, None, traffic).measure(rig)
    return np.stack([measured[sensor.name] for sensor in rig])
