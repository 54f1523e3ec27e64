"""Export of a rig to the file formats of other programs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.base.files import require_new, write_all_bytes
from pe_core.scene.rig import Rig
from pe_core.scene.vehicle_description import Reference
from pe_core.study.passthrough import Passthrough

from .frames import origin_in_ground, seen_from, shifted
from .losses import lost_line
from .passthrough import listed_kinds, model_text, restored
from .portable import with_pictures
from .portable_kinds import portable_sensors
from .rig_formats import RigFormat, rig_format


def rig_files(
    rig: Rig,
    name: str,
    reference: Reference | None = None,
    passthrough: Passthrough | None = None,
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return a rig in another program's format.

    Parameters
    ----------
    rig : Rig
    name : str
        Name of the format, a key of `RIG_FORMATS`.
    reference : Reference, optional
        Position of the rear axle, which is the origin of some formats.
    passthrough : Passthrough, optional
        Content of an imported file besides the rig. It is written again if the file had this
        format.

    Returns
    -------
    dict of str to bytes, list of str
        Bytes by file name; a message for each property that the format cannot express.

    Raises
    ------
    InputError
        When the format is unknown, needs the rear axle, or cannot express the rig.
    """
    kept = passthrough if passthrough is not None and passthrough.format == name else None
    return _written(rig, rig_format(name), reference, kept, {} if kept is None else kept.files)


def _written(
    rig: Rig,
    row: RigFormat,
    reference: Reference | None,
    passthrough: Passthrough | None,
    texts: Mapping[str, str],
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return the files of a rig and messages; existing `texts` are updated if there are any."""
    back = [-value for value in origin_in_ground(row.origin, reference, row.title)]
    moved = tuple(dataclasses.replace(s, pose=shifted(s.pose, back)) for s in portable_sensors(rig))
    left_out_lines = []
    if passthrough is not None:
        if (placed := passthrough.placed) is not None:
            moved = tuple(dataclasses.replace(s, pose=seen_from(placed, s.pose)) for s in moved)
        models = {sensor.name: model_text(sensor.model) for sensor in rig}
        moved = restored(passthrough, moved, models)
        if left_out := listed_kinds((each.kind, each.name) for each in passthrough.left_out):
            left_out_lines = [f"as they came in: {left_out}"]
    sensors, lens_lines = with_pictures(moved, row.keeps, row.title)
    files, lines = row.code.write(sensors, texts)
    return files, [*lines, *lens_lines, *lost_line(rig, row.title, row.holds), *left_out_lines]


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
    row, output = rig_format(name), Path(output)
    kept = passthrough if passthrough is not None and passthrough.format == name else None
    texts: Mapping[str, str] = {} if kept is None else kept.files
    # The last of a format's files tells whether the folder already holds this format.
    if replace and len(row.files) > 1 and (output / row.files[-1]).is_file():
        texts = row.source(output) or texts
    files, lines = _written(rig, row, reference, kept, texts)
    return write_files(files, output, inside=len(row.files) > 1, replace=replace), lines


def write_files(
    files: Mapping[str, bytes], output: Path, *, inside: bool, replace: bool
) -> list[Path]:
    """Write several files, given by name, all or none, and return their paths.

    They go into the folder `output` if `inside`; otherwise the first file is `output` and the
    others are beside it. Unless `replace`, a file that exists raises `InputError`, as does one that
    cannot be written.
    """
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
