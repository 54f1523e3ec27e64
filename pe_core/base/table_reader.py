"""Tables of plain data, read and checked field by field, from and to TOML and JSON as text.

The standard library reads TOML; it does not write it.
"""

import json
import math
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

from .errors import InputError, naming_table, one_of, shown
from .values import A_TEXT, ANY, Name, Number, Whole, choice, listed, real

REQUIRED = object()
WHOLE = Whole()
MAX_KEY_PARTS = 30
"""Maximum parts of a dotted key. The library's time and memory grow with their square: 17 s and
1.7 GB for a key of 40 kB."""
PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
HALF = re.compile("[\ud800-\udfff]|" + r"\\u[dD][89a-fA-F]")
"""What may be half a surrogate pair in a JSON text."""
LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{PART}){{{MAX_KEY_PARTS},}}+")


class Table:
    """A table of a file. Keys that are read are noted; `finish` reports the first unknown key.

    `source`: The file's name, for messages.
    `path`: Position of the table in the file (``sensor[0]``).
    """

    def __init__(self, data: Any, source: str, path: str = "") -> None:
        self.source = source
        self.path = path
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

    def naming(self) -> AbstractContextManager[None]:
        """Name this table in errors about what is made of it; errors about the file stay."""
        return naming_table(self.source, self.path)

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

    def table(self, key: str) -> "Table":
        """Return a sub-table; an empty one if the key is absent."""
        return Table(self.raw(key, {}), self.source, self.field(key))

    def tables(self, key: str) -> "list[Table]":
        """Return an array of tables; an empty list if the key is absent."""
        value = self.raw(key, [])
        if not isinstance(value, list):
            raise self.error(key, f"an array of tables [[{self.field(key)}]]", shown(value))
        return [Table(v, self.source, f"{self.field(key)}[{i}]") for i, v in enumerate(value)]

    def finish(self) -> None:
        """Raise `InputError` for the first key that was not read."""
        for key in self._data:
            if key not in self._read:
                raise self.error(key, one_of(sorted(self._read), key), "an unknown key")


def load_toml(source: object, field: str, text: str) -> dict[str, Any]:
    """Return the tables of a TOML text. `InputError` when it is not TOML, is nested too deep, or
    has an integer of thousands of digits or a key of more than `MAX_KEY_PARTS` parts."""
    if found := LONG_KEY.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise InputError(source, f"line {line}", f"keys of at most {MAX_KEY_PARTS} parts", "more")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise InputError(source, field, "valid TOML", "lists or tables nested too deep") from None
    except ValueError as error:  # of tomllib, or of int() for too many digits
        raise InputError(source, field, "valid TOML", error) from None


def dumps(data: Mapping[str, Any]) -> str:
    """Return TOML text of nested mappings, lists and scalars; floats round-trip exactly. A mapping
    becomes a table, a list of mappings an array of tables. Values of None are left out."""
    return "\n".join(_table(data, "")).lstrip("\n") + "\n"


def _table(data: Mapping[str, Any], path: str) -> list[str]:
    items = {k: v for k, v in data.items() if v is not None}
    lines = [f"{dotted(k)} = {inline(v)}" for k, v in items.items() if not _is_section(v)]
    for key, value in items.items():
        name = f"{path}.{dotted(key)}" if path else dotted(key)
        if isinstance(value, Mapping):
            lines += ["", f"[{name}]", *_table(value, name)]
        elif _is_section(value):
            for element in value:
                lines += ["", f"[[{name}]]", *_table(element, name)]
    return lines


def _is_section(value: object) -> bool:
    if isinstance(value, list):
        return bool(value) and all(isinstance(v, Mapping) for v in value)
    return isinstance(value, Mapping)


def dotted(key: str) -> str:
    """Return a part of a dotted key, in quotes where it needs them."""
    plain = key and all(c.isascii() and (c.isalnum() or c in "-_") for c in key)
    return key if plain else inline(key)


def inline(value: object) -> str:
    """Return a value in one line of TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        words = {math.inf: "inf", -math.inf: "-inf"}
        # The repr of a NumPy float names its type.
        return "nan" if math.isnan(value) else words.get(value) or float.__repr__(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(inline(v) for v in value) + "]"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{dotted(k)} = {inline(v)}" for k, v in value.items()) + " }"
    raise TypeError(f"no TOML for {type(value).__name__}")


def dump_json(data: Any, indent: int | None = 2) -> str:
    """Return JSON text, in one line without `indent`; floats round-trip exactly. Infinity and NaN
    are refused (see `finite`)."""
    return json.dumps(data, indent=indent, ensure_ascii=False, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """Return data that JSON can hold: infinity becomes the text ``inf`` or ``-inf``, NaN null."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [finite(v) for v in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return str(value)
    if isinstance(value, float) and value != value:
        return None
    return value


def parse_json(source: object, text: str | bytes, *, infinite: bool = False) -> Any:
    """Return the data of a JSON text; bytes are in UTF-8.

    What Python takes but no file could be written of is refused: NaN, infinity (unless `infinite`
    allows it), numbers beyond those of 64 bits, halves of surrogate pairs.

    Raises `InputError`.
    """

    def constant(word: str) -> float:
        if infinite and word.endswith("Infinity"):
            return float(word)
        raise ValueError(f"{word}, which is no JSON")

    def number(digits: str) -> float:
        value = float(digits)
        if math.isinf(value):
            raise ValueError(f"{digits[:20]}, which is too large")
        return value

    try:
        text = text if isinstance(text, str) else text.decode("utf-8-sig")
        data = json.loads(text, parse_constant=constant, parse_float=number)
        if HALF.search(text):
            json.dumps(data, ensure_ascii=False).encode()
        return data
    except RecursionError:
        raise InputError(source, "file", "valid JSON", "too many nested brackets") from None
    except UnicodeEncodeError:
        raise InputError(source, "file", "valid JSON", "half a surrogate pair") from None
    except ValueError as error:
        raise InputError(source, "file", "valid JSON", error) from None
