"""The one exception that means: the user's input is wrong, and here is how to mend it.

What a message quotes may come from anywhere, so it is shown short, on one line, and with every
character that a terminal would act on written out.
"""

from __future__ import annotations

import reprlib
from typing import Any

LONGEST_FOUND = 80
"""Values are cut to this many characters in messages."""
LONGEST_WORDS = 160
"""So long may the field and what was expected be: a list of all keys of a table fits."""
CUT = "..."
MANY_DIGITS = 40
"""A whole number of more digits than this is told by their count. (Python refuses to write out
4,301 and more.)"""
LOG10_OF_2 = 0.30102999566398120


class InputError(ValueError):
    """Bad input, told in one line.

    Parameters
    ----------
    source : object
        Where the input came from: a file's path, or the name of what was passed in.
    field : str
        Which field of it is wrong (``sensor[0].model``), or what was being read.
    expected : str
        What would have been right.
    found : object
        What was there instead: words to be told as they are, or the value itself.
    """

    def __init__(self, source: object, field: str, expected: str, found: object) -> None:
        self.source, self.field, self.expected, self.found = str(source), field, expected, found
        where = f"{_middle_cut(visible(self.source))}: {_cut(visible(field), LONGEST_WORDS)}"
        self._told = told = visible(found) if isinstance(found, str) else _short(found)
        wanted = _cut(visible(expected), LONGEST_WORDS)
        super().__init__(f"{where}: expected {wanted}, found {_cut(told, LONGEST_FOUND)}")

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.source, self.field, self.expected, self._told)

    def at(self, source: object) -> InputError:
        """Return the same error, said of another source (the file a value came from)."""
        return InputError(source, self.field, self.expected, self.found)


def shown(value: object) -> str:
    """Return a value as a message quotes it: like `repr`, but short, safe, and never failing."""
    return _cut(_SHORT.repr(value), LONGEST_FOUND)


def visible(text: str) -> str:
    """Return a text with all that cannot be seen written out: controls, line ends, turned text."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else _escaped(c) for c in text[: 10 * LONGEST_WORDS])


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")


class _Short(reprlib.Repr):
    """`repr` of plain data, cut where it is long or deep."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = self.maxother = LONGEST_FOUND

    def repr(self, x: Any) -> str:
        if getattr(x, "ndim", None) == 0 and hasattr(x, "item"):
            x = x.item()  # NumPy 2 would write np.float64(1.0)
        return super().repr(x)

    def repr_int(self, x: int, level: int) -> str:
        digits = int(abs(x).bit_length() * LOG10_OF_2) + 1
        return f"a whole number of {digits:,} digits" if digits > MANY_DIGITS else repr(x)

    def repr_str(self, x: str, level: int) -> str:
        return repr(x[: self.maxstring + 1])

    def repr_instance(self, x: Any, level: int) -> str:
        try:
            text = " ".join(str(x).split()) if isinstance(x, Exception) else repr(x)
        except Exception:  # a foreign object: whatever its repr does, the message is still made
            return f"an object of type {type(x).__name__}"
        return text


_SHORT = _Short()


def _short(found: object) -> str:
    """Return what is neither text nor plain data by its `str` (a path, an exception)."""
    plain = found is None or isinstance(found, (bool, int, float, list, tuple, dict, set, bytes))
    if plain or hasattr(found, "ndim"):
        return visible(shown(found))
    try:
        return visible(" ".join(str(found).split()))
    except Exception:
        return f"an object of type {type(found).__name__}"


def _cut(text: str, longest: int) -> str:
    return text if len(text) <= longest else text[: longest - len(CUT)] + CUT


def _middle_cut(text: str) -> str:
    """Cut a source in its middle: both ends of a path tell something."""
    if len(text) <= LONGEST_WORDS:
        return text
    half = (LONGEST_WORDS - len(CUT)) // 2
    return text[:half] + CUT + text[-half:]
