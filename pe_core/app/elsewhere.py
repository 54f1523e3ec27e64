"""Another place for what cannot be left where it was wanted."""

from __future__ import annotations

import tempfile
from pathlib import Path

from ..errors import InputError

ELSEWHERE = "perception-entropy-"
"""What a folder for results begins with that could not be written where they were wanted."""


def another_folder() -> Path:
    """Make a folder among the system's temporary files; `InputError` when that cannot be."""
    try:
        return Path(tempfile.mkdtemp(prefix=ELSEWHERE))
    except OSError as error:
        where = "folder for temporary files"
        raise InputError("system", where, "one that can be written", error) from None


def put_elsewhere(text: str) -> str:
    """Keep a text that could not be printed; return where it is, in words."""
    try:
        path = another_folder() / "output.txt"
        path.write_text(text, encoding="utf-8", errors="backslashreplace")
    except (InputError, OSError) as error:
        return f"it could not be kept either: {error}"
    return f"what it would have said is in {path}"
