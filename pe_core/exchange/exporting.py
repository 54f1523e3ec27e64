"""Rigs out: a study's sensors as files of another program."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..errors import InputError
from ..scene.reference import Reference
from ..scene.sensors import Rig
from ..text.files import write_all_bytes
from .carried import CarriedSensor, carried, with_pictures
from .frames import origin_in_ground, seen_from, shifted
from .losses import lost_line
from .other_kinds import listed_kinds
from .passthrough import Passthrough, model_text
from .table import RigFormat, rig_format


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
        Of the format: one of `RIG_FORMATS`.
    reference : Reference, optional
        Where the rear axle is, which is the origin of some.
    passthrough : Passthrough, optional
        What an imported file had besides; written again if it was of this format.

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
    kept = passthrough if passthrough is not None and passthrough.format == name else None
    return _written(rig, row, reference, kept, {} if kept is None else kept.files)


def _written(
    rig: Rig,
    row: RigFormat,
    reference: Reference | None,
    kept: Passthrough | None,
    texts: Mapping[str, str],
) -> tuple[Mapping[str, bytes], list[str]]:
    """Return a rig's files, written into `texts` where there are some."""
    sensors, left = _sensors(rig, row, reference, kept)
    if texts and row.write_over is not None:
        files, lines = row.write_over(texts, sensors)
    else:
        files, lines = row.write(sensors)
    if kept is not None and kept.left_out:
        which = listed_kinds((each.kind, each.name) for each in kept.left_out)
        left = [*left, f"as they came in: {which}"]
    return files, [*lines, *left]


def _sensors(
    rig: Rig, row: RigFormat, reference: Reference | None, kept: Passthrough | None
) -> tuple[tuple[CarriedSensor, ...], list[str]]:
    """Return sensors in a format's frame, as far as it keeps them, and what it leaves."""
    back = [-value for value in origin_in_ground(row.origin, reference, row.title)]
    moved = tuple(s.moved(shifted(s.pose, back)) for s in carried(rig))
    if kept is not None:
        if kept.placed is not None:
            moved = tuple(s.moved(seen_from(kept.placed, s.pose)) for s in moved)
        moved = kept.restored(moved, {each.name: model_text(each.model) for each in rig})
    sensors, left = with_pictures(moved, row.keeps, row.title)
    return sensors, left + lost_line(rig, row.title, row.holds)


def export_rig(
    rig: Rig,
    name: str,
    output: str | Path,
    reference: Reference | None = None,
    *,
    passthrough: Passthrough | None = None,
    replace: bool = False,
) -> tuple[list[Path], list[str]]:
    """Write a rig in another program's format; return the files, and lines on what is missing.

    `output` is the file, or the folder where a format has several; what is there stays unless
    `replace` says otherwise. Of an Autoware kit that is replaced all but the sensors stays. What an
    imported file had besides its rig is its `passthrough`: it is written again in its own format.

    Raises
    ------
    InputError
        As `rig_files`, and when a file is there already or cannot be written.
    """
    row, output = rig_format(name), Path(output)
    kept = passthrough if passthrough is not None and passthrough.format == name else None
    texts: Mapping[str, str] = {} if kept is None else kept.files
    # The last of a format's files says where the others stand.
    if replace and len(row.files) > 1 and (output / row.files[-1]).is_file():
        texts = row.source(output) or texts
    files, lines = _written(rig, row, reference, kept, texts)
    return write_files(files, output, inside=len(row.files) > 1, replace=replace), lines


def write_files(
    files: Mapping[str, bytes], output: Path, *, inside: bool, replace: bool
) -> list[Path]:
    """Write bytes by file name, and return their paths.

    All `inside` a folder; or the first at `output` itself, and others beside it. What is there
    stays unless `replace` says otherwise; then, and where one cannot be written, none is.
    """
    folder = output if inside or output.is_dir() else output.parent
    paths = {folder / file: data for file, data in files.items()}
    if folder is not output:
        first, *others = files
        paths = {output: files[first]} | {folder / file: files[file] for file in others}
    for path in paths:
        if path.exists() and not replace:
            raise InputError(path, "file", "a new file, or --replace", "one is there")
    for folder in {path.parent for path in paths}:
        _make_folder(folder)
    write_all_bytes(paths)
    return list(paths)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(folder, "folder", "a place to write to", error) from None
