"""The runs of a sweep: every study with every combination of changes, and their folders' names. A
change is given as ``sensor.roof.model=Pandar64,HDL-64E``."""

import copy
import hashlib
import itertools
import math
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from pe_core.base.errors import InputError, one_of, shown
from pe_core.scene import Vehicle
from pe_core.study import Study, load_study_data, study_from_dict

from .sweep_runner import SweepRun

UNSAFE = re.compile(r"[^A-Za-z0-9._=+-]+")
MAX_NAME_LENGTH = 100  # Characters of a name; a longer one is cut and gets a hash
HASH_BYTES = 4


def folder_names(runs: Sequence[tuple[str, Mapping[str, str]]]) -> list[str]:
    """Return a folder name for each run: study and changes, ``car,sensor.roof.model=Pandar64``.
    Characters that are not allowed in names become hyphens. Such names, long names, and names that
    differ only in case end in a hash of study and changes."""
    words = [(name, *(f"{key}={text}" for key, text in changes.items())) for name, changes in runs]
    plain = [",".join(UNSAFE.sub("-", word) for word in each) for each in words]
    alike = Counter(name.casefold() for name in plain)
    names = []
    for name, each in zip(plain, words, strict=True):
        short = name[:MAX_NAME_LENGTH].strip("-.") or "run"
        if short != ",".join(each) or alike[name.casefold()] > 1:
            content = "\0".join(each).encode("utf-8", "surrogatepass")
            digest = hashlib.blake2b(content, digest_size=HASH_BYTES).hexdigest()
            short = f"{short}-{digest}"
        names.append(short)
    return names


PART = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY = re.compile(rf"\s*({PART}(?:\.{PART})*)\s*=(.*)", re.DOTALL)
PARTS = re.compile(PART)
RANGE = re.compile(r"(\d{1,9}):(\d{1,9})")
MAX_RUNS = 10_000  # A sweep of more runs is taken for a typing error
MAX_PARTS = 30
SOURCE = "command line"
OPENING, CLOSING, QUOTES = "[{", "]}", "\"'"


class TriedKey(NamedTuple):
    """A key of a study as the user wrote it, and the values that are tried, by their texts. In its
    path, an element of an array of tables has its name, or its index from 0. Values are those of
    TOML, a text that is none is a string."""

    key: str
    path: tuple[str, ...]
    values: dict[str, Any]


def read_settings(texts: Sequence[str]) -> tuple[TriedKey, ...]:
    """Read settings from the command line. `InputError` for one that is not ``KEY=VALUE,VALUE``,
    has no value or a value twice, or repeats a key."""
    settings = tuple(map(_setting, texts))
    keys = [setting.path for setting in settings]
    for setting in settings:
        if keys.count(setting.path) > 1:
            raise InputError(SOURCE, setting.key, "each key once", "the key twice")
    return settings


def _setting(text: str) -> TriedKey:
    match = KEY.fullmatch(text)
    if match is None:
        expected = "KEY=VALUE, the key as in a study with dots between its parts"
        raise InputError(SOURCE, "", expected, shown(text))
    key, listed = match[1], match[2]
    path = tuple(part.strip("\"'") for part in PARTS.findall(key))
    if len(path) > MAX_PARTS:
        raise InputError(SOURCE, "", f"keys of at most {MAX_PARTS} parts", f"{len(path)}")
    texts = Counter(value for part in _split(listed) for value in _counted(part.strip()))
    if "" in texts:
        raise InputError(SOURCE, key, "a value", shown(listed))
    if twice := [value for value, count in texts.items() if count > 1]:
        raise InputError(SOURCE, key, "each value once", f"{twice[0]} twice")
    return TriedKey(key, path, {value: _value(value) for value in texts})


def _counted(text: str) -> Sequence[str]:
    """Return the whole numbers from A up to, but not, B of "A:B"; of others the text itself."""
    if (found := RANGE.fullmatch(text)) is None:
        return [text]
    first, end = int(found[1]), int(found[2])
    if not 0 < end - first <= MAX_RUNS:
        raise InputError(SOURCE, "range", f"A:B with 1 to {MAX_RUNS:,} numbers", shown(text))
    return [str(number) for number in range(first, end)]


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


def sweep_runs(
    files: Mapping[str, str | Path],
    settings: Sequence[TriedKey],
    options: Callable[[Study], Study] = lambda study: study,
) -> list[SweepRun]:
    """Return the runs of study files by name, each with each combination of the settings' values.
    `options` are applied to every study after the changes. `InputError` for a file that is no
    study, a key or a value that does not fit it, or more than `MAX_RUNS` runs."""
    count = len(files) * math.prod(len(setting.values) for setting in settings)
    if count > MAX_RUNS:
        raise InputError(SOURCE, "runs", f"at most {MAX_RUNS:,}", f"{count:,}")
    made = [
        (name, changes, options(study))
        for name, path in files.items()
        for changes, study in _changed_studies(Path(path), settings)
    ]
    names = folder_names([(name, changes) for name, changes, _ in made])
    return [
        SweepRun(folder, name, changes, study)
        for folder, (name, changes, study) in zip(names, made, strict=True)
    ]


def _changed_studies(
    path: Path, settings: Sequence[TriedKey]
) -> Iterator[tuple[dict[str, str], Study]]:
    data, vehicles = load_study_data(path), dict[str, Vehicle | None]()
    for texts in itertools.product(*(setting.values for setting in settings)):
        changed, changes = copy.deepcopy(data), dict[str, str]()
        for setting, text in zip(settings, texts, strict=True):
            set_value(changed, setting, setting.values[text], str(path))
            changes[setting.key] = text
        try:
            study = study_from_dict(changed, str(path), path.parent)
        except InputError as error:
            if not changes or error.source != str(path):
                raise
            named = ", ".join(f"{key}={text}" for key, text in changes.items())
            raise error.at(f"{path} with {named}") from None
        vehicle = vehicles.setdefault(repr(changed.get("vehicle")), study.vehicle)  # read once
        yield changes, replace(study, vehicle=vehicle)


def set_value(
    data: dict[str, Any], setting: TriedKey, value: Any, source: str
) -> tuple[tuple[str | int, ...], Any]:
    """Change a value in a study's plain data; missing tables on the path are created. Return the
    path, with the index of each element of a list, and the value before."""
    node: Any = data
    path: tuple[str | int, ...] = ()
    for number, part in enumerate(setting.path, 1):
        if not isinstance(node, list | dict):
            at = ".".join(setting.path[: number - 1])
            place = "before the last dot" if number == len(setting.path) else f"at {at}"
            raise InputError(source, setting.key, f"a table {place}", shown(node))
        key: Any = _index(node, part, setting, source) if isinstance(node, list) else part
        path = (*path, key)
        if number == len(setting.path):
            before = node[key] if isinstance(node, list) else node.get(key)
            node[key] = copy.deepcopy(value)
            return path, before
        node = node[key] if isinstance(node, list) else node.setdefault(part, {})
    raise AssertionError("a key has a part")


def _index(elements: list[Any], part: str, setting: TriedKey, source: str) -> int:
    """Return the index of a list's element from its name or number."""
    tables = (each if isinstance(each, dict) else {} for each in elements)
    names = [each.get("name", each.get("preset")) for each in tables]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(elements):
        return int(part)
    choices = [str(name) for name in names if name is not None]
    expected = one_of(choices, part) if choices else f"an index from 0 to {len(elements) - 1}"
    raise InputError(source, setting.key, expected, shown(part))
