"""`pe set`: change keys of a study file; its comments and its order stay."""

import argparse
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from pe_core.base.errors import InputError
from pe_core.base.files import decode_text, encode_like, read_bytes, write_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import dotted, inline, load_toml

from ..sweep import KeyChange, TomlPath, named_study, read_changes, set_value
from .answers import ChangedKey, KeysAnswer
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered

ARRAY = "[["
BEFORE = re.compile(r"""\s*(?:"[^"]*"|'[^']*'|[^"'=])*=\s*""")
"""Begin of the header of an array's table, and what stands before a value."""


@not_noting_inputs()
def set_keys(_: StudyFiles, args: argparse.Namespace) -> Answer:
    """Change keys of a study file, all or none; the changed study is checked before it is written.
    `InputError` when a key or a value does not fit the study, or stands where only an editor can
    change it."""
    path = Path(args.study)
    old = read_bytes(path)
    text, changes = changed_text(decode_text(old), read_changes(args.changes), path)
    write_bytes(path, encode_like(text, old))
    return answered(args, KeysAnswer(str(path), tuple(changes)), _lines(path, changes)), DONE


def _lines(path: Path, changes: Sequence[ChangedKey]) -> Iterator[str]:
    for each in changes:
        before = "no value" if each.before is None else inline(each.before)
        yield f"{path}: {each.key}: {before} -> {inline(each.after)}"


def changed_text(
    text: str, changes: Sequence[KeyChange], path: Path
) -> tuple[str, list[ChangedKey]]:
    """Return the text of a study file with changes, and each of them. `InputError` as above."""
    changed: list[ChangedKey] = []
    made: dict[TomlPath, KeyChange] = {}
    for change in changes:
        wanted = load_toml(path, "study", text)
        placed = set_value(wanted, change, str(path))
        text = _changed(text, placed.path, wanted)
        if _loaded(text) != wanted:
            known = placed.before
            is_rows = isinstance(known, list) and dict in map(type, known)
            if is_rows or isinstance(known, dict):
                raise InputError(path, change.key, "a key of this table", inline(change.value))
            raise InputError(path, change.key, "a key in a line of its own", "another form")
        changed.append(ChangedKey(change.key, placed.before, change.value))
        made[placed.path] = change
    named_study(load_toml(path, "study", text), made, str(path), path.parent)
    return text, changed


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
        line = lines[start].lstrip()
        end = start + 1
        while (data := _loaded("".join(lines[start:end]))) is None and end < len(lines):
            end += 1  # a value of several lines
        if line.startswith("["):
            table = ()
            keys = _keys(data)
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
