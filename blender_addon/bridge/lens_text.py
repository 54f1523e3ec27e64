"""A camera's lens and range as a line of text, with the keys that a study has."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

LENS_KEYS = frozenset({"fx", "fy", "cx", "cy", "fov_deg", "distortion"})
"""Any of these takes the place of a field of view."""
LINE_KEYS = ("fx", "fy", "cx", "cy", "fov_deg", "min_range_m", "max_range_m", "distortion")


def read_lens(text: str) -> dict[str, Any]:
    """Return the keys of a line; one that cannot be read is handed on, for the engine to refuse."""
    try:
        return dict(tomllib.loads(f"line = {{ {text} }}")["line"])
    except tomllib.TOMLDecodeError:
        return {"distortion": text}


def lens_text(table: Mapping[str, Any]) -> str:
    """Return the line of a camera's table; empty where it has none of its keys."""
    return _line({key: table[key] for key in LINE_KEYS if key in table})


def _line(table: Mapping[str, Any]) -> str:
    return ", ".join(f"{key} = {_value(value)}" for key, value in table.items())


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{ {_line(value)} }}"
    return f'"{value}"' if isinstance(value, str) else repr(value)
