"""NumPy archives: `triangles`, optionally `parts` and `part_names`."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...text.memory import size_text
from .mesh import Mesh, make_mesh, require_labels, require_room
from .npz_archive import Archive, Header, told_in_one_line

MOST_PARTS = 1_000_000
MOST_NAME_BYTES = 256 << 20
"""The most names of parts, and what they may take side by side, all as long as the longest."""


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
    # A bare .npy, or anything else NumPy would understand, is not an archive.
    if not data.startswith(b"PK"):
        raise InputError(source, "file", "a NumPy .npz archive", "some other format")
    with told_in_one_line(source), Archive(source, data) as archive:
        faces = _check(source, archive.headers)
        arrays = {name: archive.array(name) for name in archive.headers}
        names = _names(arrays.get("part_names"), path.stem)
    parts = arrays.get("parts", np.zeros(faces, dtype=np.int32))
    return make_mesh(source, arrays["triangles"], parts, names)


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


def _check(source: str, headers: Mapping[str, Header]) -> int:
    """Refuse arrays of other shapes or types, and those too large; return the triangles' number."""
    if "triangles" not in headers:
        found = ", ".join(sorted(headers)) or "none of ours"
        raise InputError(source, "triangles", "an array of that name", found)
    triangles = headers["triangles"]
    if triangles.dtype.kind not in "fiu":
        raise InputError(source, "triangles", "real numbers", f"dtype {triangles.dtype}")
    if triangles.shape[1:] != (3, 3):
        raise InputError(source, "triangles", "shape (F, 3, 3)", f"shape {triangles.shape}")
    faces = triangles.shape[0]
    require_room(source, faces)
    if "part_names" in headers:
        _check_names(source, headers["part_names"], "parts" in headers)
    elif "parts" in headers:
        raise InputError(source, "part_names", "names for the parts array", "no such array")
    if "parts" in headers:
        require_labels(source, headers["parts"].shape, headers["parts"].dtype, faces)
    return faces


def _check_names(source: str, names: Header, chosen: bool) -> None:
    if len(names.shape) != 1 or names.dtype.kind != "U":
        found = f"dtype {names.dtype} of shape {names.shape}"
        raise InputError(source, "part_names", "a one-dimensional unicode array", found)
    count = names.shape[0]
    if count > MOST_PARTS or names.size > MOST_NAME_BYTES:
        expected = f"at most {MOST_PARTS:,} names in {size_text(MOST_NAME_BYTES)}"
        found = f"{count:,} in {size_text(names.size)}"
        raise InputError(source, "part_names", expected, found)
    if not chosen and count != 1:
        expected = f"an array choosing among the {count} part names"
        raise InputError(source, "parts", expected, "no such array")


def _names(names: NDArray[Any] | None, stem: str) -> list[str]:
    return [stem] if names is None else [str(name) for name in names]
