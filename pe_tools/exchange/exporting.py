"""Export of a rig to the file formats of other programs."""

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_all_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.plugins import call_plugin, install_hint, required_plugin
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import Rig, Sensor, SensorModel
from pe_core.scene.vehicle_description import Reference

from . import rig_formats as formats
from .frames import origin_in_ground, seen_from, shifted
from .importing import ModelledRig, errors_of, read_rig
from .merging import listed_kinds, merged
from .portable import MergeTarget, PortableRig, PortableSensor, SceneFacts, with_pictures
from .portable_kinds import portable_sensors
from .rig_formats import RigFormat, format_to_read, rig_format


def rig_files(
    rig: Rig,
    name: str,
    reference: Reference | None = None,
    *,
    into: str | Path | None = None,
    placed: Pose | None = None,
    facts: SceneFacts | None = None,
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return a rig in another program's format. `InputError` when the format is unknown, needs the
    rear axle, cannot express the rig, or cannot update the file `into`.

    Parameters
    ----------
    name : str
        Name of the format, a key of `RIG_FORMATS`.
    reference : Reference, optional
        Position of the rear axle, which is the origin of some formats.
    into : path, optional
        File or folder of this format whose content besides the rig stays in the returned files.
    placed : Pose, optional
        Pose of the file's origin, for a format without a vehicle.
    facts : SceneFacts, optional
        Vehicle and figures, for a format that has room for them.

    Returns
    -------
    dict of str to bytes, list of str
        Bytes by file name; a message for each property that the format cannot express.
    """
    row = rig_format(name)
    read = None if into is None else _read_target(Path(into), row)
    return _rig_files(rig, row, reference, read, placed=placed, facts=facts)


def _rig_files(
    rig: Rig,
    row: RigFormat,
    reference: Reference | None,
    read: ModelledRig | None,
    placed: Pose | None,
    facts: SceneFacts | None = None,
) -> tuple[Mapping[str, bytes], list[str]]:
    back = [-value for value in origin_in_ground(row.origin, reference, row.title)]
    moved = tuple(dataclasses.replace(s, pose=shifted(s.pose, back)) for s in portable_sensors(rig))
    if placed is not None:
        moved = tuple(dataclasses.replace(s, pose=seen_from(placed, s.pose)) for s in moved)
    target = None
    kept = ""
    if read is not None:
        names = {sensor.name for sensor in rig}
        others = tuple(sensor for sensor in read.left_out if sensor.name not in names)
        moved, target = _merged(rig, moved, read, row)
        kept = listed_kinds((sensor.kind or "", sensor.name) for sensor in others)
    kept_lines = [f"kept as in the file: {kept}"] if kept else []
    sensors, lens_lines = with_pictures(moved, row.keeps, row.title)
    if row.write_scene is not None and facts is not None:
        files, lines = row.write_scene(sensors, facts)
    else:
        files, lines = row.write(sensors, target)
    return files, [*lines, *lens_lines, *lost_line(rig, row.title, row.holds), *kept_lines]


def _read_target(path: Path, row: RigFormat) -> ModelledRig:
    """Read the file that a rig goes into."""
    if not row.merges:
        expected = "a format whose files keep what they have besides the rig"
        raise InputError(path, "into", expected, row.name)
    _, path = format_to_read(path, row.name)
    with errors_of(path), not_noting_inputs():
        return read_rig(path, row, {})


def _merged(
    rig: Rig, sensors: PortableRig, read: ModelledRig, row: RigFormat
) -> tuple[PortableRig, MergeTarget]:
    """Return the sensors of a rig with their entries in a file, and what is left of the file."""
    in_file: dict[str, tuple[PortableSensor, SensorModel | None]] = {
        **{sensor.name: (sensor, None) for sensor in read.left_out},
        **{each.sensor.name: (each.sensor, each.model) for each in read.modelled},
    }
    left_out = {sensor.name for sensor in read.left_out}
    result = []
    for sensor in sensors:
        if sensor.name in in_file:
            known, model = in_file.pop(sensor.name)
            if formats.FUSION in row.holds and sensor.fusion != known.fusion:
                model = None
            sensor = merged(sensor, rig[sensor.name].model, known, model)
        result.append(sensor)
    gone = tuple(known for name, (known, _) in in_file.items() if name not in left_out)
    taken = tuple(name for name in in_file if name in left_out)
    return tuple(result), MergeTarget(read.found.document, gone, taken)


def lost_line(rig: Rig, title: str, holds: frozenset[str]) -> list[str]:
    """Return one message with the properties of a rig that are not in `holds`; [] if none. Losses
    of lenses and of uneven LiDAR channels have messages of their own."""
    pairs = zip(rig, portable_sensors(rig), strict=True)
    lost = {sensor.name: set(_owned(sensor, portable, holds)) - holds for sensor, portable in pairs}
    parts = []
    for feature in formats.EVERYTHING:
        names = [name for name, features in lost.items() if feature in features]
        if names:
            parts.append(f"{feature} of {', '.join(names)}")
    return [f"left out of {title}: {'; '.join(parts)}"] if parts else []


def _owned(sensor: Sensor, portable: PortableSensor, holds: frozenset[str]) -> Iterator[str]:
    """Yield the properties of a sensor that differ from the defaults of its model."""
    if sensor.fusion is not None:
        yield formats.FUSION
    if sensor.curve is not None:
        yield formats.CURVE
    model = sensor.model
    if formats.MODEL in holds and model.name in catalog.names(model.kind):
        known = catalog.load(model.name)
        if known is model or catalog.to_table(known) == catalog.to_table(model):
            return
    if portable.scan is not None:
        yield formats.BEAMS
        if formats.BEAMS not in holds:
            return  # with its ranges
    if portable.parameters:
        yield formats.PARAMETERS
        return  # with its ranges
    if portable.min_range is not None:
        yield formats.MIN_RANGE
    if portable.max_range is not None and portable.scan is None:
        yield formats.MAX_RANGE


def export_rig(
    rig: Rig,
    name: str,
    output: str | Path,
    reference: Reference | None = None,
    *,
    into: str | Path | None = None,
    placed: Pose | None = None,
    replace: bool = False,
    facts: SceneFacts | None = None,
) -> tuple[list[Path], list[str]]:
    """Write a rig in another program's format; parameters not listed are those of `rig_files`.

    Parameters
    ----------
    output : str or Path
        File to write, or the folder if the format has several files.
    into : path, optional
        File whose other content is kept; by default that at `output` if it is replaced.
    replace : bool
        Whether existing files may be overwritten.

    Returns
    -------
    list of Path, list of str
        Written files; a message for each property that the format cannot express.

    Raises
    ------
    InputError
        As `rig_files`, and when a file exists and `replace` is False, or cannot be written.
    """
    row = rig_format(name)
    output = Path(output)
    read = None
    damaged_lines = []
    if into is not None:
        read = _read_target(Path(into), row)
    elif replace and row.merges and _is_there(row, output):
        try:
            read = _read_target(output, row)
        except InputError as error:
            damaged_lines = [f"replaced as a whole, as it cannot be read: {error}"]
    files, lines = _rig_files(rig, row, reference, read, placed=placed, facts=facts)
    if output.suffix.lower() in row.binary:
        files = _packed(row, files, output)
    paths = write_files(files, output, inside=row.is_folder, replace=replace)
    return paths, [*damaged_lines, *lines]


def _packed(row: RigFormat, files: Mapping[str, bytes], output: Path) -> Mapping[str, bytes]:
    """Return written files in the format of the output's suffix, which a library writes."""
    suffix = output.suffix.lower()
    hint = install_hint("library", row.packed)
    point, function = required_plugin("library", row.packed, str(output), "format", expected=hint)
    packed: Mapping[str, bytes] = call_plugin(point, function, files, suffix)
    return packed


def _is_there(row: RigFormat, output: Path) -> bool:
    """Whether there is a rig of a format where one is to be written."""
    path = row.path_to_read(output)
    return (path / row.files[-1]).is_file() if row.is_folder else path.is_file()


def write_files(
    files: Mapping[str, bytes], output: Path, *, inside: bool, replace: bool
) -> list[Path]:
    """Write several files, given by name, all or none, and return their paths. They go into the
    folder `output` if `inside`; otherwise the first file is `output` and the others are beside it.
    Unless `replace`, a file that exists raises `InputError`, as does one that cannot be written."""
    folder = output if inside or output.is_dir() else output.parent
    paths = {folder / file: data for file, data in files.items()}
    if folder is not output:
        first, *remaining = files
        paths = {output: files[first]} | {folder / file: files[file] for file in remaining}
    for path in paths:
        require_new(path, replace=replace)
    for folder in {path.parent for path in paths}:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(folder, "folder", "a path that can be written", error) from None
    write_all_bytes(paths)
    return list(paths)
