"""Words for the terminal: none of them ends the work, whatever has become of the stream.

A reader that has gone, a full disk, a closed stream: what is printed is lost, the work goes on.
"""

from __future__ import annotations

import os
import sys
import unicodedata
from contextlib import suppress
from typing import TextIO

ESCAPED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Categories of characters that steer a terminal or the direction of text, or are none at all."""
LONGEST_LINE = 2000
"""Characters of a message; what is longer quotes too much."""


def printable(text: str, encoding: str | None = "utf-8") -> str:
    r"""Return text with what would steer the terminal written as ``\u001b``; newlines stay.

    So does what the stream's encoding has no word for. JSON means the same afterwards.
    """
    if not text.isascii() or not text.replace("\n", "").isprintable():
        text = "".join(c if c == "\n" or _is_harmless(c, encoding) else _escape(c) for c in text)
    return text


def one_line(text: str) -> str:
    """Return a message of one line, printable and not too long."""
    line = printable(" ".join(text.splitlines()))
    return line if len(line) <= LONGEST_LINE else f"{line[:LONGEST_LINE]}..."


def tell(text: str) -> None:
    """Say something on stderr, in a line that begins with ``pe:``."""
    show(f"pe: {one_line(text)}\n", sys.stderr)


def show(text: str, stream: TextIO | None) -> OSError | ValueError | None:
    """Write text to a stream as it is, if that can be done; return what was in the way."""
    if stream is None:  # closed before we were started
        return None
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        _silence(stream)
        return error
    return None


def is_terminal(stream: TextIO | None) -> bool:
    """Whether somebody is looking."""
    try:
        return stream is not None and stream.isatty()
    except (OSError, ValueError):
        return False


def open_missing_streams() -> None:
    """Give stdin, stdout and stderr a place to go where they were closed.

    Else the next file that is opened takes the number, and gets what was meant for them.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one


def _silence(stream: TextIO) -> None:
    """Let what the stream still holds go nowhere, lest flushing it at the end fails again."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        try:
            os.dup2(nowhere, stream.fileno())
        finally:
            os.close(nowhere)


def _is_harmless(character: str, encoding: str | None) -> bool:
    if unicodedata.category(character) in ESCAPED:
        return False
    try:
        character.encode(encoding or "utf-8")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _escape(character: str) -> str:
    """Return a character as JSON writes it: beyond 16 bits as two."""
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i]:02x}{units[i + 1]:02x}" for i in range(0, len(units), 2))
