"""The formats that rigs go out in and come back from, a row a format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from ..errors import InputError, shown
from . import (
    argoverse2,
    autoware,
    autoware_kit,
    carla,
    csv_table,
    driveworks,
    kitti,
    nuscenes,
    osi,
    ros_transforms,
    urdf,
)
from .carried import CarriedSensor
from .files import Written
from .frames import GROUND, REAR_AXLE, REAR_AXLE_GROUND
from .losses import BEAMS, FUSION, MAX_RANGE, MIN_RANGE, MODEL
from .pictures import (
    KeptPicture,
    Size,
    centred,
    f_theta_of_five,
    opencv,
    opencv_of_five,
    square,
    straight,
    whole,
)

Carried = tuple[CarriedSensor, ...]
FileTexts = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class RigFormat:
    """A format of rigs.

    Attributes
    ----------
    name, title : str
        What commands and what people call it.
    origin : str
        Where its frame is on the vehicle: `GROUND` is ours.
    files : tuple of str
        Names of what is written; where there are several, the first one tells the format.
    write : callable
        Sensors in the format's frame to bytes by file name, and lines on what it cannot say.
    read : callable
        A path to sensors in the format's frame.
    settled : callable
        A sensor as it is once its model is known.
    keeps : callable
        What it keeps of a camera's picture.
    holds : frozenset of str
        What it holds of sensors besides poses and lenses, in the words of `losses`.
    usual_size : (int, int) or None
        Of a picture where the format says no size: that of the data set it is of [px].
    beside : bool
        Whether files stand beside the one: lenses of cameras.
    write_over : callable, optional
        As `write`, into texts that were there: it keeps what is not ours.
    source : callable
        The texts that `write_over` takes, by file name, of a path that was read.
    passes_through : bool
        Whether sensors of other kinds that came in go out again.
    """

    name: str
    title: str
    origin: str
    files: tuple[str, ...]
    write: Callable[[Carried], tuple[Written, list[str]]]
    read: Callable[[Path], Carried]
    settled: Callable[[CarriedSensor], CarriedSensor] = lambda each: each
    keeps: KeptPicture = whole
    holds: frozenset[str] = frozenset()
    usual_size: Size | None = None
    beside: bool = False
    write_over: Callable[[FileTexts, Carried], tuple[Written, list[str]]] | None = None
    source: Callable[[Path], FileTexts] = lambda path: {}
    passes_through: bool = False


_ROWS = (
    RigFormat(
        "csv",
        "table (CSV)",
        GROUND,
        (csv_table.FILE,),
        csv_table.write,
        csv_table.read,
        passes_through=True,
        holds=frozenset({MODEL, FUSION, MIN_RANGE, MAX_RANGE}),
    ),
    RigFormat(
        "urdf",
        "URDF",
        GROUND,
        (urdf.FILE,),
        urdf.write,
        urdf.read,
        keeps=opencv_of_five,
        holds=frozenset({MODEL, BEAMS, FUSION, MIN_RANGE, MAX_RANGE}),
        write_over=urdf.write_over,
        source=urdf.source,
        passes_through=True,
    ),
    RigFormat(
        "ros",
        "ROS 2 static transforms",
        GROUND,
        (ros_transforms.FILE,),
        ros_transforms.write,
        ros_transforms.read,
        keeps=opencv,
        beside=True,
        write_over=ros_transforms.write_over,
        source=ros_transforms.source,
        passes_through=True,
    ),
    RigFormat(
        "autoware",
        "Autoware sensor kit",
        REAR_AXLE_GROUND,
        (autoware.IN_KIT, autoware.TO_KIT),
        autoware.write,
        autoware.read,
        autoware.lifted,
        keeps=opencv,
        beside=True,
        write_over=autoware_kit.write_over,
        source=autoware_kit.source,
        passes_through=True,
    ),
    RigFormat(
        "nuscenes",
        "nuScenes",
        REAR_AXLE_GROUND,
        (nuscenes.CALIBRATED, nuscenes.SENSORS),
        nuscenes.write,
        nuscenes.read,
        keeps=opencv_of_five,
        passes_through=True,
        usual_size=(1600, 900),
    ),
    RigFormat(
        "argoverse2",
        argoverse2.TITLE,
        REAR_AXLE,
        (argoverse2.POSES, argoverse2.INTRINSICS),
        argoverse2.write,
        argoverse2.read,
        keeps=straight,
    ),
    RigFormat(
        "carla",
        "CARLA objects.json",
        GROUND,
        (carla.FILE,),
        carla.write,
        carla.read,
        keeps=square,
        write_over=carla.write_over,
        source=carla.source,
        passes_through=True,
        holds=frozenset({BEAMS}),
    ),
    RigFormat(
        "kitti",
        "KITTI calibration",
        GROUND,
        (kitti.FILE,),
        kitti.write,
        kitti.read,
        keeps=straight,
        usual_size=(1242, 375),
    ),
    RigFormat(
        "osi",
        "ASAM OSI mounting positions",
        REAR_AXLE,
        (osi.FILE,),
        osi.write,
        osi.read,
        keeps=centred,
        passes_through=True,
        holds=frozenset({BEAMS}),
    ),
    RigFormat(
        "driveworks",
        "DriveWorks rig.json",
        REAR_AXLE_GROUND,
        (driveworks.FILE,),
        driveworks.write,
        driveworks.read,
        keeps=f_theta_of_five,
        write_over=driveworks.write_over,
        source=driveworks.source,
        passes_through=True,
        holds=frozenset({MODEL}),
    ),
)
RIG_FORMATS = MappingProxyType({row.name: row for row in _ROWS})
"""Formats by name."""


def rig_format(name: str) -> RigFormat:
    """Return the format of that name, or raise `InputError`."""
    if name not in RIG_FORMATS:
        raise InputError("exchange", "format", f"one of {', '.join(RIG_FORMATS)}", shown(name))
    return RIG_FORMATS[name]


def told_format(path: Path) -> RigFormat:
    """Return the format that a file's or a folder's names tell, or raise `InputError`."""
    names = {each.name for each in path.iterdir()} if path.is_dir() else {path.name}
    for row in RIG_FORMATS.values():
        if names & set(row.files):
            return row
    ending = {".csv": "csv", ".urdf": "urdf", ".xacro": "urdf", ".sh": "ros", ".xml": "ros"}
    ending[".txt"] = "kitti"
    if path.suffix.lower() in ending:
        return RIG_FORMATS[ending[path.suffix.lower()]]
    expected = f"a name that tells its format, or the format said: {', '.join(RIG_FORMATS)}"
    raise InputError(path, "format", expected, path.name)
