"""Reading and atomically writing whole files, with one-line errors."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from ..errors import InputError


def read_bytes(path: Path) -> bytes:
    """The file's bytes; `InputError` if it is missing or cannot be read."""
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(str(path), "file", "an existing file", "no such file") from error
    except (OSError, ValueError) as error:  # ValueError: no path may hold a NUL
        raise InputError(str(path), "file", "a readable file", _reason(error)) from error


def write_bytes(path: Path, data: bytes) -> None:
    """Write all of `data` or leave what was there; `InputError` if it cannot be written."""
    # Not the tempfile module: its files are readable by their owner alone, and os.replace
    # would hand that mode on to the result.
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        try:
            temporary.write_bytes(data)
            os.replace(temporary, path)
        finally:
            temporary.unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        raise InputError(str(path), "file", "a place to write to", _reason(error)) from error


def decode_text(data: bytes) -> str:
    """Text with every line ending made a newline; old files that are not UTF-8 are Latin-1."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _reason(error: OSError | ValueError) -> str:
    return str(getattr(error, "strerror", None) or error).lower()
