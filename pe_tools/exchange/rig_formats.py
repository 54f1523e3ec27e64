"""Registry of the rig formats for import and export, one row per format."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Protocol

from pe_core.base.errors import InputError
from pe_core.base.values import choice

from . import argoverse2, autoware, carla, csv_table, driveworks, kitti, nuscenes, osi, ros, urdf
from . import lens_pictures as lenses
from .foreign_values import Export, FileTexts
from .frames import GROUND, REAR_AXLE, REAR_AXLE_GROUND
from .portable import PortableRig, PortableSensor

MODEL = "model"  # The model name; properties of a catalogued model are then not lost
BEAMS = "beams"  # A LiDAR's channels, azimuths and range
MIN_RANGE, MAX_RANGE = "minimum range", "maximum range"
PARAMETERS = "parameters"  # The table of a model that has neither lens nor beams
FUSION, CURVE = "fusion group", "AP curve"
EVERYTHING = (BEAMS, PARAMETERS, MIN_RANGE, MAX_RANGE, FUSION, CURVE)


class Codec(Protocol):
    """A module that reads and writes a format."""

    def read(self, path: Path, /) -> PortableRig:
        """Return the sensors of a file or folder, in the format's frame."""

    def write(self, sensors: PortableRig, texts: FileTexts, /) -> Export:
        """Return bytes by file name, and messages, of sensors in the format's frame. `texts` are
        those of imported or existing files whose other content it keeps."""


@dataclass(frozen=True, slots=True)
class RigFormat:
    """A format of rigs. `name`, `title`: name in commands, and title in messages. `origin`: origin
    of its frame on the vehicle; `GROUND` is the origin of the ground frame. `files`: names of the
    written files; the first one identifies the format. `code`: module that reads and writes it.
    `holds`: properties that it holds besides poses and lenses. `keeps`: function that reduces a
    camera's intrinsics to what the format can express. `settled`: function that adjusts a sensor
    once its model is known. `source`: function of an imported path; returns the texts that `write`
    takes, by file name. `remarks`: function of an imported path; returns messages on what was not
    read, or was guessed. `usual_size` (int, int): image size of the format's data set [px], for a
    format that states no size. `beside`: whether files with camera intrinsics are beside the main
    file. `passes_through`: whether an export restores imported sensors of unknown kinds."""

    name: str
    title: str
    origin: str
    files: tuple[str, ...]
    code: Codec
    holds: frozenset[str] = frozenset()
    keeps: lenses.KeptPicture = lambda picture: picture
    settled: Callable[[PortableSensor], PortableSensor] = lambda sensor: sensor
    source: Callable[[Path], FileTexts] = lambda path: {}
    remarks: Callable[[Path], Sequence[str]] = lambda path: ()
    usual_size: lenses.Size | None = None
    beside: bool = False
    passes_through: bool = True

    def path_to_read(self, path: Path) -> Path:
        """Return the path that `code` reads: of a folder the file in it, where a rig of the format
        is one file."""
        return path / self.files[0] if len(self.files) == 1 and path.is_dir() else path


_TABLE = frozenset({MODEL, PARAMETERS, FUSION, MIN_RANGE, MAX_RANGE})
_BEAMS = frozenset({BEAMS})
_ROWS = (
    RigFormat("csv", "table (CSV)", GROUND, (csv_table.FILE,), csv_table, _TABLE),
    RigFormat(
        *("urdf", "URDF", GROUND, (urdf.FILE,), urdf, _TABLE | _BEAMS, lenses.opencv_of_five),
        source=urdf.source,
        remarks=urdf.remarks,
    ),
    RigFormat(
        *("ros", "ROS 2 static transforms", GROUND, (ros.FILE,), ros),
        keeps=lenses.opencv,
        source=ros.source,
        beside=True,
    ),
    RigFormat(
        "autoware",
        "Autoware sensor kit",
        *(REAR_AXLE_GROUND, (autoware.IN_KIT, autoware.TO_KIT), autoware),
        keeps=lenses.opencv,
        settled=autoware.lifted,
        source=autoware.source,
        remarks=autoware.remarks,
        beside=True,
    ),
    RigFormat(
        *("nuscenes", "nuScenes", REAR_AXLE_GROUND, nuscenes.FILES, nuscenes),
        keeps=lenses.opencv_of_five,
        usual_size=(1600, 900),
    ),
    RigFormat(
        *("argoverse2", argoverse2.TITLE, REAR_AXLE, argoverse2.FILES, argoverse2),
        keeps=lenses.straight,
        passes_through=False,
    ),
    RigFormat(
        *("carla", "CARLA objects.json", GROUND, (carla.FILE,), carla, _BEAMS, lenses.square),
        source=carla.source,
    ),
    RigFormat(
        *("kitti", "KITTI calibration", GROUND, (kitti.FILE,), kitti),
        keeps=lenses.straight,
        usual_size=(1242, 375),
        passes_through=False,
    ),
    RigFormat(
        *("osi", "ASAM OSI mounting positions", REAR_AXLE, (osi.FILE,), osi, _BEAMS),
        keeps=lenses.centred,
    ),
    RigFormat(
        *("driveworks", "DriveWorks rig.json", REAR_AXLE_GROUND, (driveworks.FILE,), driveworks),
        holds=frozenset({MODEL}),
        keeps=lenses.of_driveworks,
        source=driveworks.source,
    ),
)
RIG_FORMATS = MappingProxyType({row.name: row for row in _ROWS})  # Formats by name


def rig_format(name: str) -> RigFormat:
    """Return the format of that name, or raise `InputError`."""
    return RIG_FORMATS[choice("exchange", "format", name, RIG_FORMATS)]


def format_of_file(output: Path, files: Mapping[str, str], chosen: str | None = None) -> str:
    """Return the format that a file to be written has: the suffix of its name decides. `InputError`
    when the suffix is that of another format than `chosen` or of no single one, or is missing.
    `output`: file or folder to write. `files`: the usual name of the file of each format that has
    one file, by the format's name. `chosen`: name of the format that was asked for; it may be one
    that has a folder of files."""
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
    ending |= {".sdf": "urdf", ".txt": "kitti", ".launch": "ros"}
    if path.suffix.lower() in ending:
        return RIG_FORMATS[ending[path.suffix.lower()]]
    expected = f"a file name of a known format, or the name of a format: {', '.join(RIG_FORMATS)}"
    raise InputError(path, "format", expected, path.name)
