"""Read and write files of triangle meshes, by their suffix."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

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
from .with_trimesh import dump_glb, dump_obj, dump_stl, read_scene


@dataclass(frozen=True, slots=True)
class MeshFormat:
    """A format of meshes. `read`: function of a path and the file's bytes. `axes`: function of the
    bytes; returns the axes that they define. `write`: function of a path and a mesh; returns the
    bytes of a file. None for a format that is only read."""

    read: Callable[[Path, bytes], Mesh]
    axes: Callable[[bytes], SaidAxes] = lambda _: UNSAID
    write: Callable[[Path, Mesh], bytes] | None = None


MESH_FORMATS = {
    ".npz": MeshFormat(read_npz, lambda _: OURS, dump_npz),
    ".obj": MeshFormat(read_obj, said_in_comments, dump_obj),
    ".ply": MeshFormat(read_ply),
    ".stl": MeshFormat(read_scene, write=dump_stl),
    ".glb": MeshFormat(read_scene, lambda _: GLTF, dump_glb),
}  # Formats by suffix; plugins add others


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
    row = MESH_FORMATS.get(suffix)
    if row is None and find_plugin(MESH_PLUGIN, suffix[1:]) is None:
        raise InputError(path, "suffix", " ".join(MESH_FORMATS), suffix or "none")
    data = read_bytes(path, MESH_BYTES)
    # Overflow and NaN are refused later, with their location; NumPy need not warn first.
    with np.errstate(all="ignore"), report_memory_errors(path):
        if row is None:
            mesh, said = read_with_plugin(path, data)
        else:
            mesh = row.read(path, data)
            said = row.axes(data)
        fit = replace(mesh, part_names=fit_names(mesh.part_names))
        return oriented(str(path), fit, said, axes or MeshAxes())


def write_mesh(path: str | Path, mesh: Mesh) -> None:
    """Write a mesh to a .npz file, exactly, to an .obj file, to 1e-12 m, or to .stl or .glb.

    The suffix decides the format. The file is written atomically; parts without triangles are not,
    and parts with the same name are merged. Another suffix, a mesh that could not be read again, or
    a file that cannot be written raises `InputError`.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    written = {key: row.write for key, row in MESH_FORMATS.items() if row.write is not None}
    if suffix not in written:
        raise InputError(path, "suffix", " ".join(written), suffix or "none")
    sound = make_mesh(str(path), mesh.triangles, mesh.parts, mesh.part_names)
    write_bytes(path, written[suffix](path, sound))
