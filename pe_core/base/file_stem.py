"""Names of files that every file system takes, made of names that people give to things."""

from __future__ import annotations

import re
import unicodedata

MAX_STEM = 100
_RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def is_reserved(name: str) -> bool:
    """Whether Windows keeps a name for a device, whatever its suffix: no file can have it."""
    return _RESERVED.fullmatch(name) is not None


def file_stem(name: str, default: str, *, joint: str = "_", max_length: int = MAX_STEM) -> str:
    """Return a name as that of a file, without suffix: ASCII letters, digits, ``-`` and ``_``.

    Parameters
    ----------
    name : str
    default : str
        What the thing is; the name of one whose own name has no such letter.
    joint : str
        What stands for one or several other characters.
    max_length : int
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    stem = re.sub("[^A-Za-z0-9_-]+" if joint == "_" else "[^A-Za-z0-9]+", joint, plain)
    stem = stem.strip(joint)[:max_length].strip(joint) or default
    return f"{stem}{joint}{default}" if is_reserved(stem) else stem
