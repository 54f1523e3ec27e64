"""Tables of plain data, read and checked field by field, from and to TOML and JSON as text.

The standard library reads TOML; it does not write it.
"""

import json
import math
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from .codec import Node
from .errors import InputError
from .setting import REQUIRED, ValueRule
from .values import A_TEXT, ANY, Number, Whole

WHOLE = Whole()
MAX_KEY_PARTS = 30
"""Maximum parts of a dotted key. The library's time and memory grow with their square: 17 s and
1.7 GB for a key of 40 kB."""
PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
HALF = re.compile("[\ud800-\udfff]|" + r"\\u[dD][89a-fA-F]")
"""What may be half a surrogate pair in a JSON text."""
LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{PART}){{{MAX_KEY_PARTS},}}+")


class Table(Node):
    """A table of a foreign file, of which single keys are read."""

    __slots__ = ()

    def __contains__(self, key: str) -> bool:
        return key in self.table

    def raw(self, key: str, default: Any = REQUIRED) -> Any:
        """Return the unchecked value of a key."""
        value = self.table.get(key, default)
        if value is REQUIRED:
            raise self.error("a value", "nothing", key)
        return value

    def number(self, key: str, default: Any = REQUIRED, rule: Number = ANY) -> float:
        """Return a number that meets a rule; by default any number, infinity included."""
        return self._checked(key, default, rule)  # type: ignore[no-any-return]

    def whole(self, key: str, default: Any = REQUIRED, rule: Whole = WHOLE) -> int:
        """Return an integer that meets a rule; by default one of at least 0."""
        return self._checked(key, default, rule)  # type: ignore[no-any-return]

    def text(self, key: str, default: Any = REQUIRED, rule: ValueRule = A_TEXT) -> str:
        """Return a text that meets a rule."""
        return self._checked(key, default, rule)  # type: ignore[no-any-return]

    def _checked(self, key: str, default: Any, rule: ValueRule) -> Any:
        """Return the checked value of a key, or the default where it is absent."""
        value = self.raw(key, default)
        return rule.checked(self.source, self.field(key), value) if key in self else value


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
