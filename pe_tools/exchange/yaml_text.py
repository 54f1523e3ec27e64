"""The part of YAML that calibrations are written in: nested mappings of plain values.

Anchors, tags and multi-line texts are not supported; lists of values are optional. A file that has
them is refused with the line number, so it is never read wrongly.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pe_core.base.errors import InputError, shown

DEEPEST = 20
QUOTED = r"'[^']*'|\"[^\"\\]*\""
# Each part of the pattern takes all characters that it can, and stops at the first other one. So a
# line takes one pass, also with many blanks. Blanks after a key or a value are removed later.
LINE = re.compile(
    rf"^(?P<blanks> *)(?P<key>(?:{QUOTED}) *|[^\s'\"#\[{{&*!|>%@-][^:#]*):(?P<rest>( .*)?)$"
)
PLAIN_REST = re.compile(
    rf"^(?P<part> *(?P<value>(?:{QUOTED}) *|[^\s'\"#\[{{&*!|>%@][^#]*)?)(?P<comment>#.*)?$"
)
LIST = re.compile(r"^ *\[(?P<values>[^\[\]{}\"'#&*!|>%@]*)\] *( #.*)?$")
NUMBER = re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
WORDS = {"true": True, "false": False, "null": None, "~": None}


def parse_yaml_blocks(source: str, text: str, *, lists: bool = False) -> dict[str, Any]:
    """Return nested dicts of texts, numbers, booleans and None; with `lists`, also lists of them.

    Raises
    ------
    InputError
        When a line is not ``key: value`` or ``key:``, an indent fits no level, or a key is there
        twice.
    """
    root: dict[str, Any] = {}
    levels: list[tuple[int, dict[str, Any]]] = [(-1, root)]
    opened: tuple[int, dict[str, Any], str] | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        bare = line.strip()
        if not bare or bare.startswith(("#", "---", "%YAML")):
            continue
        blanks, key, value, is_value = _parsed(source, number, line, lists)
        if opened is not None and blanks > opened[0]:
            fresh: dict[str, Any] = {}
            opened[1][opened[2]] = fresh
            levels.append((blanks, fresh))
        while len(levels) > 1 and levels[-1][0] > blanks:
            levels.pop()
        if len(levels) == 1:
            levels.append((blanks, root))
        if levels[-1][0] != blanks or len(levels) > DEEPEST:
            raise InputError(source, f"line {number}", "an indent of a level above it", shown(line))
        table = levels[-1][1]
        if key in table:
            raise InputError(source, f"line {number}", "a key used once", shown(key))
        table[key] = value
        opened = None if is_value else (blanks, table, key)
    return root


def _parsed(source: str, number: int, line: str, lists: bool) -> tuple[int, str, Any, bool]:
    """Return indent, key and value of a line, and whether there is a value."""
    match = LINE.match(line.rstrip())
    if lists and match is not None and (listed := LIST.match(match["rest"])) is not None:
        values = [_value(word.strip()) for word in listed["values"].split(",") if word.strip()]
        return len(match["blanks"]), unquoted(match["key"]), values, True
    rest = PLAIN_REST.match(match["rest"]) if match else None
    if rest is not None and rest["comment"] and not rest["part"].endswith(" "):
        rest = None
    if match is None or rest is None:
        expected = "nested `key: value`, the part of YAML that calibrations use"
        raise InputError(source, f"line {number}", expected, shown(line.strip()))
    value = rest["value"] and rest["value"].rstrip(" ")
    return len(match["blanks"]), unquoted(match["key"]), _value(value), value is not None


def unquoted(text: str) -> str:
    """Return a text without its surrounding quotes."""
    text = text.rstrip(" ")
    return text[1:-1] if text[:1] in ("'", '"') else text


def _value(text: str | None) -> Any:
    if text is None:
        return None
    if text[:1] in ("'", '"'):
        return unquoted(text)
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    return float(text) if NUMBER.match(text) else text


KeyPath = tuple[str, ...]


def with_values(text: str, values: Mapping[KeyPath, str]) -> str:
    """Return a text with the values at some paths replaced; all other bytes stay.

    Parameters
    ----------
    text : str
        Nested ``key: value`` lines, such as `parse_yaml_blocks` takes.
    values : mapping of path to str
        New values by path: keys, the outermost first. A path that does not exist is ignored.
    """
    return "".join(
        _replaced(line, values[path]) if path in values else line for path, line in _lines(text)
    )


def comments_of(text: str) -> dict[KeyPath, str]:
    """Return the comments after keys without a value, by path."""
    return {
        path: line.partition("#")[2].strip()
        for path, line in _lines(text)
        if path and _opens_block(line) and "#" in line
    }


def with_comments(text: str, comments: Mapping[KeyPath, str]) -> str:
    """Return a text with other comments after keys; an empty comment removes the old one."""
    lines = []
    for path, line in _lines(text):
        if path in comments and _opens_block(line):
            key, mark, old = line.partition("#")
            end = old[len(old.rstrip("\r\n")) :]
            if mark:
                more = f"# {comments[path]}" if comments[path] else ""
                line = (key + more).rstrip() + end
        lines.append(line)
    return "".join(lines)


def _opens_block(line: str) -> bool:
    """Whether a line is a key without a value; a name with a quoted hash is not accepted."""
    match = LINE.match(line.rstrip())
    rest = PLAIN_REST.match(match["rest"]) if match else None
    if match is None or rest is None or "#" in match["key"]:
        return False
    return rest["value"] is None


def with_added_lines(text: str, path: KeyPath, more: Sequence[str]) -> str:
    """Return a text with lines added at the end of the block at a path.

    The lines `more` are indented like the block's own keys; the block is not empty.
    """
    lines = list(_lines(text))
    inside = [
        k for k, (line_path, _) in enumerate(lines) if line_path[: len(path)] == path and line_path
    ]
    first = next(k for k in inside if len(lines[k][0]) > len(path))
    indent = lines[first][1][: len(lines[first][1]) - len(lines[first][1].lstrip())]
    texts = [line for _, line in lines]
    last = inside[-1]
    end = "\r\n" if texts[first].endswith("\r\n") else "\n"
    texts[last] = texts[last].rstrip("\r\n") + end
    return "".join(
        [*texts[: last + 1], *(indent + line + end for line in more), *texts[last + 1 :]]
    )


def _lines(text: str) -> Iterator[tuple[KeyPath, str]]:
    """Yield each line with the path of its key; comments and empty lines have no path."""
    levels: list[tuple[int, str]] = []
    for line in text.splitlines(keepends=True):
        bare, match = line.strip(), LINE.match(line.rstrip())
        if not bare or bare.startswith(("#", "---", "%YAML")) or match is None:
            yield (), line
            continue
        blanks = len(match["blanks"])
        while levels and levels[-1][0] >= blanks:
            levels.pop()
        levels.append((blanks, unquoted(match["key"])))
        yield tuple(key for _, key in levels), line


def _replaced(line: str, value: str) -> str:
    """Return a line with another value; its comment stays."""
    match = LINE.match(line.rstrip())
    rest = PLAIN_REST.match(match["rest"]) if match else None
    if match is None or rest is None or rest["value"] is None:
        return line
    start, end = (match.start("rest") + offset for offset in rest.span("value"))
    old = line[start:end]
    return line[:start] + value + old[len(old.rstrip()) :] + line[end:]
