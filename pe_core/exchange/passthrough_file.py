"""What is kept of an imported file, as studies and .blend files hold it."""

from __future__ import annotations

import json
import re
from typing import Any

from ..errors import shown
from ..scene.geometry import Pose
from ..text.tables import Table
from ..text.values import A_NAME
from .files import json_text
from .passthrough import Passthrough, SourceSensor, json_entry

FILE_NAME = re.compile(r"(camera_info/)?[^/\\\x00-\x1f]+")
"""Files that are written beside others: none goes out of its folder."""


def passthrough_text(kept: Passthrough | None) -> str:
    """Return a text in JSON, as .blend files have it; an empty one of nothing."""
    table = passthrough_table(kept)
    return "" if table is None else json_entry(table)


def passthrough_of_text(text: str, source: str) -> Passthrough | None:
    """Return what such a text says, or raise `InputError`."""
    if not text:
        return None
    return read_passthrough(Table(json_text(source, text), source, "passthrough"))


def passthrough_table(kept: Passthrough | None) -> dict[str, Any] | None:
    """Return plain data, as a study's file has it; None of nothing."""
    if kept is None:
        return None
    table = {
        "format": kept.format,
        "placed": None if kept.placed is None else _numbers(kept.placed),
        "files": dict(kept.files) or None,
        "sensor": [_sensor_table(each) for each in kept.sensors] or None,
    }
    return {key: value for key, value in table.items() if value is not None}


def _sensor_table(each: SourceSensor) -> dict[str, Any]:
    table = {
        "name": each.name,
        "kind": each.kind,
        "pose": None if each.pose is None else _numbers(each.pose),
        "model": each.model or None,
        "stand_in": each.is_stand_in or None,
        "entry": each.entry or None,
    }
    return {key: value for key, value in table.items() if value is not None}


def _numbers(pose: Pose) -> list[float]:
    """Position [m], then roll, pitch and yaw [rad]."""
    return [*pose.position, *pose.rpy]


def read_passthrough(table: Table) -> Passthrough:
    """Return what plain data says.

    Raises
    ------
    InputError
        When a key is unknown, or a value is none that it may have.
    """
    files = table.table("files")
    for name in files.names:
        if not FILE_NAME.fullmatch(name) or name in (".", ".."):
            raise files.error(shown(name), "the name of a file", shown(name))
    texts = {name: _text(files, name) for name in files.names}
    sensors = tuple(_read_sensor(row) for row in table.tables("sensor"))
    kept = Passthrough(table.text("format"), sensors, texts, _read_pose(table, "placed"))
    table.finish()
    return kept


def _read_sensor(row: Table) -> SourceSensor:
    stand_in = row.raw("stand_in", False)
    if not isinstance(stand_in, bool):
        raise row.error("stand_in", "true or false", shown(stand_in))
    named = row.text("name", rule=A_NAME), row.text("kind")
    model = _text(row, "model") if "model" in row else ""
    found = SourceSensor(*named, _read_entry(row), _read_pose(row, "pose"), model, stand_in)
    row.finish()
    return found


def _read_entry(row: Table) -> str:
    """Return an entry, which is a JSON object or nothing."""
    text = _text(row, "entry") if "entry" in row else ""
    try:
        is_object = not text or isinstance(json.loads(text), dict)
    except (ValueError, RecursionError):
        is_object = False
    if not is_object:
        raise row.error("entry", "a JSON object", shown(text))
    return text


def _read_pose(table: Table, key: str) -> Pose | None:
    if key not in table:
        return None
    x, y, z, roll, pitch, yaw = table.numbers(key, 6)
    return Pose((x, y, z), (roll, pitch, yaw))


def _text(table: Table, key: str) -> str:
    """Return a text of any length, over several lines too."""
    value = table.raw(key)
    if not isinstance(value, str):
        raise table.error(key, "a text", shown(value))
    return value
