"""Data of an imported file that a rig cannot hold; studies and .blend files keep it unchanged.

An export in the same format writes this data again, so the file keeps its content.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..base.errors import shown
from ..base.serialization import parse_json
from ..base.table_reader import Table
from ..base.values import A_NAME
from ..geometry.poses import Pose

FILE_NAME = re.compile(r"(camera_info/)?[^/\\\x00-\x1f]+")
"""Rule for names of files: a file must not be outside its folder."""


@dataclass(frozen=True, slots=True)
class SourceSensor:
    """A sensor of an imported file.

    Attributes
    ----------
    name : str
        Name of the sensor in the rig; for a sensor that was left out, its name in the file.
    kind : str
    entry : str
        Its entry in the file, in the file's format; empty where `files` has the entry.
    pose : Pose or None
        Pose at the import, in the format's frame; None for a sensor that was left out.
    model : str
        The model at the import, as `model_text` writes it; empty if the user chose the model.
    is_stand_in : bool
        Whether the model is a substitute, because the file names no model.
    """

    name: str
    kind: str
    entry: str = ""
    pose: Pose | None = None
    model: str = ""
    is_stand_in: bool = False


@dataclass(frozen=True, slots=True)
class Passthrough:
    """Data kept of an imported file, for an export in the same format.

    Attributes
    ----------
    format : str
        The name of the format.
    sensors : tuple of SourceSensor
        All sensors in the file's order, also those that were left out.
    files : mapping of str to str
        Text of each file into which an export writes sensors, by file name.
    placed : Pose or None
        Pose of the file's origin in the ground frame.
    """

    format: str
    sensors: tuple[SourceSensor, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    placed: Pose | None = None

    @property
    def holds(self) -> bool:
        """Whether there is any data that a rig cannot hold."""
        return bool(self.files) or any(s.entry or s.is_stand_in for s in self.sensors)

    @property
    def left_out(self) -> tuple[SourceSensor, ...]:
        """The sensors that are not in the rig."""
        return tuple(each for each in self.sensors if each.pose is None)


def passthrough_text(kept: Passthrough | None) -> str:
    """Return the data as JSON text for .blend files; an empty text if there is none."""
    table = passthrough_table(kept)
    return "" if table is None else json_entry(table)


def passthrough_of_text(text: str, source: str) -> Passthrough | None:
    """Read the text of `passthrough_text`, or raise `InputError`."""
    if not text:
        return None
    return read_passthrough(Table(parse_json(source, text), source, "passthrough"))


def passthrough_table(kept: Passthrough | None) -> dict[str, Any] | None:
    """Return the data as plain tables for a study file; None if there is none."""
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
    """Read the tables of `passthrough_table`.

    `InputError` when a key is unknown, or a value is not valid.
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
    """Return an entry: the text of a JSON object, or an empty text."""
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
    """Return a text of any length; it may have several lines."""
    value = table.raw(key)
    if not isinstance(value, str):
        raise table.error(key, "a text", shown(value))
    return value


def json_entry(row: Any) -> str:
    """Return an object of a file as the text of an entry."""
    return json.dumps(row, ensure_ascii=False, separators=(",", ":"))
