"""Registry of the output formats, one row per format, and the export of a scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.plugins import call_plugin, install_hint, required_plugin
from pe_core.study import Study

from ..exchange import Written, write_files
from . import masks, nebula, scene_gltf, solids, svg
from .footprints import ground_plan
from .request import OutputRequest

DXF, PICTURE, RECORDING = "footprints.dxf", "picture.png", "scene.rrd"


def write_dxf(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the plan from above as DXF, and lines on what is not in it."""
    dxf_bytes = _function("dxf", "DXF")
    plan, lines = ground_plan(request)
    return {DXF: dxf_bytes(plan)}, lines


def write_recording(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the scene as a recording of Rerun's, and lines on what is not in it."""
    data, lines = _function("rerun", "Rerun")(request)
    return {RECORDING: data}, lines


def write_picture(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return the picture of the rig on its vehicle, with numbered sensors and their key."""
    written: tuple[Written, list[str]] = _function("picture", "picture")(request)
    return written


def _function(name: str, title: str) -> Callable[..., Any]:
    """Return a plugin's function; `InputError` without its library, or for what it raises."""
    expected = install_hint("library", name)
    return partial(call_plugin, *required_plugin("library", name, title, "library", expected))


@dataclass(frozen=True, slots=True)
class SceneOutput:
    """An output of the scene.

    Attributes
    ----------
    name, title : str
        Name in commands, and title in the user interface.
    file : str
        Name of its file, or of its folder if it has several files.
    write : callable
        Function of a request; returns bytes by file name, and messages.
    has_several : bool
        Whether it is a folder of files.
    has_range : bool
        Whether the output depends on `range_m` of the request.
    """

    name: str
    title: str
    file: str
    write: Callable[[OutputRequest], tuple[Written, list[str]]]
    has_several: bool = False
    has_range: bool = True


_ROWS = (
    SceneOutput("solids", "Fields of View as Solids (glTF, STL)", "solids", solids.write, True),
    SceneOutput("footprints", "Footprints on the Ground (SVG)", svg.FILE, svg.write),
    SceneOutput("footprints-dxf", "Footprints on the Ground (DXF)", DXF, write_dxf),
    SceneOutput("gltf", "Whole Scene (glTF)", scene_gltf.FILE, scene_gltf.write),
    SceneOutput("rerun", "Rerun Recording", RECORDING, write_recording),
    SceneOutput("masks", "Ego Masks (PNG, CSV)", "masks", masks.write, True, has_range=False),
    SceneOutput("picture", "Picture (PNG)", PICTURE, write_picture, has_range=False),
    SceneOutput("nebula", "Radar Mountings (Nebula)", nebula.FILE, nebula.write, has_range=False),
)
SCENE_OUTPUTS = MappingProxyType({row.name: row for row in _ROWS})
"""Outputs by name."""
FILES = MappingProxyType({row.name: row.file for row in _ROWS if not row.has_several})
"""Usual name of the file by output, of the outputs that have one."""


def scene_output(name: str) -> SceneOutput:
    """Return the output of that name, or raise `InputError`."""
    if name not in SCENE_OUTPUTS:
        raise InputError("export", "output", f"one of {', '.join(SCENE_OUTPUTS)}", shown(name))
    return SCENE_OUTPUTS[name]


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
