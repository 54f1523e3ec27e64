"""Reading a table of plain data field by field, with one clear line for whatever is wrong."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from ..errors import InputError

REQUIRED = object()


class Table:
    """A table of a file: what is read is ticked off, and `finish` complains about the rest.

    Parameters
    ----------
    data : mapping
    source : str
        The file's name, for messages.
    path : str
        Where the table stands in the file (``sensor[0]``).
    """

    def __init__(self, data: Any, source: str, path: str = "") -> None:
        self.source, self.path = source, path
        if not isinstance(data, Mapping):
            raise InputError(source, path or "document", "a table", type(data).__name__)
        self._data = data
        self._read: set[str] = set()

    def __contains__(self, key: str) -> bool:
        return key in self._data

    def field(self, key: str) -> str:
        """Full name of a key, for messages."""
        return f"{self.path}.{key}" if self.path else key

    def error(self, key: str, expected: str, found: object) -> InputError:
        """Return the error that says a key's value is wrong."""
        return InputError(self.source, self.field(key), expected, found)

    def raw(self, key: str, default: Any = REQUIRED) -> Any:
        """Return the value as it is."""
        self._read.add(key)
        if key in self._data:
            return self._data[key]
        if default is REQUIRED:
            raise self.error(key, "a value", "nothing")
        return default

    def number(self, key: str, default: Any = REQUIRED) -> float:
        """Return a number, infinity included."""
        value = self.raw(key, default)
        if value is default and default is not REQUIRED:
            return default  # type: ignore[no-any-return]
        if isinstance(value, bool) or not isinstance(value, (int, float)) or math.isnan(value):
            raise self.error(key, "a number", repr(value))
        return float(value)

    def whole(self, key: str, default: Any = REQUIRED, least: int = 0) -> int:
        """Return a whole number of at least `least`."""
        value = self.raw(key, default)
        if value is default and default is not REQUIRED:
            return default  # type: ignore[no-any-return]
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise self.error(key, f"a whole number >= {least}", repr(value))
        return value

    def text(self, key: str, default: Any = REQUIRED, choices: Sequence[str] = ()) -> str:
        """Return a text, one of the choices if there are any."""
        value = self.raw(key, default)
        if value is default and default is not REQUIRED:
            return default  # type: ignore[no-any-return]
        if not isinstance(value, str) or not value or (choices and value not in choices):
            expected = f"one of {', '.join(choices)}" if choices else "a text"
            raise self.error(key, expected, repr(value))
        return value

    def numbers(self, key: str, count: int, default: Any = REQUIRED) -> tuple[float, ...]:
        """Return `count` numbers."""
        value = self.raw(key, default)
        if value is default and default is not REQUIRED:
            return default  # type: ignore[no-any-return]
        ok = isinstance(value, (list, tuple)) and len(value) == count
        if not ok or any(isinstance(v, bool) or not isinstance(v, (int, float)) for v in value):
            raise self.error(key, f"a list of {count} numbers", repr(value))
        if any(math.isnan(v) for v in value):
            raise self.error(key, f"a list of {count} numbers", repr(value))
        return tuple(float(v) for v in value)

    def texts(self, key: str, default: Any = REQUIRED) -> tuple[str, ...]:
        """Return a list of texts."""
        value = self.raw(key, default)
        if value is default and default is not REQUIRED:
            return default  # type: ignore[no-any-return]
        if not isinstance(value, (list, tuple)) or not all(isinstance(v, str) for v in value):
            raise self.error(key, "a list of texts", repr(value))
        return tuple(value)

    def table(self, key: str) -> Table:
        """Return a sub-table; an empty one when it is absent."""
        return Table(self.raw(key, {}), self.source, self.field(key))

    def tables(self, key: str) -> list[Table]:
        """Return an array of tables; empty when it is absent."""
        value = self.raw(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"an array of tables [[{self.field(key)}]]", repr(value))
        return [Table(v, self.source, f"{self.field(key)}[{i}]") for i, v in enumerate(value)]

    def finish(self) -> None:
        """Raise for the first key that nobody has read."""
        for key in self._data:
            if key not in self._read:
                known = ", ".join(sorted(self._read))
                raise self.error(key, f"one of {known}", "an unknown key")
