"""What an imported rig's file had besides the rig, as studies and .blend files hold it.

The formats of `pe_tools.exchange` write it again: out of what came in comes what came in.
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
"""Files that are written beside others: none goes out of its folder."""


@dataclass(frozen=True, slots=True)
class SourceSensor:
    """A sensor as its file had it.

    Attributes
    ----------
    name : str
        Of the sensor in the rig, or in the file if it was left out.
    kind : str
    entry : str
        What stood in the file, in the words of its format; empty where that is in `files`.
    pose : Pose or None
        Where it was imported, in the format's frame; None: it was left out.
    model : str
        The model it was imported with, as `model_text` has it; empty if a person chose it.
    is_stand_in : bool
        Whether that model only stands in for one that the file does not name.
    """

    name: str
    kind: str
    entry: str = ""
    pose: Pose | None = None
    model: str = ""
    is_stand_in: bool = False


@dataclass(frozen=True, slots=True)
class Passthrough:
    """What is kept of an imported file, for an export in the same format.

    Attributes
    ----------
    format : str
        The name of the format.
    sensors : tuple of SourceSensor
        In the file's order, with those that were left out.
    files : mapping of str to str
        Texts by file name into which sensors are written.
    placed : Pose or None
        Where the file's origin was put.
    """

    format: str
    sensors: tuple[SourceSensor, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)
    placed: Pose | None = None

    @property
    def holds(self) -> bool:
        """Whether there is anything that a rig does not have."""
        return bool(self.files) or any(s.entry or s.is_stand_in for s in self.sensors)

    @property
    def left_out(self) -> tuple[SourceSensor, ...]:
        """Those that are not in the rig."""
        return tuple(each for each in self.sensors if each.pose is None)


def passthrough_text(kept: Passthrough | None) -> str:
    """Return a text in JSON, as .blend files have it; an empty one of nothing."""
    table = passthrough_table(kept)
    return "" if table is None else json_entry(table)


def passthrough_of_text(text: str, source: str) -> Passthrough | None:
    """Return what such a text says, or raise `InputError`."""
    if not text:
        return None
    return read_passthrough(Table(parse_json(source, text), source, "passthrough"))


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


def json_entry(row: Any) -> str:
    """Return an object of a file as an entry."""
    return json.dumps(row, ensure_ascii=False, separators=(",", ":"))
