"""Lines and numbers in text files, and what messages quote of them."""

from __future__ import annotations

import math
import re

from ..errors import InputError

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?", re.ASCII)
"""Each digit matches in one way alone: else long cells would take the square of their length."""
LONGEST_QUOTE = 40


def parse_number(source: str, where: str, what: str, text: str) -> float:
    """Return a finite number; `what` names it in the message."""
    value = float(text) if NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        expected = f"a finite number, with a decimal point, for {what}"
        raise InputError(source, where, expected, quoted(text))
    return value


def quoted(text: str) -> str:
    """Return what was found in quotes and cut short, or ``nothing``."""
    return repr(text[:LONGEST_QUOTE]) if text else "nothing"


def numbered_lines(text: str) -> list[tuple[int, str]]:
    """Lines with their numbers from 1, without comments, blank lines and trailing blanks."""
    lines = ((n, raw.split("#", 1)[0].rstrip()) for n, raw in enumerate(text.split("\n"), 1))
    return [(n, line) for n, line in lines if line]
