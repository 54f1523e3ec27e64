"""A NumPy archive opened with care: what its headers claim is known before anything is unpacked."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any, NamedTuple

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from ...errors import InputError

ARRAYS = ("triangles", "parts", "part_names")
MOST_MEMBERS = 1000
MEMBER = b"PK\x01\x02"
"""How each member's entry in the directory begins."""
VERSIONS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


class Header(NamedTuple):
    """What an array's header says of it."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]

    @property
    def size(self) -> int:
        """Bytes of its values, as a Python number: it cannot wrap round."""
        return math.prod(self.shape) * self.dtype.itemsize


class Archive:
    """The arrays of a mesh in an archive's bytes; `headers` has those that are there.

    Raises
    ------
    InputError
        An array comes twice or holds pickled objects.
    """

    def __init__(self, source: str, data: bytes) -> None:
        if data.count(MEMBER) > MOST_MEMBERS:
            raise InputError(source, "file", f"at most {MOST_MEMBERS:,} arrays", "more")
        self._source = source
        self._zip = zipfile.ZipFile(io.BytesIO(data))
        self._members = self._find()
        self.headers = {name: self._header(name) for name in self._members}

    def __enter__(self) -> Archive:
        return self

    def __exit__(self, *_: object) -> None:
        self._zip.close()

    def array(self, name: str) -> NDArray[Any]:
        """Unpack an array; it takes what its header says, if its member can be so long."""
        info, needed = self._members[name], self.headers[name].size
        if needed > info.file_size:
            found = f"{info.file_size:,}"
            raise InputError(self._source, name, f"{needed:,} bytes of values", found)
        with self._zip.open(info) as file:
            return npy.read_array(file, allow_pickle=False)  # type: ignore[no-untyped-call]

    def _find(self) -> dict[str, zipfile.ZipInfo]:
        found: dict[str, zipfile.ZipInfo] = {}
        for info in self._zip.infolist():
            name = info.filename.removesuffix(".npy")
            if name in found:
                raise InputError(self._source, name, "one array of that name", "a second one")
            if name in ARRAYS:
                found[name] = info
        return found

    def _header(self, name: str) -> Header:
        with self._zip.open(self._members[name]) as file:
            header = _read_header(file)
        if header.dtype.hasobject:
            raise InputError(self._source, "file", "arrays without pickled objects", name)
        return header


@contextmanager
def told_in_one_line(source: str) -> Iterator[None]:
    """Turn what zipfile, zlib, tokenize and NumPy raise, a dozen kinds, into one of ours."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InputError(source, "file", "a complete NumPy .npz archive", reason) from error


def _read_header(file: IO[bytes]) -> Header:
    version = npy.read_magic(file)  # type: ignore[no-untyped-call]
    if version not in VERSIONS:  # others are of structured arrays, none of ours
        raise ValueError(f"version {version} of the .npy format")
    shape, _, dtype = VERSIONS[version](file)  # type: ignore[no-untyped-call]
    return Header(shape, dtype)
