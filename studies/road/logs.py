"""Logs of real traffic in the layout of Argoverse 2: boxes with the number of points in each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core import InputError, catalog
from pe_core.base import Floats, Ints
from pe_core.scene.objects import Objects
from pe_tools.exchange import pose_from_quaternion

EGO = "EGO_VEHICLE"
OTHER = "other"
CATEGORIES = {
    "car": "REGULAR_VEHICLE",
    "truck": "LARGE_VEHICLE BOX_TRUCK TRUCK TRUCK_CAB VEHICULAR_TRAILER BUS SCHOOL_BUS "
    "ARTICULATED_BUS",
    "pedestrian": "PEDESTRIAN STROLLER WHEELCHAIR",
    "cyclist": "BICYCLE MOTORCYCLE BICYCLIST MOTORCYCLIST WHEELED_RIDER WHEELED_DEVICE",
    "cone": "CONSTRUCTION_CONE CONSTRUCTION_BARREL",
    "bollard": "BOLLARD",
    "sign": "SIGN STOP_SIGN",
    OTHER: "",
}
"""Categories of each class; all others are of the last one, which only occludes."""
CLASSES = tuple(CATEGORIES)
CLASS_OF = {name: k for k, names in enumerate(CATEGORIES.values()) for name in names.split()}
LIDARS = ("up_lidar", "down_lidar")
MODEL = "Velodyne VLP-32C Ultra Puck"


@dataclass(frozen=True)
class Log:
    """A log: its boxes, all of a frame in one scene, with counted points (N,) and tracks (N,)."""

    name: str
    objects: Objects
    points: Ints
    tracks: Ints

    @property
    def distance(self) -> Floats:
        """Distance (N,) of the centres from the vehicle's origin, seen from above [m]."""
        return np.asarray(np.hypot(*self.objects.centers[:, :2].T))

    def some(self, kept: Ints) -> Log:
        """Return some of the boxes."""
        return Log(self.name, self.objects.some(kept), self.points[kept], self.tracks[kept])

    def every(self, step: int) -> Log:
        """Return each `step`-th frame."""
        return self.some(np.flatnonzero(self.objects.scenes % step == 0))


def read_table(path: Path, columns: str) -> dict[str, NDArray]:
    """Return columns of a feather file; `InputError` where it has not all of them."""
    from pyarrow import feather

    try:
        table = feather.read_table(path, columns=columns.split())
    except (OSError, ValueError) as error:
        raise InputError(path, "columns", columns, str(error)) from error
    return {name: table[name].to_numpy() for name in columns.split()}


def read_logs(folder: Path) -> list[Log]:
    """Return the logs in the folders of a folder, by name; none is an `InputError`."""
    files = sorted(folder.glob("*/annotations*.feather"))
    if not files:
        raise InputError(folder, "folder", "folders with annotations*.feather", "none")
    return [_log(path) for path in files]


def _log(path: Path) -> Log:
    columns = "timestamp_ns track_uuid category num_interior_pts"
    sizes = "length_m width_m height_m"
    places = "tx_m ty_m tz_m"
    data = read_table(path, f"{columns} {sizes} {places} qw qx qy qz")
    kept = np.flatnonzero(data["category"] != EGO)
    data = {name: values[kept] for name, values in data.items()}
    w, x, y, z = (data[f"q{axis}"] for axis in "wxyz")
    yaws = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    objects = Objects(
        np.stack([data[name] for name in places.split()], axis=1),
        np.stack([data[name] for name in sizes.split()], axis=1),
        yaws,
        np.array([CLASS_OF.get(name, len(CLASSES) - 1) for name in data["category"]]),
        class_names=CLASSES,
        scenes=np.unique(data["timestamp_ns"], return_inverse=True)[1],
    )
    tracks = np.unique(data["track_uuid"].astype(str), return_inverse=True)[1]
    return Log(path.parent.name, objects, data["num_interior_pts"].astype(np.int64), tracks)


def read_lidars(folder: Path) -> pe.Rig:
    """Return both LiDARs at the poses of the first calibration in the folders of a folder."""
    files = sorted(folder.glob("*/calibration/egovehicle_SE3_sensor.feather"))
    if not files:
        raise InputError(folder, "folder", "a folder with calibration", "none")
    data = read_table(files[0], "sensor_name qw qx qy qz tx_m ty_m tz_m")
    return pe.Rig([_lidar(name, data) for name in LIDARS])


def _lidar(name: str, data: dict[str, NDArray]) -> pe.Sensor:
    (k,) = np.flatnonzero(data["sensor_name"] == name)
    rotation = [float(data[f"q{axis}"][k]) for axis in "wxyz"]
    place = [float(data[f"t{axis}_m"][k]) for axis in "xyz"]
    return pe.Sensor(name, catalog.load(MODEL), pose_from_quaternion(rotation, place))
