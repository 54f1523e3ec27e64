"""Registry of the output formats, one row per format, and the export of a scene."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType

from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.plugins import (
    call_plugin,
    find_plugin,
    find_plugins,
    install_hint,
    plugin_name,
    required_plugin,
)
from pe_core.study import Study

from ..exchange import Written, write_files
from . import detection_area, ground_plan, masks, scene_gltf, solids
from .request import OutputRequest

OF_EXAMPLE = ("footprints-dxf", "footprints-svg", "nebula", "rerun")
"""Outputs of the plugin that is shipped as an example."""
EXAMPLE = "the plugin perception-entropy-outputs: pip install examples/plugin"
OUTPUT = "output"  # The sort of plugins that lead to a `SceneOutput`


def _with_library(name: str, title: str, request: OutputRequest) -> tuple[Written, list[str]]:
    """Write by a function of a library's module; `InputError` without it, or for what it raises."""
    expected = install_hint("library", name)
    point, function = required_plugin("library", name, title, "library", expected=expected)
    written: tuple[Written, list[str]] = call_plugin(point, function, request)
    return written


@dataclass(frozen=True, slots=True)
class SceneOutput:
    """An output of the scene. `name`, `title`: name in commands, and title in the user interface.
    `file`: name of its file, or of its folder if it `has_several` files. `write`: function of a
    request; returns bytes by file name, and messages. `has_range`: whether the output depends on
    `range_m` of the request."""

    name: str
    title: str
    file: str
    write: Callable[[OutputRequest], tuple[Written, list[str]]]
    has_several: bool = False
    has_range: bool = True


_ROWS = (
    SceneOutput("gltf", "Whole Scene (glTF)", scene_gltf.FILE, scene_gltf.write),
    SceneOutput(
        "solids", "Fields of View as Solids (glTF, STL)", "solids", solids.write, has_several=True
    ),
    SceneOutput(
        "footprints", "Footprints on the Ground (GeoJSON)", ground_plan.FILE, ground_plan.write
    ),
    SceneOutput(
        "masks", "Ego Masks (PNG, CSV)", "masks", masks.write, has_several=True, has_range=False
    ),
    SceneOutput(
        "detection-area",
        "Virtual Detection Areas (ASAM OSI)",
        "detection_area",
        detection_area.write,
        has_several=True,
    ),
    SceneOutput(
        "picture",
        "Picture (SVG)",
        "picture.svg",
        partial(_with_library, "picture", "picture"),
        has_range=False,
    ),
)


@cache
def scene_outputs() -> Mapping[str, SceneOutput]:
    """Return all outputs by name: our own, then those of plugins that can be loaded."""
    rows = {row.name: row for row in _ROWS}
    for point in find_plugins(OUTPUT):
        with suppress(ImportError, InputError):  # `scene_output` says why, once it is asked for
            name = point.name.removeprefix(f"{OUTPUT}.")
            rows.setdefault(name, _plugin_output(name))
    return MappingProxyType(rows)


def _plugin_output(name: str) -> SceneOutput:
    """Return the output of a plugin; `InputError` where it is missing or no output."""
    expected = EXAMPLE if name in OF_EXAMPLE else "a package that brings it"
    point, row = required_plugin(OUTPUT, name, "export", f"output {name!r}", expected=expected)
    if not isinstance(row, SceneOutput) or row.name != name:
        expected = f"a SceneOutput named {name!r}"
        raise InputError(plugin_name(point), "entry point", expected, type(row).__name__)
    return replace(row, write=partial(call_plugin, point, row.write))


def output_files() -> dict[str, str]:
    """Return the usual name of the file by output, of the outputs that have one."""
    return {row.name: row.file for row in scene_outputs().values() if not row.has_several}


def scene_output(name: str) -> SceneOutput:
    """Return the output of that name, or raise `InputError`."""
    if name in scene_outputs():
        return scene_outputs()[name]
    if name in OF_EXAMPLE or find_plugin(OUTPUT, name) is not None:
        return _plugin_output(name)
    raise InputError("export", "output", one_of(scene_outputs(), name), shown(name))


def scene_files(study: Study, name: str, range_m: float | None = None) -> tuple[Written, list[str]]:
    """Return the files of an output of a study's scene by name, and lines on what to know of them.
    Fields of view are drawn up to `range_m` [m], by default to each sensor's own range. An output
    that is none of `scene_outputs`, a range that is not positive, or a missing library raises
    `InputError`."""
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
    `output` is the file, or the folder where an output has several. Besides what `scene_files`
    raises, a file that is there already, unless `replace`, or cannot be written raises
    `InputError`."""
    files, lines = scene_files(study, name, range_m)
    inside = scene_output(name).has_several
    return write_files(files, Path(output), inside=inside, replace=replace), lines
