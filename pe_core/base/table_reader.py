"""A table of plain data, such as TOML gives, read and checked field by field."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from .errors import InputError, shown
from .values import A_TEXT, ANY, Name, Number, Whole, choice, listed, real

REQUIRED = object()
WHOLE = Whole()


class Table:
    """A table of a file. Keys that are read are noted; `finish` reports the first unknown key.

    Parameters
    ----------
    data : mapping
    source : str
        The file's name, for messages.
    path : str
        Position of the table in the file (``sensor[0]``).
    """

    def __init__(self, data: Any, source: str, path: str = "") -> None:
        self.source, self.path = source, path
        if not isinstance(data, Mapping):
            raise InputError(source, path or "document", "a table", type(data).__name__)
        self._data = data
        self._read: set[str] = set()

    def __contains__(self, key: str) -> bool:
        return key in self._data

    @property
    def data(self) -> Mapping[str, Any]:
        """The unchecked content."""
        return self._data

    @property
    def names(self) -> list[str]:
        """The keys, in the file's order."""
        return list(self._data)

    def field(self, key: str) -> str:
        """Full name of a key, for messages."""
        return f"{self.path}.{key}" if self.path else key

    def error(self, key: str, expected: str, found: object) -> InputError:
        """Return an `InputError` about the value of a key."""
        return InputError(self.source, self.field(key), expected, found)

    @contextmanager
    def naming(self) -> Iterator[None]:
        """Name this table in errors about what is made of it; errors about the file stay."""
        try:
            yield
        except InputError as error:
            if error.source == self.source:
                raise
            raise self.error(error.field, error.expected, error.found) from None

    def raw(self, key: str, default: Any = REQUIRED) -> Any:
        """Return the unchecked value of a key."""
        self._read.add(key)
        if key in self._data:
            return self._data[key]
        if default is REQUIRED:
            raise self.error(key, "a value", "nothing")
        return default

    def number(self, key: str, default: Any = REQUIRED, rule: Number = ANY) -> float:
        """Return a number that meets a rule; by default any number, infinity included."""
        return self._checked(key, default, lambda v: rule.checked(self.source, self.field(key), v))

    def whole(self, key: str, default: Any = REQUIRED, rule: Whole = WHOLE) -> int:
        """Return an integer that meets a rule; by default one of at least 0."""
        return self._checked(key, default, lambda v: rule.checked(self.source, self.field(key), v))

    def text(
        self, key: str, default: Any = REQUIRED, choices: Sequence[str] = (), rule: Name = A_TEXT
    ) -> str:
        """Return a text that meets a rule, or one of the choices if these are given."""
        field = self.field(key)
        if choices:
            return self._checked(key, default, lambda v: choice(self.source, field, v, choices))
        return self._checked(key, default, lambda v: rule.checked(self.source, field, v))

    def numbers(self, key: str, count: int, default: Any = REQUIRED) -> tuple[float, ...]:
        """Return `count` numbers."""

        def checked(value: Any) -> tuple[float, ...]:
            items = listed(value, count)
            if items is None or len(items) != count or not all(ANY.holds(real(v)) for v in items):
                raise self.error(key, f"a list of {count} numbers", shown(value))
            return tuple(map(real, items))

        return self._checked(key, default, checked)

    def texts(self, key: str, default: Any = REQUIRED) -> tuple[str, ...]:
        """Return a list of texts."""

        def checked(value: Any) -> tuple[str, ...]:
            items = listed(value)
            if items is None or not all(isinstance(v, str) for v in items):
                raise self.error(key, "a list of texts", shown(value))
            return tuple(items)

        return self._checked(key, default, checked)

    def _checked(self, key: str, default: Any, check: Callable[[Any], Any]) -> Any:
        """Return the checked value of a key, or the unchecked default."""
        value = self.raw(key, default)
        return value if value is default and default is not REQUIRED else check(value)

    def table(self, key: str) -> Table:
        """Return a sub-table; an empty one if the key is absent."""
        return Table(self.raw(key, {}), self.source, self.field(key))

    def tables(self, key: str) -> list[Table]:
        """Return an array of tables; an empty list if the key is absent."""
        value = self.raw(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"an array of tables [[{self.field(key)}]]", shown(value))
        return [Table(v, self.source, f"{self.field(key)}[{i}]") for i, v in enumerate(value)]

    def finish(self) -> None:
        """Raise `InputError` for the first key that was not read."""
        for key in self._data:
            if key not in self._read:
                known = ", ".join(sorted(self._read))
                raise self.error(key, f"one of {known}", "an unknown key")
