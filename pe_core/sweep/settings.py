"""Changes of a study that a sweep tries: ``sensor.roof.model=Pandar64,HDL-64E``."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError, shown

PART = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY = re.compile(rf"\s*({PART}(?:\.{PART})*)\s*=(.*)", re.DOTALL)
PARTS = re.compile(PART)
MOST_PARTS = 30
SOURCE = "--set"
OPENING, CLOSING, QUOTES = "[{", "]}", "\"'"


@dataclass(frozen=True, slots=True)
class TriedKey:
    """A key of a study, and the values that are tried.

    Attributes
    ----------
    key : str
        As it was written.
    path : tuple of str
        Its parts; those of an array of tables are told by their names, or numbers from 0.
    values : tuple
        Of TOML's kinds; what is none of them is a text.
    texts : tuple of str
        The values as they were written.
    """

    key: str
    path: tuple[str, ...]
    values: tuple[Any, ...]
    texts: tuple[str, ...]


def read_settings(texts: Sequence[str]) -> tuple[TriedKey, ...]:
    """Read settings from the command line.

    Raises
    ------
    InputError
        One is not ``KEY=VALUE,VALUE``, has no value, the same twice, or a key that another has.
    """
    settings = tuple(map(_setting, texts))
    keys = [setting.path for setting in settings]
    for setting in settings:
        if keys.count(setting.path) > 1:
            raise InputError(SOURCE, setting.key, "each key once", "two of it")
    return settings


def _setting(text: str) -> TriedKey:
    found = KEY.fullmatch(text)
    if found is None:
        expected = "KEY=VALUE,VALUE, the key as in a study with dots between its parts"
        raise InputError(SOURCE, "text", expected, shown(text))
    key, listed = found[1], found[2]
    path = tuple(part.strip("\"'") for part in PARTS.findall(key))
    if len(path) > MOST_PARTS:
        raise InputError(SOURCE, "text", f"keys of at most {MOST_PARTS} parts", f"{len(path)}")
    texts = tuple(part.strip() for part in _split(listed))
    if "" in texts:
        raise InputError(SOURCE, key, "values with commas between them", shown(listed))
    if len(set(texts)) < len(texts):
        twice = next(each for each, count in Counter(texts).items() if count > 1)
        raise InputError(SOURCE, key, "each value once", f"{twice} twice")
    return TriedKey(key, path, tuple(map(_value, texts)), texts)


def _split(text: str) -> Iterator[str]:
    """Split at commas that are in neither a list, a table nor quotes."""
    depth, quote, start = 0, "", 0
    for place, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in QUOTES:
            quote = letter
        elif letter == "," and depth == 0:
            yield text[start:place]
            start = place + 1
        else:
            depth += (letter in OPENING) - (letter in CLOSING)
    yield text[start:]


def _value(text: str) -> Any:
    """Return a value of TOML, or the text itself: names of models need no quotes."""
    try:
        read = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    value = read["value"]
    plain = isinstance(value, bool | int | float | str | list | dict)
    return value if plain and len(read) == 1 else text
