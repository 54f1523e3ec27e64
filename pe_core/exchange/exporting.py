"""Rigs out: a study's sensors as files of another program."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..errors import InputError
from ..scene.reference import Reference
from ..scene.sensors import Rig
from ..text.files import write_bytes
from .carried import CarriedSensor, carried, with_pictures
from .frames import origin_in_ground, shifted
from .table import RigFormat, rig_format


def rig_files(
    rig: Rig, name: str, reference: Reference | None = None
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return a rig in another program's format.

    Parameters
    ----------
    rig : Rig
    name : str
        Of the format: one of `RIG_FORMATS`.
    reference : Reference, optional
        Where the rear axle is, which is the origin of some.

    Returns
    -------
    dict of str to bytes, list of str
        Files by name; a line for each thing that the format cannot say.

    Raises
    ------
    InputError
        When there is no such format, it needs the rear axle, or it has no room for the rig.
    """
    row = rig_format(name)
    sensors, left = _sensors(rig, row, reference)
    files, lines = row.write(sensors)
    return files, [*lines, *left]


def _sensors(
    rig: Rig, row: RigFormat, reference: Reference | None
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors in a format's frame, as far as it keeps them, and what it leaves."""
    back = [-value for value in origin_in_ground(row.origin, reference, row.title)]
    moved = [s.moved(shifted(s.pose, back)) for s in carried(rig)]
    return with_pictures(moved, row.keeps, row.title)


def export_rig(
    rig: Rig,
    name: str,
    output: str | Path,
    reference: Reference | None = None,
    *,
    replace: bool = False,
) -> tuple[list[Path], list[str]]:
    """Write a rig in another program's format; return the files, and lines on what is missing.

    `output` is the file, or the folder where a format has several; what is there stays unless
    `replace` says otherwise. Of an Autoware kit that is replaced all but the sensors stays.

    Raises
    ------
    InputError
        As `rig_files`, and when a file is there already or cannot be written.
    """
    row, output = rig_format(name), Path(output)
    files, lines = rig_files(rig, name, reference)
    # The last of a format's files says where the others stand.
    if replace and row.write_over and (output / row.files[-1]).is_file():
        sensors, left = _sensors(rig, row, reference)
        files, lines = row.write_over(output, sensors)
        lines = [*lines, *left]
    return write_files(files, output, inside=len(row.files) > 1, replace=replace), lines


def write_files(
    files: Mapping[str, bytes], output: Path, *, inside: bool, replace: bool
) -> list[Path]:
    """Write bytes by file name, and return their paths.

    All `inside` a folder; or the first at `output` itself, and others beside it. What is there
    stays unless `replace` says otherwise; then nothing is written.
    """
    folder = output if inside or output.is_dir() else output.parent
    paths = {folder / file: data for file, data in files.items()}
    if folder is not output:
        first, *others = files
        paths = {output: files[first]} | {folder / file: files[file] for file in others}
    for path in paths:
        if path.exists() and not replace:
            raise InputError(path, "file", "a new file, or a wish to replace it", "one is there")
    for folder in {path.parent for path in paths}:
        _make_folder(folder)
    for path, data in paths.items():
        write_bytes(path, data)
    return list(paths)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(folder, "folder", "a place to write to", error) from None
