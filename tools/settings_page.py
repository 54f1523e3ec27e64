#!/usr/bin/env python3
"""Write docs/settings.md: all settings that the engine declares, by key of the study file.

``tools/settings_page.py`` writes the page; a test compares it with the declarations.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from pe_core.search import LimitRule  # noqa: E402
from pe_core.study import (  # noqa: E402
    REQUIRED,
    Declared,
    Name,
    Number,
    OneOf,
    Pair,
    Setting,
    Several,
    Texts,
    Toggle,
    Triple,
    Whole,
    setting_keys,
    value_in_file,
)

PAGE = ROOT / "docs" / "settings.md"
HEAD = """# Settings

Numbers and switches of a study, by their table in the file: `height` below `[limits]` is
`limits.height` for `pe set`. Each has its values, its default, if any, and its meaning.
[study.md](study.md) explains the file. Blender's panels have most of them.
"""


def page() -> str:
    """Return the whole page: the settings of each table of the file below a heading."""
    lines = [HEAD]
    tables: dict[str, list[Declared]] = {}
    for row in setting_keys():
        tables.setdefault(row.key.rpartition(".")[0], []).append(row)
    for table, rows in tables.items():
        lines += ["", f"## [{table}]", ""] if table else [""]
        lines += [item(row.key.rpartition(".")[2], row.setting) for row in rows]
    return "\n".join(lines).replace("\n\n\n", "\n\n") + "\n"


def item(key: str, setting: Setting) -> str:
    """Return the line of one setting: type with unit, range and default, then its meaning."""
    parts = type_text(setting.rule), range_text(setting.rule), default_text(setting)
    values = ", ".join(part for part in parts if part)
    return f"- `{key}` ({values}): {setting.text}"


def type_text(rule: object) -> str:
    """Return the type of a rule's values, with their unit."""
    match rule:
        case Toggle():
            return ""
        case OneOf():
            return ""
        case Name():
            return "text"
        case Several():
            return "list"
        case Texts():
            return "texts"
        case Pair():
            return f"low, high{_unit(rule.rule.unit)}"
        case Triple():
            return f"three numbers{_unit(rule.rule.unit)}"
        case LimitRule():
            return "true" if rule.rule is None else type_text(rule.rule)
        case Whole():
            return f"whole{_unit(rule.unit)}"
        case Number():
            return f"[{rule.unit}]" if rule.unit else "" if range_text(rule) else "number"
    return str(getattr(rule, "words", type(rule).__name__))


def _unit(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def default_text(setting: Setting) -> str:
    """Return the default as a file has it; nothing for a setting that may be absent."""
    if setting.default is REQUIRED:
        return "required"
    value = value_in_file(setting.rule, setting.default)
    return "" if value is None else f"`{json.dumps(value)}`".replace("Infinity", "inf")


def range_text(rule: object) -> str:
    """Return what a rule allows, in a few words."""
    match rule:
        case Toggle():
            return ""
        case OneOf() | Several():
            return "|".join(f'"{text}"' for text in rule.among)
        case Pair():
            return ""
        case Triple() | LimitRule():
            return range_text(rule.rule)
        case Whole():
            return f"{rule.minimum:,}–{rule.maximum:,}"
        case Number() if rule.minimum > -float("inf"):
            return _span(rule)
    return ""


def _span(rule: Number) -> str:
    """Return the range of a number; `> 0` and `< 1` are themselves not allowed."""
    low, high = (f"{value:,.12g}" for value in (rule.minimum, rule.maximum))
    if rule.maximum == float("inf"):
        return f"{'>' if rule.above else '≥'} {low}"
    if rule.below:
        return f"{'> ' if rule.above else ''}{low} to < {high}"
    if rule.above:
        return f"> {low} to {high}"
    return f"{low}–{high}" if rule.minimum >= 0.0 else f"{low} to {high}"


if __name__ == "__main__":
    PAGE.write_text(page(), "utf-8")
