"""Reading and atomically writing whole files, with one-line errors."""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import InputError
from .memory import require_memory, size_text

MESH_BYTES = 2 << 30
LABEL_BYTES = 2 << 30
"""The greatest file of a mesh, and of labelled boxes."""
TEXT_BYTES = 16 << 20
"""The greatest study, file of channel angles or table: what people write, or a page of numbers."""

CHUNK = 1 << 20

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def read_bytes(path: Path, most_bytes: int = TEXT_BYTES) -> bytes:
    """Return the bytes of a regular file (after following links) of at most `most_bytes`.

    A pipe nobody writes to, a terminal or an endless device is refused without being opened, and
    a file that grows while it is read is read no further than `most_bytes`.

    Raises
    ------
    InputError
        When it is missing, something else than a regular file, too large or not readable.
    """
    try:
        _require_regular(path, os.stat(path), "a readable file")
        return _read(path, most_bytes)
    except FileNotFoundError as error:
        raise InputError(str(path), "file", "an existing file", "no such file") from error
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: no path may hold a NUL
        raise InputError(str(path), "file", "a readable file", _reason(error)) from error


def write_bytes(path: Path, data: bytes) -> None:
    """Write all of `data` or leave what was there; `InputError` if it cannot be written.

    A folder, pipe or device in the file's place is refused, not replaced.
    """
    write_all_bytes({path: data})


def write_all_bytes(files: Mapping[Path, bytes]) -> None:
    """Write several files, or leave all as it was where one of them cannot be written.

    A folder, pipe or device in a file's place is refused, not replaced.

    Raises
    ------
    InputError
        For the first file that cannot be written.
    """
    # Not the tempfile module: its files are readable by their owner alone, and os.replace
    # would hand that mode on to the result.
    temporaries = {p: p.with_name(f".{p.name}.{secrets.token_hex(4)}.tmp") for p in files}
    try:
        for path, data in files.items():
            with _named(path):
                if path.exists():
                    _require_regular(path, os.stat(path), "a place to write to")
                temporaries[path].write_bytes(data)
        for path, temporary in temporaries.items():
            with _named(path):
                os.replace(temporary, path)
    finally:
        for temporary in temporaries.values():
            with suppress(OSError, ValueError):
                temporary.unlink(missing_ok=True)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Name the file that cannot be written."""
    try:
        yield
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(str(path), "file", "a place to write to", _reason(error)) from error


def decode_text(data: bytes) -> str:
    """Text with every line ending made a newline; old files that are not UTF-8 are Latin-1."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _require_regular(path: Path, status: os.stat_result, expected: str) -> None:
    if not stat.S_ISREG(status.st_mode):
        found = _KINDS.get(stat.S_IFMT(status.st_mode), "something else")
        raise InputError(str(path), "file", expected, found)


def _read(path: Path, most_bytes: int) -> bytes:
    # Between the look and the opening another thing may have come to stand there: opened so
    # that no pipe blocks and no terminal takes over, and asked again.
    flags = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_CLOEXEC"))
    handle = os.open(path, os.O_RDONLY | flags | getattr(os, "O_BINARY", 0))
    try:
        status = os.fstat(handle)
        _require_regular(path, status, "a readable file")
        _require_size(path, status.st_size, most_bytes)
        require_memory(path, "size", status.st_size)
        data = b"".join(_pieces(handle, status.st_size, most_bytes))
    finally:
        os.close(handle)
    _require_size(path, len(data), most_bytes)
    return data


def _pieces(handle: int, size: int, most_bytes: int) -> Iterator[bytes]:
    """The file from its beginning, up to a byte more than it may have."""
    left, ask = most_bytes + 1, size + 1
    while left > 0 and (piece := os.read(handle, min(left, ask))):
        yield piece
        left, ask = left - len(piece), max(size + 1 - len(piece), CHUNK)


def _require_size(path: Path, size: int, most_bytes: int) -> None:
    if size > most_bytes:
        expected = f"a file of at most {most_bytes:,} bytes"
        found = size_text(size) if size > most_bytes + 1 else "more"
        raise InputError(str(path), "size", expected, found)


def _reason(error: OSError | ValueError) -> str:
    return str(getattr(error, "strerror", None) or error).lower()
