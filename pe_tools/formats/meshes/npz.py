"""Meshes as .npz: NumPy's archive, checked before NumPy reads it."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from pe_core.base.errors import InputError
from pe_core.base.memory import size_text
from pe_core.scene.mesh import Mesh

from .mesh import make_mesh, require_labels, require_room

ARRAYS = ("triangles", "parts", "part_names")
MAX_ARRAYS = 1000
MEMBER = b"PK\x01\x02"
"""First bytes of a member's entry in the directory."""
VERSIONS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


class Header(NamedTuple):
    """Shape and data type from an array's header."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Bytes of its values, as a Python integer, which cannot overflow."""
        return math.prod(self.shape) * self.dtype.itemsize


class NpzArchive:
    """The arrays of a mesh in an archive; `headers` has the header of each existing array.

    Raises
    ------
    InputError
        An array is there twice, or holds pickled objects.
    """

    def __init__(self, source: str, data: bytes) -> None:
        if data.count(MEMBER) > MAX_ARRAYS:
            raise InputError(source, "file", f"at most {MAX_ARRAYS:,} arrays", "more")
        self._source = source
        self._zip = zipfile.ZipFile(io.BytesIO(data))
        self._members = self._find()
        self.headers = {name: self._header(name) for name in self._members}

    def __enter__(self) -> NpzArchive:
        return self

    def __exit__(self, *_: object) -> None:
        self._zip.close()

    def array(self, name: str) -> NDArray[Any]:
        """Unpack an array; its size is checked against the archive before memory is allocated."""
        info, needed = self._members[name], self.headers[name].size
        if needed > info.file_size:
            found = f"{info.file_size:,}"
            raise InputError(self._source, name, f"{needed:,} bytes of values", found)
        with self._zip.open(info) as file:
            return npy.read_array(file, allow_pickle=False)  # type: ignore[no-untyped-call]

    def _find(self) -> dict[str, zipfile.ZipInfo]:
        members: dict[str, zipfile.ZipInfo] = {}
        for info in self._zip.infolist():
            name = info.filename.removesuffix(".npy")
            if name in members:
                raise InputError(self._source, name, "one array of that name", "a second one")
            if name in ARRAYS:
                members[name] = info
        return members

    def _header(self, name: str) -> Header:
        with self._zip.open(self._members[name]) as file:
            header = _read_header(file)
        if header.dtype.hasobject:
            raise InputError(self._source, "file", "arrays without pickled objects", name)
        return header


@contextmanager
def one_line_errors(source: str) -> Iterator[None]:
    """Convert the exceptions of zipfile, zlib, tokenize and NumPy into `InputError`."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(source, "file", "a complete NumPy .npz archive", reason) from error


def _read_header(file: IO[bytes]) -> Header:
    version = npy.read_magic(file)  # type: ignore[no-untyped-call]
    if version not in VERSIONS:  # others: structured arrays
        raise ValueError(f"version {version} of the .npy format")
    shape, _, dtype = VERSIONS[version](file)  # type: ignore[no-untyped-call]
    return Header(shape, dtype)


MAX_PARTS = 1_000_000
MAX_NAME_BYTES = 256 << 20
"""Maximum number of part names, and maximum memory of all names, padded to the longest one."""


def read_npz(path: Path, data: bytes) -> Mesh:
    """Read an archive of `triangles` (F, 3, 3), `parts` (F,) and `part_names` (P,).

    Coordinates are metres in the ground frame. Without `parts` all triangles are one part; its
    name is the only part name, or the file's stem.

    Raises
    ------
    InputError
        The file is not an archive. An array is missing, has the wrong shape or type, or holds
        objects (they are never unpickled). A coordinate is not finite, or there are no triangles.
    """
    source = str(path)
    # A single .npy array, or another file that NumPy can load, is not an archive.
    if not data.startswith(b"PK"):
        raise InputError(source, "file", "a NumPy .npz archive", "another format")
    with one_line_errors(source), NpzArchive(source, data) as archive:
        faces = _check(source, archive.headers)
        arrays = {name: archive.array(name) for name in archive.headers}
        names = _names(arrays.get("part_names"), path.stem)
    parts = arrays.get("parts", np.zeros(faces, dtype=np.int32))
    return make_mesh(source, arrays["triangles"], parts, names)


def dump_npz(path: Path, mesh: Mesh) -> bytes:
    """Return the archive's bytes: exact float64 triangles, int32 parts, unicode part names."""
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        triangles=mesh.triangles,
        parts=mesh.parts,
        part_names=np.array(mesh.part_names, dtype=np.str_),
    )
    return buffer.getvalue()


def _check(source: str, headers: Mapping[str, Header]) -> int:
    """Refuse wrong shapes or types and too large arrays; return the number of triangles."""
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


def _check_names(source: str, names: Header, has_parts: bool) -> None:
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


def _names(names: NDArray[Any] | None, stem: str) -> list[str]:
    return [stem] if names is None else [str(name) for name in names]
