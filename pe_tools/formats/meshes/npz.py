"""Meshes as .npz: NumPy's archive."""

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.errors import InputError, size_text
from pe_core.base.files import MESH_BYTES
from pe_core.scene.mesh import Mesh

from .mesh import make_mesh, require_labels, require_room

ARRAYS = ("triangles", "parts", "part_names")
MAX_ARRAYS = 1000
MAX_PARTS = 1_000_000


def read_npz(path: Path, data: bytes) -> Mesh:
    """Read an archive of `triangles` (F, 3, 3), `parts` (F,) and `part_names` (P,). Coordinates are
    metres in the ground frame. Without `parts` all triangles are one part; its name is the only
    part name, or the file's stem. Pickled objects are never unpickled."""
    source = str(path)
    try:
        # What a header claims and the archive does not hold is no memory in use.
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
        if len(members) > MAX_ARRAYS:
            raise InputError(source, "file", f"at most {MAX_ARRAYS:,} arrays", f"{len(members):,}")
        if (size := sum(each.file_size for each in members)) > MESH_BYTES:
            expected = f"at most {size_text(MESH_BYTES)} of arrays"
            raise InputError(source, "file", expected, size_text(size))
        with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
            found: dict[str, Any] = {name: arrays[name] for name in ARRAYS if name in arrays}
        wrong = next((n for n, array in found.items() if not isinstance(array, np.ndarray)), None)
        if wrong is not None:
            raise InputError(source, wrong, "an array", f"{type(found[wrong]).__name__}")
        names = found.get("part_names", np.array([path.stem]))
        texts = [str(name) for name in names.ravel()[: MAX_PARTS + 1]]
    except (InputError, MemoryError):
        raise
    except Exception as error:  # of zipfile, zlib, tokenize and NumPy
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200]
        raise InputError(source, "file", "a complete NumPy .npz archive", reason) from error
    if "triangles" not in found:
        raise InputError(source, "triangles", "an array of that name", ", ".join(found) or "none")
    triangles = found["triangles"]
    if triangles.dtype.kind not in "fiu":
        raise InputError(source, "triangles", "real numbers", f"dtype {triangles.dtype}")
    if triangles.ndim == 0:
        raise InputError(source, "triangles", "shape (F, 3, 3)", "shape ()")
    require_room(source, len(triangles))
    if names.ndim != 1 or names.dtype.kind != "U" or len(names) > MAX_PARTS:
        expected = f"a one-dimensional unicode array of at most {MAX_PARTS:,} names"
        raise InputError(source, "part_names", expected, f"{names.dtype} of shape {names.shape}")
    if ("parts" in found) != ("part_names" in found) and ("parts" in found or len(names) != 1):
        expected = "both, or a single name alone"
        raise InputError(source, "parts, part_names", expected, ", ".join(found))
    parts = found.get("parts", np.zeros(len(triangles), np.int32))
    require_labels(source, parts.shape, parts.dtype, len(triangles))
    return make_mesh(source, triangles, parts, texts)


def dump_npz(_path: Path, mesh: Mesh) -> bytes:
    """Return the archive's bytes: exact float64 triangles, int32 parts, unicode part names."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        triangles=mesh.triangles,
        parts=mesh.parts,
        part_names=np.array(mesh.part_names, dtype=np.str_),
    )
    return buffer.getvalue()
