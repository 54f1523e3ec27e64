"""Changes of a study's keys as they are typed: ``sensor.roof.model=Pandar64``. One parser and one
set of messages for `pe set`, for ``--set`` and for the values that a sweep tries."""

import copy
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pe_core.base.errors import InputError, one_of, shown
from pe_core.base.table_reader import dotted
from pe_core.scene import Vehicle
from pe_core.study import Study, study_from_dict

PART = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY = re.compile(rf"\s*({PART}(?:\.{PART})*)\s*=(.*)", re.DOTALL)
PARTS = re.compile(PART)
RANGE = re.compile(r"(\d{1,9}):(\d{1,9})")
MAX_RUNS = 10_000  # A sweep of more runs is taken for a typing error
MAX_PARTS = 30
SOURCE = "command line"
OPENING = "[{"
CLOSING = "]}"
QUOTES = "\"'"
TomlPath = tuple[str | int, ...]  # Keys of tables, and indices in arrays of tables


class KeyChange(NamedTuple):
    """A key of a study as the user wrote it, and its new value with the text of that. In the path,
    an element of an array of tables has its name, or its index from 0."""

    key: str
    path: tuple[str, ...]
    text: str
    value: Any


def read_changes(texts: Sequence[str]) -> tuple[KeyChange, ...]:
    """Read changes from the command line. `InputError` for one that is not ``KEY=VALUE``, has no
    value, or repeats a key."""
    changes = []
    for change, *others in read_tried(texts):
        if others:
            found = ", ".join(each.text for each in (change, *others))
            raise InputError(SOURCE, change.key, "one value", shown(found))
        changes.append(change)
    return tuple(changes)


def read_tried(texts: Sequence[str]) -> tuple[tuple[KeyChange, ...], ...]:
    """Read the changes that a sweep tries: of each key those of ``KEY=VALUE,VALUE``. Values are
    those of TOML, a text that is none is a string. `InputError` for a text that is none of these,
    has no value or a value twice, or repeats a key."""
    tried = tuple(map(_tried, texts))
    paths = [changes[0].path for changes in tried]
    for changes in tried:
        if paths.count(changes[0].path) > 1:
            raise InputError(SOURCE, changes[0].key, "each key once", "the key twice")
    return tried


def _tried(text: str) -> tuple[KeyChange, ...]:
    match = KEY.fullmatch(text)
    if match is None:
        expected = "KEY=VALUE, the key as in a study with dots between its parts"
        raise InputError(SOURCE, "", expected, shown(text))
    key = match[1]
    path = tuple(part.strip("\"'") for part in PARTS.findall(key))
    if len(path) > MAX_PARTS:
        raise InputError(SOURCE, "", f"keys of at most {MAX_PARTS} parts", f"{len(path)}")
    texts = Counter(value for part in _split(match[2]) for value in _counted(part.strip()))
    if "" in texts:
        raise InputError(SOURCE, key, "a value", shown(match[2]))
    if twice := [value for value, count in texts.items() if count > 1]:
        raise InputError(SOURCE, key, "each value once", f"{twice[0]} twice")
    return tuple(KeyChange(key, path, value, _value(value)) for value in texts)


def _counted(text: str) -> Sequence[str]:
    """Return the whole numbers from A up to, but not, B of "A:B"; of others the text itself."""
    if (found := RANGE.fullmatch(text)) is None:
        return [text]
    first = int(found[1])
    end = int(found[2])
    if not 0 < end - first <= MAX_RUNS:
        raise InputError(SOURCE, "range", f"A:B with 1 to {MAX_RUNS:,} numbers", shown(text))
    return [str(number) for number in range(first, end)]


def _split(text: str) -> Iterator[str]:
    """Split at commas that are in neither a list, a table nor quotes."""
    depth = 0
    quote = ""
    start = 0
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


class Placed(NamedTuple):
    """Where a change was made: its path with the index of each element of a list, and the value
    before, None for none."""

    path: TomlPath
    before: Any


def set_value(data: dict[str, Any], change: KeyChange, source: str) -> Placed:
    """Change a value in a study's plain data; missing tables on the path are created."""
    node: Any = data
    path: TomlPath = ()
    for number, part in enumerate(change.path, 1):
        if not isinstance(node, list | dict):
            at = ".".join(change.path[: number - 1])
            place = "before the last dot" if number == len(change.path) else f"at {at}"
            raise InputError(source, change.key, f"a table {place}", shown(node))
        key: Any = _index(node, part, change, source) if isinstance(node, list) else part
        path = (*path, key)
        if number == len(change.path):
            before = node[key] if isinstance(node, list) else node.get(key)
            node[key] = copy.deepcopy(change.value)
            return Placed(path, before)
        node = node[key] if isinstance(node, list) else node.setdefault(part, {})
    raise AssertionError("a key has a part")


def _index(elements: list[Any], part: str, change: KeyChange, source: str) -> int:
    """Return the index of a list's element from its name or number."""
    tables = (each if isinstance(each, dict) else {} for each in elements)
    names = [each.get("name", each.get("preset")) for each in tables]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(elements):
        return int(part)
    choices = [str(name) for name in names if name is not None]
    expected = one_of(choices, part) if choices else f"an index from 0 to {len(elements) - 1}"
    raise InputError(source, change.key, expected, shown(part))


def changed_study(
    data: Mapping[str, Any],
    changes: Sequence[KeyChange],
    source: str,
    folder: Path,
    *,
    starts_anywhere: bool = False,
    vehicle: Vehicle | None = None,
) -> Study:
    """Return the study of plain data with changes; the data stay. Errors name keys as they were
    typed. For the other parameters see `study_from_dict`."""
    changed = dict(copy.deepcopy(data)) if changes else dict(data)
    paths = {set_value(changed, change, source).path: change for change in changes}
    return named_study(
        changed, paths, source, folder, starts_anywhere=starts_anywhere, vehicle=vehicle
    )


def named_study(
    data: Mapping[str, Any],
    changes: Mapping[TomlPath, KeyChange],
    source: str,
    folder: Path,
    *,
    starts_anywhere: bool = False,
    vehicle: Vehicle | None = None,
) -> Study:
    """Return the study of plain data in which changes were made, by where they are. An error at
    ``sensor[0].model`` names ``sensor.roof.model``, if that was typed."""
    try:
        return study_from_dict(
            data, source, folder, starts_anywhere=starts_anywhere, vehicle=vehicle
        )
    except InputError as error:
        field = error.field
        for path, change in changes.items():
            parts = [dotted(part) for part in change.path]
            for number, key in enumerate(path):
                if field.startswith(f"{'.'.join(parts[:number])}[{key}]"):
                    field = field.replace(f"[{key}]", f".{parts[number]}", 1)
        raise InputError(error.source, field, error.expected, error.found) from None
