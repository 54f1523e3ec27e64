"""What of a scene goes out for other programs and does not come back, a row an output."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

from ..errors import InputError, shown
from ..exchange import Written
from . import libraries, masks, scene_gltf, solids, svg
from .request import OutputRequest


@dataclass(frozen=True, slots=True)
class SceneOutput:
    """An output of the scene.

    Attributes
    ----------
    name, title : str
        What commands and what people call it.
    file : str
        Name of its file; of the folder where it has several.
    write : callable
        A request to bytes by file name, and lines on what to know of them.
    has_several : bool
        Whether it is a folder of files.
    has_range : bool
        Whether `range_m` of a request matters.
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
    SceneOutput(
        "footprints-dxf", "Footprints on the Ground (DXF)", libraries.DXF, libraries.write_dxf
    ),
    SceneOutput("gltf", "Whole Scene (glTF)", scene_gltf.FILE, scene_gltf.write),
    SceneOutput("rerun", "Rerun Recording", libraries.RECORDING, libraries.write_recording),
    SceneOutput("masks", "Ego Masks (PNG, CSV)", "masks", masks.write, True, has_range=False),
)
SCENE_OUTPUTS = MappingProxyType({row.name: row for row in _ROWS})
"""Outputs by name."""


def scene_output(name: str) -> SceneOutput:
    """Return the output of that name, or raise `InputError`."""
    if name not in SCENE_OUTPUTS:
        raise InputError("export", "output", f"one of {', '.join(SCENE_OUTPUTS)}", shown(name))
    return SCENE_OUTPUTS[name]
