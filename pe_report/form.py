"""What JSON data has to look like: forms that check a value and name what is wrong in it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from pe_core import InputError

SHOWN = 60
"""Characters of a wrong value that a message repeats."""
LARGEST = 1e12
"""No figure is larger; what is comes from a damaged file."""


class Form(Protocol):
    """Anything that can check a value."""

    def check(self, value: Any, source: object, field: str) -> None:
        """Raise `InputError` naming the field, unless the value has this form."""


@dataclass(frozen=True)
class Amount:
    """A finite number from `low` to `high`."""

    low: float = -LARGEST
    high: float = LARGEST

    def check(self, value: Any, source: object, field: str) -> None:
        """Check a number."""
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not (is_number and self.low <= value <= self.high):  # NaN is not
            expected = f"a number from {self.low:g} to {self.high:g}"
            raise InputError(source, field, expected, short(value))


@dataclass(frozen=True)
class Text:
    """One printable line, of so many characters at most, that Markdown shows as it is."""

    longest: int = 200

    def check(self, value: Any, source: object, field: str) -> None:
        """Check a text."""
        if not (isinstance(value, str) and value.isprintable() and len(value) <= self.longest):
            expected = f"a printable line of up to {self.longest} characters"
            raise InputError(source, field, expected, short(value))
        if "|" in value or "`" in value:
            raise InputError(source, field, "a line without | and `", short(value))


@dataclass(frozen=True)
class Maybe:
    """null, or something of a form."""

    form: Form

    def check(self, value: Any, source: object, field: str) -> None:
        """Check what is not null."""
        if value is not None:
            self.form.check(value, source, field)


@dataclass(frozen=True)
class ListOf:
    """A list of things of one form: `count` of them, or at least one."""

    form: Form
    count: int | None = None

    def check(self, value: Any, source: object, field: str) -> None:
        """Check a list, each item under its number."""
        right = isinstance(value, list) and value and self.count in (None, len(value))
        if not right:
            expected = (
                "a list with something in it" if self.count is None else f"{self.count} items"
            )
            raise InputError(source, field, expected, short(value))
        for k, item in enumerate(value):
            self.form.check(item, source, f"{field}[{k}]")


@dataclass(frozen=True)
class Keyed:
    """An object with these keys and no others."""

    keys: Mapping[str, Form]

    def check(self, value: Any, source: object, field: str) -> None:
        """Check an object, each value under its key."""
        check_keys(value, self.keys, source, field)
        for key, form in self.keys.items():
            form.check(value[key], source, f"{field}.{key}")


@dataclass(frozen=True)
class Each:
    """An object of things of one form under any names, which are printable; at least one."""

    form: Form

    def check(self, value: Any, source: object, field: str) -> None:
        """Check an object, each value under its name."""
        if not (isinstance(value, dict) and value):
            raise InputError(source, field, "an object with something in it", short(value))
        for name, item in value.items():
            Text().check(name, source, field)
            self.form.check(item, source, f"{field}.{name}")


def check_keys(value: Any, keys: Collection[str], source: object, field: str) -> None:
    """Raise `InputError` unless the value is an object with these keys and no others."""
    if not isinstance(value, dict):
        raise InputError(source, field, "an object", short(value))
    for key in keys:
        if key not in value:
            raise InputError(source, field, f"{key!r}", "none")
    for key in value:
        if key not in keys:
            raise InputError(source, field, "what pe reproduce writes", short(key))


def short(value: Any) -> str:
    """Return a value as a message can repeat it."""
    if isinstance(value, int) and not -LARGEST <= value <= LARGEST:
        return "a whole number beyond all bounds"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, (dict, list)):
        return f"{'an object' if isinstance(value, dict) else 'a list'} of {len(value)}"
    line = ascii(value)
    return line if len(line) <= SHOWN else f"{line[: SHOWN - 3]}..."
