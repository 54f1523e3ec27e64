"""Registry of the rig formats for import and export, one row per format."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from pe_core.base.errors import InputError
from pe_core.base.values import choice
from pe_core.scene.vehicle_description import Reference

from . import (
    argoverse2,
    autoware,
    carla,
    csv_table,
    driveworks,
    kitti,
    nuscenes,
    osi,
    ros,
    urdf,
    urdf_writer,
    usd,
    usd_schema,
    usd_writer,
)
from . import lens_pictures as lenses
from .foreign_values import Export
from .frames import GROUND, REAR_AXLE, REAR_AXLE_GROUND, origin_in_ground
from .portable import ForeignRig, MergeTarget, PortableRig, PortableSensor, SceneFacts

MODEL = "model"  # The model name; properties of a catalogued model are then not lost
BEAMS = "beams"  # A LiDAR's channels, azimuths and range
MIN_RANGE = "minimum range"
MAX_RANGE = "maximum range"
PARAMETERS = "parameters"  # The table of a model that has neither lens nor beams
FUSION = "fusion group"
CURVE = "AP curve"
EVERYTHING = (BEAMS, PARAMETERS, MIN_RANGE, MAX_RANGE, FUSION, CURVE)
_TABLE = frozenset({MODEL, PARAMETERS, FUSION, MIN_RANGE, MAX_RANGE})
_BEAMS = frozenset({BEAMS})


@dataclass(frozen=True, slots=True)
class RigFormat:
    """A format of rigs. `name`, `title`: name in commands, and title in messages. `origin`: origin
    of its frame on the vehicle; `GROUND` is the origin of the ground frame. `files`: names of the
    written files; the first one identifies the format, as do `suffixes` of other names. `read`:
    function that returns the content of a file or folder. `write`: function of sensors and of the
    file that they go into (None: a new one); returns bytes by file name, and messages. `holds`:
    properties that it holds besides poses and lenses. `keeps`: function that reduces a camera's
    intrinsics to what the format can express. `settled`: function that adjusts a sensor once its
    model is known. `usual_size` (int, int): image size of the format's data set [px], for a format
    that states no size. `beside`: whether files with camera intrinsics are beside the main file.
    `merges`: whether an export into a file keeps what the file has besides the rig. `write_scene`:
    function that writes the rig over its vehicle, with what its score found; None for a format that
    has room for sensors alone. `binary`: other suffixes that it is written with, by a library:
    `packed` is the name of the plugin."""

    name: str
    title: str
    origin: str
    files: tuple[str, ...]
    read: Callable[[Path], ForeignRig]
    write: Callable[[PortableRig, MergeTarget | None], Export]
    suffixes: tuple[str, ...] = ()
    holds: frozenset[str] = frozenset()
    keeps: lenses.KeptPicture = lambda picture: picture
    settled: Callable[[PortableSensor], PortableSensor] = lambda sensor: sensor
    usual_size: lenses.Size | None = None
    beside: bool = False
    merges: bool = True
    write_scene: Callable[[PortableRig, SceneFacts], Export] | None = None
    binary: tuple[str, ...] = ()
    packed: str = ""

    @property
    def is_folder(self) -> bool:
        """Whether a rig of the format is a folder of several files."""
        return len(self.files) > 1

    def path_to_read(self, path: Path) -> Path:
        """Return the path that `read` takes: of a folder the file in it, where a rig of the format
        is one file."""
        return path / self.files[0] if path.is_dir() and not self.is_folder else path


_ROWS = (
    RigFormat(
        name="csv",
        title="CSV table",
        origin=GROUND,
        files=(csv_table.FILE,),
        suffixes=(".csv",),
        read=csv_table.read,
        write=csv_table.write,
        holds=_TABLE,
    ),
    RigFormat(
        name="urdf",
        title="URDF",
        origin=GROUND,
        files=(urdf_writer.FILE,),
        suffixes=(".urdf", ".xacro", ".sdf"),
        read=urdf.read,
        write=urdf_writer.write,
        holds=_TABLE | _BEAMS,
        keeps=lenses.opencv_of_five,
    ),
    RigFormat(
        name="ros",
        title="ROS 2 static transforms",
        origin=GROUND,
        files=(ros.FILE,),
        suffixes=(".sh", ".xml", ".launch"),
        read=ros.read,
        write=ros.write,
        keeps=lenses.opencv,
        beside=True,
    ),
    RigFormat(
        name="autoware",
        title="Autoware sensor kit",
        origin=REAR_AXLE_GROUND,
        files=(autoware.IN_KIT, autoware.TO_KIT),
        read=autoware.read,
        write=autoware.write,
        keeps=lenses.opencv,
        settled=autoware.lifted,
        beside=True,
    ),
    RigFormat(
        name="nuscenes",
        title="nuScenes",
        origin=REAR_AXLE_GROUND,
        files=nuscenes.FILES,
        read=nuscenes.read,
        write=nuscenes.write,
        keeps=lenses.opencv_of_five,
        usual_size=(1600, 900),
    ),
    RigFormat(
        name="argoverse2",
        title=argoverse2.TITLE,
        origin=REAR_AXLE,
        files=argoverse2.FILES,
        read=argoverse2.read,
        write=argoverse2.write,
        keeps=lenses.straight,
        merges=False,
    ),
    RigFormat(
        name="carla",
        title="CARLA objects.json",
        origin=GROUND,
        files=(carla.FILE,),
        read=carla.read,
        write=carla.write,
        holds=_BEAMS,
        keeps=lenses.square,
    ),
    RigFormat(
        name="kitti",
        title="KITTI calibration",
        origin=GROUND,
        files=(kitti.FILE,),
        suffixes=(".txt",),
        read=kitti.read,
        write=kitti.write,
        keeps=lenses.straight,
        usual_size=(1242, 375),
        merges=False,
    ),
    RigFormat(
        name="osi",
        title="ASAM OSI mounting positions",
        origin=REAR_AXLE,
        files=(osi.FILE,),
        read=osi.read,
        write=osi.write,
        holds=_BEAMS,
        keeps=lenses.centred,
    ),
    RigFormat(
        name="driveworks",
        title="DriveWorks rig.json",
        origin=REAR_AXLE_GROUND,
        files=(driveworks.FILE,),
        read=driveworks.read,
        write=driveworks.write,
        holds=frozenset({MODEL}),
        keeps=lenses.of_driveworks,
    ),
    RigFormat(
        name="usd",
        title="OpenUSD",
        origin=GROUND,
        files=(usd_schema.FILE,),
        suffixes=(".usda", ".usd", ".usdc", ".usdz"),
        read=usd.read,
        write=usd_writer.write,
        write_scene=usd_writer.write_scene,
        holds=_TABLE | _BEAMS,
        keeps=lenses.opencv,
        merges=False,
        binary=(".usdc", ".usdz"),
        packed="usd_packed",
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
    fitting = [name for name, file in files.items() if suffix in _written_suffixes(name, file)]
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


def origin_of(name: str, reference: Reference | None) -> tuple[float, ...]:
    """Return the origin of a format's frame in the ground frame, (3,) [m]. `InputError` where it is
    the rear axle and that is not known."""
    row = rig_format(name)
    return origin_in_ground(row.origin, reference, row.title)


def _written_suffixes(name: str, file: str) -> tuple[str, ...]:
    """Return the suffixes of files that a format writes."""
    row = RIG_FORMATS.get(name)
    return (Path(file).suffix, *(row.binary if row is not None else ()))


FILES = MappingProxyType({row.name: row.files[0] for row in _ROWS if not row.is_folder})
"""Usual name of the file by format, of the formats that have one."""


def detect_format(path: Path) -> RigFormat:
    """Return the format that a file name identifies. Raise `InputError` if none does."""
    names = {entry.name for entry in path.iterdir()} if path.is_dir() else {path.name}
    by_name = (row for row in _ROWS if names & set(row.files))
    by_suffix = (row for row in _ROWS if path.suffix.lower() in row.suffixes)
    row = next(by_name, None) or next(by_suffix, None)
    if row is None:
        known = ", ".join(RIG_FORMATS)
        expected = f"a file name of a known format, or the name of a format: {known}"
        raise InputError(path, "format", expected, path.name)
    return row


def format_to_read(path: Path, name: str | None) -> tuple[RigFormat, Path]:
    """Return the format of a file or folder, by its `name` or else by the path's, and the path that
    it reads. `InputError` if there is no file."""
    if not path.exists():
        raise InputError(path, "", "", "no such file or folder")
    row = detect_format(path) if name is None else rig_format(name)
    return row, row.path_to_read(path)
