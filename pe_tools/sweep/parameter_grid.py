"""The runs of a sweep: every study with every combination of changes, and their folders' names.

A change is given as ``sensor.roof.model=Pandar64,HDL-64E``.
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import math
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.file_stem import is_reserved
from pe_core.scene import Vehicle
from pe_core.study import Study, load_study_data, study_from_dict

from .sweep_runner import SweepRun

UNSAFE = re.compile(r"[^A-Za-z0-9._=+-]+")
MAX_NAME_LENGTH = 100
"""Characters of a name; a longer one is cut and gets a hash."""
HASH_BYTES = 4


def folder_names(runs: Sequence[tuple[str, Mapping[str, str]]]) -> list[str]:
    """Return a folder name for each run: study and changes, ``car,sensor.roof.model=Pandar64``.

    Characters that are not allowed in names become hyphens. Such names, long names, and names that
    differ only in case end in a hash of study and changes.
    """
    words = [(name, *(f"{key}={text}" for key, text in changes.items())) for name, changes in runs]
    plain = [",".join(UNSAFE.sub("-", word) for word in each) for each in words]
    alike = Counter(name.casefold() for name in plain)
    return [
        _name(name, each, alike[name.casefold()] > 1)
        for name, each in zip(plain, words, strict=True)
    ]


def _name(plain: str, words: tuple[str, ...], alike: bool) -> str:
    short = plain[:MAX_NAME_LENGTH].strip("-.") or "run"
    if short == ",".join(words) and not alike and not is_reserved(short):
        return short
    content = "\0".join(words).encode("utf-8", "surrogatepass")
    digest = hashlib.blake2b(content, digest_size=HASH_BYTES)
    short = f"run-{short}" if is_reserved(short) else short  # as con.toml is, con.2-1f is one, too
    return f"{short}-{digest.hexdigest()}"


PART = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
KEY = re.compile(rf"\s*({PART}(?:\.{PART})*)\s*=(.*)", re.DOTALL)
PARTS = re.compile(PART)
MAX_PARTS = 30
SOURCE = "--set"
OPENING, CLOSING, QUOTES = "[{", "]}", "\"'"


@dataclass(frozen=True, slots=True)
class TriedKey:
    """A key of a study as the user wrote it, and the values that are tried.

    In its path, an element of an array of tables has its name, or its index from 0. Values are
    those of TOML, a text that is none is a string; texts are as the user wrote them.
    """

    key: str
    path: tuple[str, ...]
    values: tuple[Any, ...]
    texts: tuple[str, ...]


def read_settings(texts: Sequence[str]) -> tuple[TriedKey, ...]:
    """Read settings from the command line.

    `InputError` for one that is not ``KEY=VALUE,VALUE``, has no value or a value twice, or repeats
    a key.
    """
    settings = tuple(map(_setting, texts))
    keys = [setting.path for setting in settings]
    for setting in settings:
        if keys.count(setting.path) > 1:
            raise InputError(SOURCE, setting.key, "each key once", "the key twice")
    return settings


def _setting(text: str) -> TriedKey:
    match = KEY.fullmatch(text)
    if match is None:
        expected = "KEY=VALUE,VALUE, the key as in a study with dots between its parts"
        raise InputError(SOURCE, "text", expected, shown(text))
    key, listed = match[1], match[2]
    path = tuple(part.strip("\"'") for part in PARTS.findall(key))
    if len(path) > MAX_PARTS:
        raise InputError(SOURCE, "text", f"keys of at most {MAX_PARTS} parts", f"{len(path)}")
    texts = tuple(part.strip() for part in _split(listed))
    if "" in texts:
        raise InputError(SOURCE, key, "values with commas between them", shown(listed))
    if len(set(texts)) < len(texts):
        twice = next(value_text for value_text, count in Counter(texts).items() if count > 1)
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


MAX_RUNS = 10_000
"""A sweep of more runs is taken for a typing error."""
Made = dict[str, str]


def sweep_runs(
    files: Mapping[str, str | Path],
    settings: Sequence[TriedKey],
    options: Callable[[Study], Study] = lambda study: study,
) -> list[SweepRun]:
    """Return the runs of study files by name, each with each combination of the settings' values.

    `options` are applied to every study after the changes. `InputError` for a file that is no
    study, a key or a value that does not fit it, or more than `MAX_RUNS` runs.
    """
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


def _changed_studies(path: Path, settings: Sequence[TriedKey]) -> Iterator[tuple[Made, Study]]:
    data, vehicles = load_study_data(path), dict[str, Vehicle | None]()
    choices = [range(len(setting.values)) for setting in settings]
    for numbers in itertools.product(*choices):
        changed, changes = copy.deepcopy(data), Made()
        for setting, number in zip(settings, numbers, strict=True):
            _set(changed, setting, setting.values[number], str(path))
            changes[setting.key] = setting.texts[number]
        study = _study(changed, path, changes)
        vehicle = vehicles.setdefault(
            repr(changed.get("vehicle")), study.vehicle
        )  # read each file once
        yield changes, replace(study, vehicle=vehicle)


def _study(data: dict[str, Any], path: Path, changes: Made) -> Study:
    """Build a study; an error message names the changes."""
    try:
        return study_from_dict(data, str(path), path.parent)
    except InputError as error:
        if not changes or error.source != str(path):
            raise
        changes_text = ", ".join(f"{key}={text}" for key, text in changes.items())
        raise error.at(f"{path} with {changes_text}") from None


def _set(data: dict[str, Any], setting: TriedKey, value: Any, source: str) -> None:
    """Change a value in a study's plain data; missing tables on the path are created."""
    *path, last = setting.path
    node: Any = data
    for number, part in enumerate(path):
        found = ".".join(setting.path[:number]) or "document"
        node = _inside(node, part, setting, source, found)
    if isinstance(node, list):
        node[_index(node, last, setting, source)] = copy.deepcopy(value)
    elif isinstance(node, dict):
        node[last] = copy.deepcopy(value)
    else:
        raise InputError(source, setting.key, "a table before the last dot", shown(node))


def _inside(here: Any, part: str, setting: TriedKey, source: str, found: str) -> Any:
    if isinstance(here, list):
        return here[_index(here, part, setting, source)]
    if isinstance(here, dict):
        return here.setdefault(part, {})
    raise InputError(source, setting.key, f"a table at {found}", shown(here))


def _index(elements: list[Any], part: str, setting: TriedKey, source: str) -> int:
    """Return the index of a list's element from its name or number."""
    names = [element.get("name") if isinstance(element, dict) else None for element in elements]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(elements):
        return int(part)
    choices = [str(name) for name in names if name is not None] or [f"0 to {len(elements) - 1}"]
    raise InputError(source, setting.key, f"one of {', '.join(choices)}", shown(part))
