"""Read TOML with the standard library, and refuse what it would choke on."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from ..errors import InputError

MOST_PARTS = 30
"""Parts of a dotted key. The library's time and memory grow with their square or worse: 17 s and
1.7 GB for a key of 40 kB."""
PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{PART}){{{MOST_PARTS},}}+")


def load_toml(source: object, field: str, text: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises
    ------
    InputError
        When it is no TOML, nested too deep, has a whole number of thousands of digits or a key of
        more than `MOST_PARTS` parts.
    """
    if found := LONG_KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(source, f"line {line}", f"keys of at most {MOST_PARTS} parts", "more")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(source, field, "valid TOML", "lists or tables nested too deep") from None
    except ValueError as error:  # tomllib's own, and of int() when there are too many digits
        raise InputError(source, field, "valid TOML", error) from None
