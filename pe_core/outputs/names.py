"""Names that file systems and other programs take, made of any."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

ODD = re.compile("[^A-Za-z0-9_-]+")


def plain_names(names: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """Return a plain name for each of some different ones, and a line for each that changed.

    Letters, digits, ``_`` and ``-``; no two alike, however they are capitalised.
    """
    found: dict[str, str] = {}
    for name in names:
        plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
        plain = ODD.sub("_", plain).strip("_") or "sensor"
        found[name] = _apart(plain, {each.lower() for each in found.values()})
    return found, [f"{a}: called {b} in names of files" for a, b in found.items() if a != b]


def _apart(name: str, taken: set[str]) -> str:
    number, unique = 2, name
    while unique.lower() in taken:
        unique, number = f"{name}_{number}", number + 1
    return unique
