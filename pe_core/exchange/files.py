"""What formats share in reading and writing: text, JSON, numbers."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.geometry import METRES, ROTATION, ROTATION_DEG, Pose
from ..text.files import TEXT_BYTES, decode_text, read_bytes
from ..text.json_text import dump_json
from ..text.tables import Table
from ..text.values import FINITE, vector

Written = Mapping[str, bytes]
"""Bytes by file name."""


def text_of(path: Path, most_bytes: int = TEXT_BYTES) -> str:
    """Return a file's text."""
    return decode_text(read_bytes(path, most_bytes))


def json_of(path: Path, most_bytes: int = TEXT_BYTES) -> Any:
    """Return a JSON file's data, or raise `InputError` for what is none."""
    return json_text(path, text_of(path, most_bytes))


def json_text(source: object, text: str) -> Any:
    """Return the data of a JSON text, or raise `InputError` for what is none."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(source, "file", "valid JSON", error) from None


def json_bytes(data: Any) -> bytes:
    """Return data as a JSON file's bytes."""
    return dump_json(data).encode()


def json_rows(path: Path, data: Any, field: str = "") -> list[Table]:
    """Return a list of JSON objects as tables."""
    if not isinstance(data, list):
        raise InputError(path, field or "document", "a list", type(data).__name__)
    return [Table(row, str(path), f"{field}[{k}]") for k, row in enumerate(data)]


def plain_number(value: float) -> str:
    """Return a number that reads back to the same bits; whole ones and zero without ado."""
    number = float(value) + 0.0
    return repr(0.0 if number == 0.0 else number)


def spaced(values: Sequence[float]) -> str:
    """Return numbers with blanks between."""
    return " ".join(plain_number(v) for v in values)


def pose_from(
    source: object, field: str, position: Any, angles: Any, *, degrees: bool = False
) -> Pose:
    """Return the pose of a position [m] and roll, pitch, yaw, or raise `InputError`."""
    place = vector(source, f"{field} position", position, 3, METRES)
    if degrees:
        turned = vector(source, f"{field} rotation", angles, 3, ROTATION_DEG)
        return Pose.from_degrees(place, turned)
    x, y, z = place
    roll, pitch, yaw = vector(source, f"{field} rotation", angles, 3, ROTATION)
    return Pose((x, y, z), (roll, pitch, yaw))


def named_numbers(table: Table, keys: Sequence[str]) -> tuple[float, ...]:
    """Return numbers of a table by their keys."""
    return tuple(table.number(key, rule=FINITE) for key in keys)
