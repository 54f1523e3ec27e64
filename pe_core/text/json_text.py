"""JSON as text: exact, and without what JSON has no word for."""

from __future__ import annotations

import json
from typing import Any


def dump_json(data: Any) -> str:
    """JSON text; floats round-trip exactly, and infinities (not JSON) never get here."""
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """JSON has no infinity: bounds that are infinite become texts. What is not a number is null."""
    if isinstance(value, dict):
        return {k: finite(v) for k, v in value.items()}
    if isinstance(value, list):
        return [finite(v) for v in value]
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return str(value)
    if isinstance(value, float) and value != value:
        return None
    return value
