"""Output of the command line: safe printing, messages on stderr, exit statuses."""

from __future__ import annotations

import os
import sys
import unicodedata
from contextlib import suppress
from typing import TextIO

DONE, BAD_INPUT, USAGE, INTERRUPTED = 0, 1, 2, 130
Answer = tuple[str, int]
"""What a verb prints on stdout, and its exit status."""


ESCAPED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode categories that control a terminal or the direction of text, or are no characters."""
MAX_LINE_LENGTH = 2000
"""Maximum number of characters of a message; the rest is cut."""


def printable(text: str, encoding: str | None = "utf-8") -> str:
    r"""Return text with control characters escaped as ``\u001b``; newlines stay.

    Characters that the stream's encoding cannot represent are escaped, too. JSON text keeps its
    meaning.
    """
    if not text.isascii() or not text.replace("\n", "").isprintable():
        text = "".join(c if c == "\n" or _is_harmless(c, encoding) else _escape(c) for c in text)
    return text


def one_line(text: str) -> str:
    """Return a message of one line, printable and not too long."""
    line = printable(" ".join(text.splitlines()))
    return line if len(line) <= MAX_LINE_LENGTH else f"{line[:MAX_LINE_LENGTH]}..."


def tell(text: str) -> None:
    """Print a message on stderr, in one line that begins with ``pe:``."""
    show(f"pe: {one_line(text)}\n", sys.stderr)


def show(text: str, stream: TextIO | None) -> OSError | ValueError | None:
    """Write text to a stream unchanged; return the error if that fails, else None."""
    if stream is None:  # closed before the program started
        return None
    try:
        stream.write(text)
        stream.flush()
    except (OSError, ValueError) as error:
        _silence(stream)
        return error
    return None


def is_terminal(stream: TextIO | None) -> bool:
    """Whether the stream is an interactive terminal."""
    try:
        return stream is not None and stream.isatty()
    except (OSError, ValueError):
        return False


def open_missing_streams() -> None:
    """Open the null device for each of stdin, stdout and stderr that is closed.

    Otherwise the next opened file would get its descriptor, and the output meant for the stream.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free descriptor: this one


def _silence(stream: TextIO) -> None:
    """Redirect a stream to the null device, so that flushing its buffer at exit does not fail."""
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
