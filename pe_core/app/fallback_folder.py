"""Another place for what cannot be left where it was wanted."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import InputError

PREFIX = "perception-entropy-"
"""What a folder for results begins with that could not be written where they were wanted."""


@contextmanager
def fallback_folder() -> Iterator[Path]:
    """Make a folder among the system's temporary files; it is removed again if it stays empty.

    Raises
    ------
    InputError
        No folder can be made there.
    """
    try:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    except OSError as error:
        where = "folder for temporary files"
        raise InputError("system", where, "one that can be written", error) from None
    try:
        yield folder
    finally:
        if not any(path.is_file() for path in folder.rglob("[!.]*")):
            shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def folder_or_fallback(folder: Path | None) -> Iterator[Path]:
    """Yield the folder, or where that is None a `fallback_folder`."""
    if folder is not None:
        yield folder
        return
    with fallback_folder() as other:
        yield other


def put_elsewhere(text: str) -> str:
    """Keep a text that could not be printed; return where it is, in words."""
    try:
        with fallback_folder() as folder:
            path = folder / "output.txt"
            try:
                path.write_text(text, encoding="utf-8", errors="backslashreplace")
            except OSError:
                with suppress(OSError):
                    path.unlink(missing_ok=True)
                raise
    except (InputError, OSError) as error:
        return f"it could not be kept either: {error}"
    return f"what it would have said is in {path}"
