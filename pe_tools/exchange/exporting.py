"""Export of a rig to the file formats of other programs."""

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_all_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.scene.rig import Rig, Sensor
from pe_core.scene.vehicle_description import Reference
from pe_core.study.passthrough import Passthrough

from . import rig_formats as formats
from .frames import origin_in_ground, seen_from, shifted
from .passthrough import listed_kinds, model_text, restored
from .portable import PortableSensor, with_pictures
from .portable_kinds import portable_sensors
from .rig_formats import rig_format


def rig_files(
    rig: Rig,
    name: str,
    reference: Reference | None = None,
    passthrough: Passthrough | None = None,
    existing: Mapping[str, str] | None = None,
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return a rig in another program's format. `InputError` when the format is unknown, needs the
    rear axle, or cannot express the rig.

    Parameters
    ----------
    name : str
        Name of the format, a key of `RIG_FORMATS`.
    reference : Reference, optional
        Position of the rear axle, which is the origin of some formats.
    passthrough : Passthrough, optional
        Content of an imported file besides the rig. It is written again if the file had this
        format.
    existing : mapping of str to str, optional
        Texts of files of this format by name, which are updated in place of the imported ones.

    Returns
    -------
    dict of str to bytes, list of str
        Bytes by file name; a message for each property that the format cannot express.
    """
    row, texts, left_out_lines = rig_format(name), existing, []
    back = [-value for value in origin_in_ground(row.origin, reference, row.title)]
    moved = tuple(dataclasses.replace(s, pose=shifted(s.pose, back)) for s in portable_sensors(rig))
    if passthrough is not None and passthrough.format == name:
        texts = texts or passthrough.files
        if (placed := passthrough.placed) is not None:
            moved = tuple(dataclasses.replace(s, pose=seen_from(placed, s.pose)) for s in moved)
        models = {sensor.name: model_text(sensor.model) for sensor in rig}
        moved = restored(passthrough, moved, models)
        if left_out := listed_kinds((each.kind, each.name) for each in passthrough.left_out):
            left_out_lines = [f"as they came in: {left_out}"]
    sensors, lens_lines = with_pictures(moved, row.keeps, row.title)
    files, lines = row.code.write(sensors, texts or {})
    return files, [*lines, *lens_lines, *lost_line(rig, row.title, row.holds), *left_out_lines]


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
    passthrough: Passthrough | None = None,
    replace: bool = False,
) -> tuple[list[Path], list[str]]:
    """Write a rig in another program's format; parameters not listed are those of `rig_files`.

    When an existing Autoware kit is replaced, everything in it but the sensors is kept.

    Parameters
    ----------
    output : str or Path
        File to write, or the folder if the format has several files.
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
    row, output, existing = rig_format(name), Path(output), None
    # The last of a format's files tells whether the folder already holds this format.
    if replace and len(row.files) > 1 and (output / row.files[-1]).is_file():
        with not_noting_inputs():
            existing = row.source(output)
    files, lines = rig_files(rig, name, reference, passthrough, existing)
    return write_files(files, output, inside=len(row.files) > 1, replace=replace), lines


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
