"""The part of YAML that calibrations are written in: nested mappings of plain values.

No anchors, tags or texts over several lines, and lists of values only where they are asked for: a
file that has them is refused with its line, not read wrong.
"""

from __future__ import annotations

import re
from typing import Any

from ..errors import InputError, shown

DEEPEST = 20
QUOTED = r"'[^']*'|\"[^\"\\]*\""
# Each part takes all it can and stops at a character that it cannot hold: a line takes the time of
# one pass, however many blanks are in it. Blanks at the end of a key or a value are cut off later.
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
    """Return nested dicts of texts, numbers, booleans and None; of `lists` of them, too.

    Raises
    ------
    InputError
        When a line is not ``key: value`` or ``key:``, an indent fits no level, a key comes twice.
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
    found = LINE.match(line.rstrip())
    if lists and found is not None and (listed := LIST.match(found["rest"])) is not None:
        values = [_value(word.strip()) for word in listed["values"].split(",") if word.strip()]
        return len(found["blanks"]), unquoted(found["key"]), values, True
    rest = PLAIN_REST.match(found["rest"]) if found else None
    if rest is not None and rest["comment"] and not rest["part"].endswith(" "):
        rest = None
    if found is None or rest is None:
        expected = "nested `key: value`, the part of YAML that calibrations use"
        raise InputError(source, f"line {number}", expected, shown(line.strip()))
    value = rest["value"] and rest["value"].rstrip(" ")
    return len(found["blanks"]), unquoted(found["key"]), _value(value), value is not None


def unquoted(text: str) -> str:
    """Return a text without the quotes round it."""
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
