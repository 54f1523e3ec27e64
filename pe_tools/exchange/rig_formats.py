"""Registry of the rig formats for import and export, one row per format."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from pe_core.base.errors import InputError, shown

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
from .foreign_values import Written
from .frames import GROUND, REAR_AXLE, REAR_AXLE_GROUND
from .lens_pictures import (
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
from .losses import BEAMS, FUSION, MAX_RANGE, MIN_RANGE, MODEL, PARAMETERS
from .portable import PortableSensor

Carried = tuple[PortableSensor, ...]
FileTexts = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class RigFormat:
    """A format of rigs.

    Attributes
    ----------
    name, title : str
        Name in commands, and title in messages.
    origin : str
        Origin of its frame on the vehicle; `GROUND` is the origin of the ground frame.
    files : tuple of str
        Names of the written files; the first one identifies the format.
    write : callable
        Function of sensors in the format's frame; returns bytes by file name, and messages.
    read : callable
        Function of a path; returns sensors in the format's frame.
    settled : callable
        Function that adjusts a sensor once its model is known.
    keeps : callable
        Function that reduces a camera's intrinsics to what the format can express.
    holds : frozenset of str
        Properties that it holds besides poses and lenses, from `losses`.
    usual_size : (int, int) or None
        Image size of the format's data set [px], for a format that states no size.
    beside : bool
        Whether files with camera intrinsics are beside the main file.
    write_over : callable, optional
        As `write`, but updates existing texts and keeps their other content.
    source : callable
        Function of an imported path; returns the texts for `write_over` by file name.
    passes_through : bool
        Whether an export restores imported sensors of unknown kinds.
    """

    name: str
    title: str
    origin: str
    files: tuple[str, ...]
    write: Callable[[Carried], tuple[Written, list[str]]]
    read: Callable[[Path], Carried]
    settled: Callable[[PortableSensor], PortableSensor] = lambda each: each
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
        holds=frozenset({MODEL, PARAMETERS, FUSION, MIN_RANGE, MAX_RANGE}),
    ),
    RigFormat(
        "urdf",
        "URDF",
        GROUND,
        (urdf.FILE,),
        urdf.write,
        urdf.read,
        keeps=opencv_of_five,
        holds=frozenset({MODEL, BEAMS, PARAMETERS, FUSION, MIN_RANGE, MAX_RANGE}),
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


def format_of_file(output: Path, files: Mapping[str, str], chosen: str | None = None) -> str:
    """Return the format that a file to be written has: the suffix of its name decides.

    Parameters
    ----------
    output : Path
        File or folder to write.
    files : mapping of str to str
        The usual name of the file of each format that has one file, by the format's name.
    chosen : str, optional
        Name of the format that was asked for; it may be one that has a folder of files.

    Raises
    ------
    InputError
        When the suffix is that of another format than `chosen`, or names no single format; when
        the name has none and the format is one file.
    """
    suffix = output.suffix.lower()
    fitting = [name for name, file in files.items() if Path(file).suffix == suffix]
    if chosen is not None:
        if suffix and fitting and chosen not in fitting:
            found = f"{suffix}, the suffix of {' or '.join(fitting)}"
            raise InputError(output, "format", f"a name for {chosen}", found)
        if chosen in files and not suffix:
            expected = f"a name for {chosen}, such as {files[chosen]}"
            raise InputError(output, "format", expected, "no suffix")
        return chosen
    fitting = [name for name, file in files.items() if file == output.name] or fitting
    if len(fitting) != 1:
        known = ", ".join(fitting) if suffix and fitting else f"one of {', '.join(files)}"
        expected = f"the name of a format ({known}), or a suffix that only one has"
        raise InputError(output, "format", expected, suffix or "no suffix")
    return fitting[0]


FILES = MappingProxyType({row.name: row.files[0] for row in _ROWS if len(row.files) == 1})
"""Usual name of the file by format, of the formats that have one."""


def detect_format(path: Path) -> RigFormat:
    """Return the format that a file name identifies. Raise `InputError` if none does."""
    names = {entry.name for entry in path.iterdir()} if path.is_dir() else {path.name}
    for row in RIG_FORMATS.values():
        if names & set(row.files):
            return row
    ending = {".csv": "csv", ".urdf": "urdf", ".xacro": "urdf", ".sh": "ros", ".xml": "ros"}
    ending[".txt"] = "kitti"
    if path.suffix.lower() in ending:
        return RIG_FORMATS[ending[path.suffix.lower()]]
    expected = f"a file name of a known format, or the name of a format: {', '.join(RIG_FORMATS)}"
    raise InputError(path, "format", expected, path.name)
