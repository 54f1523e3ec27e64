"""Text that is HTML already, and the escaping of other text."""

from collections.abc import Iterable
from typing import Any

ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "'": "&#39;", '"': "&#34;"})


class Markup(str):
    """A text that is HTML already; other texts that are added to it are escaped."""

    __slots__ = ()

    def __html__(self) -> "Markup":
        """Return this: other engines of templates ask for it."""
        return self

    def __add__(self, other: str) -> "Markup":
        return Markup(f"{self!s}{escape(other)!s}")

    def __radd__(self, other: str) -> "Markup":
        return Markup(f"{escape(other)!s}{self!s}")

    def join(self, parts: Iterable[Any]) -> "Markup":
        """Return parts with this between them."""
        return Markup(str(self).join(str(escape(part)) for part in parts))


def escape(value: object) -> Markup:
    """Return a value as HTML, also for attributes; markup, of other libraries too, as it is."""
    if (own := getattr(value, "__html__", None)) is not None:
        return value if isinstance(value, Markup) else Markup(own())
    return Markup(str(value).translate(ESCAPES))
