"""Names of folders that every system takes, and that stay the same from run to run."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Mapping, Sequence

UNSAFE = re.compile(r"[^A-Za-z0-9._=+-]+")
LONGEST = 100
"""Characters of a name; a longer one is cut, and told by a hash."""
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""What no file may be called on Windows."""
HASH_BYTES = 4


def folder_names(runs: Sequence[tuple[str, Mapping[str, str]]]) -> list[str]:
    """Return a folder's name for each run: study and changes, ``car,sensor.roof.model=Pandar64``.

    What no name may hold becomes a hyphen. Such names, long ones, and those that a system without
    capitals could not tell apart end in a hash of what they stand for.
    """
    words = [(name, *(f"{key}={text}" for key, text in changes.items())) for name, changes in runs]
    plain = [",".join(UNSAFE.sub("-", word) for word in each) for each in words]
    alike = Counter(name.casefold() for name in plain)
    return [
        _name(name, each, alike[name.casefold()] > 1)
        for name, each in zip(plain, words, strict=True)
    ]


def _name(plain: str, words: tuple[str, ...], alike: bool) -> str:
    kept = plain[:LONGEST].strip("-.") or "run"
    if kept == ",".join(words) and not alike and not RESERVED.fullmatch(kept):
        return kept
    meant = "\0".join(words).encode("utf-8", "surrogatepass")
    digest = hashlib.blake2b(meant, digest_size=HASH_BYTES)
    return f"{kept}-{digest.hexdigest()}"
