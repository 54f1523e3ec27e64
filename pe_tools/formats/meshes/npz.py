"""Meshes as .npz: NumPy's archive, checked before NumPy reads it."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.lib import format as npy

from pe_core.base.errors import InputError, size_text
from pe_core.scene.mesh import Mesh

from .mesh import make_mesh, require_labels, require_room

ARRAYS = ("triangles", "parts", "part_names")
MAX_ARRAYS = 1000
MAX_PARTS = 1_000_000
MAX_NAME_BYTES = 256 << 20
"""Maximum number of part names, and maximum memory of all names, padded to the longest one."""
MEMBER = b"PK\x01\x02"
"""First bytes of a member's entry in the directory."""
VERSIONS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


class StoredArray(NamedTuple):
    """An array in an archive, with the shape and data type of its header."""

    info: zipfile.ZipInfo
    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Bytes of its values, as a Python integer, which cannot overflow."""
        return math.prod(self.shape) * self.dtype.itemsize


def read_npz(path: Path, data: bytes) -> Mesh:
    """Read an archive of `triangles` (F, 3, 3), `parts` (F,) and `part_names` (P,).

    Coordinates are metres in the ground frame. Without `parts` all triangles are one part; its
    name is the only part name, or the file's stem. Pickled objects are never unpickled.
    """
    source = str(path)
    # A single .npy array, or another file that NumPy can load, is not an archive.
    if not data.startswith(b"PK"):
        raise InputError(source, "file", "a NumPy .npz archive", "another format")
    if data.count(MEMBER) > MAX_ARRAYS:
        raise InputError(source, "file", f"at most {MAX_ARRAYS:,} arrays", "more")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = _members(source, archive)
            faces = _check(source, members)
            arrays: dict[str, Any] = {}
            for name, member in members.items():
                # Its size is checked before memory is allocated.
                if member.size > member.info.file_size:
                    expected = f"{member.size:,} bytes of values"
                    raise InputError(source, name, expected, f"{member.info.file_size:,}")
                with archive.open(member.info) as file:
                    arrays[name] = npy.read_array(file, allow_pickle=False)  # type: ignore[no-untyped-call]
            names = [str(name) for name in arrays.get("part_names", [path.stem])]
    except InputError:
        raise
    except Exception as error:  # of zipfile, zlib, tokenize and NumPy
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(source, "file", "a complete NumPy .npz archive", reason) from error
    parts = arrays.get("parts", np.zeros(faces, dtype=np.int32))
    return make_mesh(source, arrays["triangles"], parts, names)


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


def _members(source: str, archive: zipfile.ZipFile) -> dict[str, StoredArray]:
    """Return the arrays of a mesh by name, with their headers."""
    members: dict[str, StoredArray] = {}
    for info in archive.infolist():
        name = info.filename.removesuffix(".npy")
        if name in members:
            raise InputError(source, name, "one array of that name", "a second one")
        if name not in ARRAYS:
            continue
        with archive.open(info) as file:
            version = npy.read_magic(file)  # type: ignore[no-untyped-call]
            if version not in VERSIONS:  # others: structured arrays
                raise ValueError(f"version {version} of the .npy format")
            shape, _, dtype = VERSIONS[version](file)  # type: ignore[no-untyped-call]
        if dtype.hasobject:
            raise InputError(source, "file", "arrays without pickled objects", name)
        members[name] = StoredArray(info, shape, dtype)
    return members


def _check(source: str, members: Mapping[str, StoredArray]) -> int:
    """Refuse wrong shapes or types and too large arrays; return the number of triangles."""
    if "triangles" not in members:
        found = ", ".join(sorted(members)) or "none of ours"
        raise InputError(source, "triangles", "an array of that name", found)
    _, shape, dtype = members["triangles"]
    if dtype.kind not in "fiu":
        raise InputError(source, "triangles", "real numbers", f"dtype {dtype}")
    if shape[1:] != (3, 3):
        raise InputError(source, "triangles", "shape (F, 3, 3)", f"shape {shape}")
    require_room(source, shape[0])
    if "part_names" in members:
        _check_names(source, members["part_names"], "parts" in members)
    elif "parts" in members:
        raise InputError(source, "part_names", "names for the parts array", "no such array")
    if "parts" in members:
        require_labels(source, members["parts"].shape, members["parts"].dtype, shape[0])
    return shape[0]


def _check_names(source: str, names: StoredArray, has_parts: bool) -> None:
    if len(names.shape) != 1 or names.dtype.kind != "U":
        found = f"dtype {names.dtype} of shape {names.shape}"
        raise InputError(source, "part_names", "a one-dimensional unicode array", found)
    count = names.shape[0]
    if count > MAX_PARTS or names.size > MAX_NAME_BYTES:
        expected = f"at most {MAX_PARTS:,} names in {size_text(MAX_NAME_BYTES)}"
        found = f"{count:,} in {size_text(names.size)}"
        raise InputError(source, "part_names", expected, found)
    if not has_parts and count != 1:
        expected = f"an array choosing among the {count} part names"
        raise InputError(source, "parts", expected, "no such array")
