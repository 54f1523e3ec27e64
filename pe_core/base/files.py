"""Whole files, read with size limits and written atomically; lines and numbers in text files."""

from __future__ import annotations

import math
import os
import re
import secrets
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import InputError
from .memory import require_memory, size_text

MESH_BYTES = 2 << 30
LABEL_BYTES = 2 << 30
"""Maximum size of a mesh file and of a file of labelled boxes."""
TEXT_BYTES = 16 << 20
"""Maximum size of a study, a file of channel angles or a table."""

CHUNK = 1 << 20

_FILE_TYPES = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def read_bytes(path: Path, max_bytes: int = TEXT_BYTES) -> bytes:
    """Return the bytes of a regular file (after following links) of at most `max_bytes`.

    A pipe, a terminal or a device is refused without being opened. A file that grows while it is
    read is read no further than `max_bytes`.

    Raises
    ------
    InputError
        When the file is missing, not a regular file, too large or not readable.
    """
    try:
        _require_regular(path, os.stat(path), "a readable file")
        return _read(path, max_bytes)
    except FileNotFoundError as error:
        raise InputError(str(path), "file", "an existing file", "no such file") from error
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: no path may hold a NUL
        raise InputError(str(path), "file", "a readable file", reason_of(error)) from error


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file atomically: all of `data`, or the old file stays as it was.

    A folder, pipe or device of that name is refused, not replaced.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    write_all_bytes({path: data})


def write_all_bytes(files: Mapping[Path, bytes]) -> None:
    """Write several files; if one of them cannot be written, all old files stay as they were.

    A folder, pipe or device of such a name is refused, not replaced.

    Raises
    ------
    InputError
        For the first file that cannot be written.
    """
    # Not the tempfile module: only the owner may read its files, and os.replace keeps that mode.
    temporaries = {p: p.with_name(f".{p.name}.{secrets.token_hex(4)}.tmp") for p in files}
    try:
        for path, data in files.items():
            with _writing(path):
                if path.exists():
                    _require_regular(path, os.stat(path), "a path that can be written")
                temporaries[path].write_bytes(data)
        for path, temporary in temporaries.items():
            with _writing(path):
                os.replace(temporary, path)
    finally:
        for temporary in temporaries.values():
            with suppress(OSError, ValueError):
                temporary.unlink(missing_ok=True)


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Turn an error while writing into an `InputError` that names the file."""
    try:
        yield
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(
            str(path), "file", "a path that can be written", reason_of(error)
        ) from error


def decode_text(data: bytes) -> str:
    """Decode UTF-8, or else Latin-1, with every line ending turned into a newline."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _require_regular(path: Path, status: os.stat_result, expected: str) -> None:
    if not stat.S_ISREG(status.st_mode):
        found = _FILE_TYPES.get(stat.S_IFMT(status.st_mode), "something else")
        raise InputError(str(path), "file", expected, found)


def _read(path: Path, max_bytes: int) -> bytes:
    # Another process may have replaced the file since it was checked: open it such that a pipe
    # does not block and a terminal does not become the controlling one, and check again.
    flags = sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_CLOEXEC"))
    handle = os.open(path, os.O_RDONLY | flags | getattr(os, "O_BINARY", 0))
    try:
        status = os.fstat(handle)
        _require_regular(path, status, "a readable file")
        _require_size(path, status.st_size, max_bytes)
        require_memory(path, "size", status.st_size)
        data = b"".join(_chunks(handle, status.st_size, max_bytes))
    finally:
        os.close(handle)
    _require_size(path, len(data), max_bytes)
    return data


def _chunks(handle: int, size: int, max_bytes: int) -> Iterator[bytes]:
    """Yield the file in chunks, up to one byte more than `max_bytes`."""
    left, wanted = max_bytes + 1, size + 1
    while left > 0 and (chunk := os.read(handle, min(left, wanted))):
        yield chunk
        left, wanted = left - len(chunk), max(size + 1 - len(chunk), CHUNK)


def _require_size(path: Path, size: int, max_bytes: int) -> None:
    if size > max_bytes:
        expected = f"a file of at most {max_bytes:,} bytes"
        found = size_text(size) if size > max_bytes + 1 else "more"
        raise InputError(str(path), "size", expected, found)


def reason_of(error: OSError | ValueError) -> str:
    """Return why a file cannot be read or written, in a few words of the system's."""
    return str(getattr(error, "strerror", None) or error).lower()


NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
"""Each digit can match in one way only: otherwise the time would grow with the square of a text."""
MAX_QUOTE = 40


def parse_number(source: str, where: str, what: str, text: str) -> float:
    """Return a finite number of a text; `what` names it in the message."""
    value = float(text) if NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        expected = f"a finite number, with a decimal point, for {what}"
        raise InputError(source, where, expected, quoted(text))
    return value


def quoted(text: str) -> str:
    """Return a text in quotes and cut short, or ``nothing`` if it is empty."""
    return repr(text[:MAX_QUOTE]) if text else "nothing"


def numbered_lines(text: str) -> list[tuple[int, str]]:
    """Return lines and their numbers from 1, without comments, blank lines and trailing blanks."""
    lines = ((n, raw.split("#", 1)[0].rstrip()) for n, raw in enumerate(text.split("\n"), 1))
    return [(n, line) for n, line in lines if line]
