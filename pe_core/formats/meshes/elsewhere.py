"""Formats that take a library to read: packages beside the engine read them, found by entry points.

An entry point of the group `READERS` has a suffix without its dot for a name (``dae``), and leads
to a function of the path and the file's bytes that returns a `FoundMesh`.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import ArrayLike, NDArray

from ...errors import InputError, shown
from ...text.plugins import call_plugin, load_plugin, plugin_name
from .axes import SaidAxes
from .mesh import Mesh, make_mesh

READERS = "pe_core.mesh_readers"
SUFFIXES = (".dae", ".usd", ".usda", ".usdc", ".usdz")
"""Those that the extra reads; others may come by entry points, too."""
EXTRA = "pip install 'perception-entropy[meshes]'"


class FoundMesh(NamedTuple):
    """What a reader found: triangles [m] in the file's axes, parts, names, and which axis is up."""

    triangles: ArrayLike
    parts: NDArray[Any]
    part_names: Sequence[str]
    up: str


def read_elsewhere(path: Path, data: bytes) -> tuple[Mesh, SaidAxes]:
    """Read a mesh by the reader that is installed for its suffix.

    Raises
    ------
    InputError
        There is none, or it lacks its library, and what installs it; or what the reader raises.
    """
    point, reader = _reader(path)
    found = call_plugin(point, reader, path, data)
    if not isinstance(found, FoundMesh):
        raise InputError(plugin_name(point), "result", "a FoundMesh", shown(found))
    mesh = make_mesh(str(path), found.triangles, found.parts, found.part_names)
    forward = "+x" if found.up != "+x" else "+z"
    return mesh, SaidAxes(found.up, "file", forward, "")


def is_read_elsewhere(suffix: str) -> bool:
    """Whether files of a suffix are for another package to read."""
    return suffix in SUFFIXES or bool(entry_points(group=READERS, name=suffix[1:]))


def _reader(path: Path) -> tuple[EntryPoint, Any]:
    """Return the plugin for a file's suffix, and the function that reads it."""
    suffix = path.suffix.lower()
    expected = f"a reader for it ({EXTRA}), or the mesh imported into Blender"
    for point in entry_points(group=READERS, name=suffix[1:]):
        try:
            return point, load_plugin(point)
        except ImportError as error:
            raise InputError(str(path), "suffix", expected, f"no {error.name}") from error
    raise InputError(str(path), "suffix", expected, "none installed")
