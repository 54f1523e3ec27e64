"""NumPy archives: `triangles`, optionally `parts` and `part_names`."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .mesh import Mesh, make_mesh


def read_npz(path: Path, data: bytes) -> Mesh:
    """Read an archive of `triangles` (F, 3, 3), `parts` (F,) and `part_names` (P,).

    Coordinates are metres in the ground frame, taken as they are. Without `parts` all
    triangles are one part, called by the only part name or else by the file's stem.

    Raises
    ------
    InputError
        Not an archive, an array missing or of the wrong shape or type, an object array
        (never unpickled), coordinates not finite, or no triangles.
    """
    source = str(path)
    arrays = _load(source, data)
    if "triangles" not in arrays:
        found = ", ".join(sorted(arrays)) or "an empty archive"
        raise InputError(source, "triangles", "an array of that name", found)
    triangles = arrays["triangles"]
    if triangles.dtype.kind not in "fiu":
        raise InputError(source, "triangles", "real numbers", f"dtype {triangles.dtype}")
    if triangles.shape[1:] != (3, 3):
        raise InputError(source, "triangles", "shape (F, 3, 3)", f"shape {triangles.shape}")
    names = _names(source, arrays, path.stem)
    parts = arrays.get("parts", np.zeros(len(triangles), dtype=np.int32))
    return make_mesh(source, triangles, parts, names)


def dump_npz(path: Path, mesh: Mesh) -> bytes:
    """The archive's bytes: exact float64 triangles, int32 parts, unicode part names."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        triangles=mesh.triangles,
        parts=mesh.parts,
        part_names=np.array(mesh.part_names, dtype=np.str_),
    )
    return buffer.getvalue()


def _load(source: str, data: bytes) -> dict[str, NDArray[Any]]:
    # A bare .npy, or anything else np.load would understand, is not an archive.
    if not data.startswith(b"PK"):
        raise InputError(source, "file", "a NumPy .npz archive", "some other format")
    wanted = ("triangles", "parts", "part_names")
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in wanted if name in archive.files}
    except Exception as error:  # zipfile, zlib, tokenize and NumPy raise a dozen kinds here
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(source, "file", "a complete NumPy .npz archive", reason) from error
    # A member that is not an .npy file comes out of np.load as bytes.
    return {name: np.asarray(array) for name, array in arrays.items()}


def _names(source: str, arrays: dict[str, NDArray[Any]], stem: str) -> list[str]:
    if "part_names" not in arrays:
        if "parts" in arrays:
            raise InputError(source, "part_names", "names for the parts array", "no such array")
        return [stem]
    names = arrays["part_names"]
    if names.ndim != 1 or names.dtype.kind != "U":
        found = f"dtype {names.dtype} of shape {names.shape}"
        raise InputError(source, "part_names", "a one-dimensional unicode array", found)
    if "parts" not in arrays and len(names) != 1:
        expected = f"an array choosing among the {len(names)} part names"
        raise InputError(source, "parts", expected, "no such array")
    return [str(name) for name in names]
