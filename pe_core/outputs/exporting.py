"""An output of the scene written: the files, and what they cannot say."""

from __future__ import annotations

from pathlib import Path

from ..exchange import Written, write_files
from ..study import Study
from .request import OutputRequest
from .table import scene_output


def scene_files(study: Study, name: str, range_m: float | None = None) -> tuple[Written, list[str]]:
    """Return an output of a study's scene.

    Parameters
    ----------
    study : Study
    name : str
        Of the output: one of `SCENE_OUTPUTS`.
    range_m : float, optional
        How far fields of view are drawn [m]; by default to each sensor's own range.

    Returns
    -------
    dict of str to bytes, list of str
        Files by name; a line for each thing to know of them.

    Raises
    ------
    InputError
        When there is no such output, the range is not positive, or a library is missing.
    """
    return scene_output(name).write(OutputRequest(study, range_m))


def export_scene(
    study: Study,
    name: str,
    output: str | Path,
    range_m: float | None = None,
    *,
    replace: bool = False,
) -> tuple[list[Path], list[str]]:
    """Write an output of a study's scene; return the files, and lines on what to know of them.

    `output` is the file, or the folder where an output has several; what is there stays unless
    `replace` says otherwise.

    Raises
    ------
    InputError
        As `scene_files`, and when a file is there already or cannot be written.
    """
    files, lines = scene_files(study, name, range_m)
    inside = scene_output(name).has_several
    return write_files(files, Path(output), inside=inside, replace=replace), lines
