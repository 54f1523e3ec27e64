"""Read gettext's .po files, the format that translators work with."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from pe_core.base.errors import InputError

PLACEHOLDER = re.compile(r"\{(\w+)\}")
KEYWORDS = ("msgid", "msgstr")


def placeholders(message: str) -> tuple[str, ...]:
    """Return the names of a message's placeholders, in their order."""
    return tuple(PLACEHOLDER.findall(message))


def read_po(path: Path) -> dict[str, str]:
    """Return the translations of a .po file by message; those that are empty are left out.

    Contexts and plural forms are not used: a message is one text.

    Raises
    ------
    InputError
        When a line is none of a .po file.
    """
    translations: dict[str, str] = {}
    fields: dict[str, list[str]] = {}
    current: list[str] = []
    for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        keyword, _, quoted = line.partition(" ")
        if keyword in KEYWORDS:
            if keyword == "msgid":
                _add(translations, fields)
                fields = {}
            current = fields[keyword] = []
            line = quoted
        current.append(_unquoted(path, number, line))
    _add(translations, fields)
    return translations


def _add(translations: dict[str, str], fields: dict[str, list[str]]) -> None:
    message, translation = ("".join(fields.get(name, ())) for name in KEYWORDS)
    if message and translation:
        translations[message] = translation


def _unquoted(path: Path, number: int, text: str) -> str:
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        value = None
    if not isinstance(value, str):
        raise InputError(path, f"line {number}", "msgid or msgstr with a text in quotes", text)
    return value
