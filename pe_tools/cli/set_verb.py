"""`pe set`: change keys of a study file; its comments and its order stay."""

import argparse
import copy
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pe_core.base.errors import InputError, shown
from pe_core.base.files import decode_text, encode_like, read_bytes, write_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import dotted, inline, load_toml
from pe_core.study import study_from_dict

from ..sweep import read_settings, set_value
from .terminal import DONE, Answer

ARRAY, BEFORE = "[[", re.compile(r"""\s*(?:"[^"]*"|'[^']*'|[^"'=])*=\s*""")
"""Begin of the header of an array's table, and what stands before a value."""
TomlPath = tuple[str | int, ...]  # Keys of tables, and indices in arrays of tables


def add_set_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``set`` to a parser."""
    about = "sensor.roof.model=Pandar64: a value of TOML, or a text without quotes"
    parser.add_argument("changes", nargs="+", metavar="KEY=VALUE", help=about)


@not_noting_inputs()
def set_keys(args: argparse.Namespace) -> Answer:
    """Change keys of a study file, all or none; the changed study is checked before it is written.
    `InputError` when a key or a value does not fit the study, or stands where only an editor can
    change it."""
    path = Path(args.study)
    old = read_bytes(path)
    text = decode_text(old)
    lines: list[str] = []
    typed: dict[TomlPath, Sequence[str]] = {}
    for setting in read_settings(args.changes):
        if len(setting.values) > 1:
            raise InputError("set", setting.key, "one value", shown(", ".join(setting.values)))
        (value,) = setting.values.values()
        data = load_toml(path, "study", text)
        wanted = copy.deepcopy(data)
        where, known = set_value(wanted, setting, value, str(path))
        text = _changed(text, where, wanted)
        if _loaded(text) != wanted:
            of_table = "a key of this table", inline(value)
            of_line = "a key in a line of its own", "another form"
            is_table = isinstance(known, dict) or (
                isinstance(known, list) and dict in map(type, known)
            )
            raise InputError(path, setting.key, *(of_table if is_table else of_line))
        told = "no value" if known is None else inline(known)
        lines.append(f"{path}: {setting.key}: {told} -> {inline(value)}")
        typed[where] = [*map(dotted, setting.path)]
    try:
        study_from_dict(load_toml(path, "study", text), str(path), path.parent)
    except InputError as error:
        field = _as_typed(error.field, typed)
        raise InputError(error.source, field, error.expected, error.found) from None
    write_bytes(path, encode_like(text, old))
    return "\n".join(lines), DONE


def _as_typed(field: str, typed: Mapping[TomlPath, Sequence[str]]) -> str:
    """Return a field of the loader, ``sensor[0].model``, as it was typed: ``sensor.roof.model``."""
    for path, parts in typed.items():
        for number, key in enumerate(path):
            if field.startswith(f"{'.'.join(parts[:number])}[{key}]"):
                field = field.replace(f"[{key}]", f".{parts[number]}", 1)
    return field


class _Statement(NamedTuple):
    """Lines `start` to `end` of a file: a key with its value, or the header of a table."""

    path: TomlPath
    start: int
    end: int
    is_header: bool = False


def _statements(lines: Sequence[str]) -> Iterator[_Statement]:
    """Yield what stands in a TOML file, each with the full path of its key or table."""
    counts: Counter[TomlPath] = Counter()
    table: TomlPath = ()
    start = 0
    while start < len(lines):
        line, end = lines[start].lstrip(), start + 1
        while (data := _loaded("".join(lines[start:end]))) is None and end < len(lines):
            end += 1  # a value of several lines
        if line.startswith("["):
            table, keys = (), _keys(data)
            for number, key in enumerate(keys, 1):
                table = (*table, key)
                if number == len(keys) and line.startswith(ARRAY):
                    counts[table] += 1
                if counts[table]:
                    table = (*table, counts[table] - 1)
            yield _Statement(table, start, end, True)
        elif data:
            keys = _keys(_loaded(f"{BEFORE.match(line)[0]}0"))  # type: ignore[index]
            yield _Statement((*table, *keys), start, end)
        start = end


def _loaded(text: str) -> dict[str, Any] | None:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return None


def _keys(data: Any) -> TomlPath:
    """Return the keys of one header, or of one key with dots."""
    keys: TomlPath = ()
    while isinstance(data, dict) and data:
        key, data = next(iter(data.items()))
        keys = (*keys, key)
    return keys


def _changed(text: str, path: TomlPath, wanted: Mapping[str, Any]) -> str:
    """Return a TOML text in which a key has the value that it has in `wanted`."""
    lines = text.splitlines(keepends=True)
    found = list(_statements(lines))
    for each in found:
        if not each.is_header and each.path == path[: len(each.path)]:
            old = "".join(lines[each.start : each.end])
            lines[each.start : each.end] = [_replaced(old, _value_at(wanted, each.path))]
            return "".join(lines)
    inside = [each for each in found if each.is_header and each.path == path[: len(each.path)]]
    table = max(inside, key=lambda each: len(each.path), default=_Statement((), 0, 0, True))
    keys = [dotted(str(key)) for key in path[len(table.path) :]]
    value = inline(_value_at(wanted, path))
    if len(keys) > 1 and not any(isinstance(key, int) for key in path):
        head = ".".join(dotted(str(key)) for key in path[:-1])
        return f"{text.rstrip()}\n\n[{head}]\n{keys[-1]} = {value}\n"
    place = table.end
    for each in found:  # behind the last key of the table
        if each.start >= table.end:
            if each.is_header:
                break
            place = each.end
    lines[:place] = [f"{''.join(lines[:place]).rstrip()}\n".lstrip("\n")]
    lines.insert(1, f"{'.'.join(keys)} = {value}\n")
    return "".join(lines)


def _replaced(old: str, value: Any) -> str:
    """Return a key's lines with another value; a comment behind it stays, in its column."""
    new = f"{BEFORE.match(old)[0]}{inline(value)}"  # type: ignore[index]
    for place in (match.start() for match in re.finditer("#", old)):
        if _loaded(old[:place]) is not None:
            column = place - old.rfind("\n", 0, place) - 1
            return f"{new.ljust(column - 1)} {old[place:]}"
    return f"{new}\n"


def _value_at(data: Any, path: TomlPath) -> Any:
    for key in path:
        data = data[key]
    return data
