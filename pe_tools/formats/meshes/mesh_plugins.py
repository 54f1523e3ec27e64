"""Mesh formats that need an optional library.

Plugins of the sort ``mesh`` read them. The name of a plugin is a suffix without its dot
(``mesh.dae``). A plugin is a function of the path and the file's bytes; it returns a `FoundMesh`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from numpy.typing import ArrayLike, NDArray

from pe_core.base.errors import InputError, shown
from pe_core.base.plugins import (
    call_plugin,
    find_plugin,
    install_hint,
    plugin_name,
    required_plugin,
)
from pe_core.scene.mesh import Mesh

from .axes import SaidAxes
from .mesh import make_mesh

MESH_PLUGIN = "mesh"


class FoundMesh(NamedTuple):
    """Result of a reader: triangles [m] in the file's axes, parts, names, and the up axis."""

    triangles: ArrayLike
    parts: NDArray[Any]
    part_names: Sequence[str]
    up: str


def read_with_plugin(path: Path, data: bytes) -> tuple[Mesh, SaidAxes]:
    """Read a mesh with the plugin for its suffix.

    Raises
    ------
    InputError
        There is no plugin, its library is missing (the message says how to install it), or the
        plugin raises an error.
    """
    suffix = path.suffix.lower()
    hint = install_hint(MESH_PLUGIN, suffix[1:])
    expected = f"a reader for it ({hint}), or the mesh imported into Blender"
    point, reader = required_plugin(MESH_PLUGIN, suffix[1:], str(path), "suffix", expected)
    found = call_plugin(point, reader, path, data)
    if not isinstance(found, FoundMesh):
        raise InputError(plugin_name(point), "result", "a FoundMesh", shown(found))
    mesh = make_mesh(str(path), found.triangles, found.parts, found.part_names)
    forward = "+x" if found.up != "+x" else "+z"
    return mesh, SaidAxes(found.up, "file", forward, "")


def has_plugin(suffix: str) -> bool:
    """Whether a plugin reads files of a suffix."""
    return find_plugin(MESH_PLUGIN, suffix[1:]) is not None
