"""Read and write files of triangle meshes, by their suffix."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from pe_core.base.errors import InputError, report_memory_errors
from pe_core.base.files import MESH_BYTES, read_bytes, write_bytes
from pe_core.base.plugins import find_plugin
from pe_core.scene.mesh import Mesh as Mesh
from pe_core.scene.mesh import MeshAxes as MeshAxes

from .axes import GLTF, OURS, UNSAID, SaidAxes, oriented, said_in_comments
from .axes import axes_in_text as axes_in_text
from .mesh import MESH_PLUGIN, fit_names, make_mesh, read_with_plugin
from .mesh import FoundMesh as FoundMesh
from .npz import dump_npz, read_npz
from .obj import read_obj
from .ply import read_ply
from .with_trimesh import dump_obj, read_scene

_F = TypeVar("_F")

_READERS: dict[str, Callable[[Path, bytes], Mesh]] = {
    ".npz": read_npz,
    ".obj": read_obj,
    ".ply": read_ply,
    **dict.fromkeys((".stl", ".glb"), read_scene),
}
_SAYS: dict[str, Callable[[bytes], SaidAxes]] = {
    ".npz": lambda _: OURS,
    ".obj": said_in_comments,
    ".glb": lambda _: GLTF,
}
"""Axes that the files of a format define; other formats define none."""
_WRITERS: dict[str, Callable[[Path, Mesh], bytes]] = {".npz": dump_npz, ".obj": dump_obj}


def read_mesh(path: str | Path, axes: MeshAxes | None = None) -> Mesh:
    """Read a mesh from a .npz, .obj, .stl, .ply or .glb file; with the extra `meshes`, .dae or USD.

    Parameters
    ----------
    path : str or Path
        The suffix decides the format; case is ignored.
    axes : MeshAxes, optional
        The file's forward and up axes, a scale and a rotation. Axes that are not given come
        from the file: .npz, and .obj with the comment of `write_mesh`, are in the ground frame
        (x forward, y left, z up), .glb has +Y up, .dae and USD name the up axis. Otherwise the
        names of parts and the shape decide, or the default: the ground frame, in .glb +Z forward.

    Returns
    -------
    Mesh
        Triangles (F, 3, 3) [m] in the ground frame, F at least 1, including those of zero area;
        parts in the file's order, with printable names (`mesh.fit_names`); a text on how the axes
        were determined; and notes on geometry that is left out.

    Raises
    ------
    InputError
        The suffix is unknown, the reader for it is not installed, the content is wrong or has no
        triangles, or the mesh is too large (`MESH_BYTES`, `MAX_TRIANGLES`, memory).
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _READERS and find_plugin(MESH_PLUGIN, suffix[1:]) is None:
        _of_suffix(path, _READERS)  # reports it
    data = read_bytes(path, MESH_BYTES)
    # Overflow and NaN are refused later, with their location; NumPy need not warn first.
    with np.errstate(all="ignore"), report_memory_errors(path):
        if suffix in _READERS:
            mesh = _READERS[suffix](path, data)
            said = _SAYS[suffix](data) if suffix in _SAYS else UNSAID
        else:
            mesh, said = read_with_plugin(path, data)
        fit = replace(mesh, part_names=fit_names(mesh.part_names))
        return oriented(str(path), fit, said, axes or MeshAxes())


def write_mesh(path: str | Path, mesh: Mesh) -> None:
    """Write a mesh to a .npz file, exactly, or to an .obj file, to 1e-12 m.

    The suffix decides the format. The file is written atomically; parts without triangles are not,
    and parts with the same name are merged. Another suffix, a mesh that could not be read again, or
    a file that cannot be written raises `InputError`.
    """
    path = Path(path)
    writer = _of_suffix(path, _WRITERS)
    sound = make_mesh(str(path), mesh.triangles, mesh.parts, mesh.part_names)
    write_bytes(path, writer(path, sound))


def _of_suffix(path: Path, table: dict[str, _F]) -> _F:
    suffix = path.suffix.lower()
    if suffix not in table:
        raise InputError(str(path), "suffix", " ".join(table), suffix or "none")
    return table[suffix]
