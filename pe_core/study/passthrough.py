"""Data of an imported file that a rig cannot hold; studies and .blend files keep it unchanged.

An export in the same format writes this data again, so the file keeps its content.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..base.errors import shown
from ..base.table_reader import Table, parse_json
from ..base.values import A_NAME
from ..geometry.poses import Pose

FILE_NAME = re.compile(r"(camera_info/)?[^/\\\x00-\x1f]+")
"""Rule for names of files: a file must not be outside its folder."""


@dataclass(frozen=True, slots=True)
class SourceSensor:
    """A sensor of an imported file; one that was left out has no `pose`, and its name in the file.

    `entry` is its entry in the file's format; it is empty where the `files` have it. `pose` is that
    at the import, in the format's frame, and `model` the model as a text; empty if the user chose
    it. The model `is_stand_in` if the file names none.
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

    `sensors` are all, in the file's order, also those that were left out. `files` has the text of
    each file into which an export writes sensors, by name. `placed` is the pose of the file's
    origin in the ground frame.
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
    """Read the tables of `passthrough_table`. `InputError` when a key is unknown, or a value is not
    valid."""
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
    text = _text(row, "entry") if "entry" in row else ""
    try:
        is_object = not text or isinstance(json.loads(text), dict)
    except (ValueError, RecursionError):
        is_object = False
    if not is_object:
        raise row.error("entry", "a JSON object", shown(text))
    found = SourceSensor(*named, text, _read_pose(row, "pose"), model, stand_in)
    row.finish()
    return found


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
