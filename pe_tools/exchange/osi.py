"""ASAM OSI: mounting positions in a SensorViewConfiguration, as protobuf's JSON. The origin is the
middle of the rear axle, at the height of the axle. Angles are in radians. Fields are those of
osi_sensorviewconfiguration.proto (OpenSimulationInterface/open-simulation-interface, 00eec02). The
configuration has one range for all its sensors."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from pe_core.base.errors import InputError, shown
from pe_core.base.table_reader import Table
from pe_core.base.values import Number, Whole, numbers, real
from pe_core.geometry.poses import METRES, Pose

from . import foreign_values as values
from .foreign_values import MAX_BEAMS, RANGE, RPY, XYZ, Export, require_at_most
from .frames import shifted
from .lens_pictures import picture_of_fov
from .merging import merge_rows
from .portable import FieldOfView, ForeignRig, MergeTarget, PortableRig, PortableSensor, Scan
from .portable_kinds import CAMERA, LIDAR, RADAR, ULTRASONIC

FILE = "sensor_view_configuration.json"
OTHER_KINDS = (RADAR, ULTRASONIC)  # Kinds that are their fields of view here
COUNTS = ("number_of_rays_horizontal", "number_of_rays_vertical", "max_number_of_interactions")
FIELD = ("field_of_view_horizontal", "field_of_view_vertical")
PIXELS = ("number_of_pixels_horizontal", "number_of_pixels_vertical")
FIGURES = (*FIELD, *PIXELS, *COUNTS, "num_of_pixels", "directions")
LISTS = {k: f"{k}_sensor_view_configuration" for k in (CAMERA, LIDAR, *OTHER_KINDS)}
DIGITS = 9  # Decimals of a beam's direction; a LiDAR has up to 240,000 beams
OTHER = "generic_sensor_view_configuration"
WIDEST = Number(1e-4, 2.0 * math.pi, unit="rad", noun="angle")
"""Field of view, fisheyes included; that of a pinhole is below pi."""
DIRECTION = (1e-6, 1e6)  # Lengths of vectors that may be directions; OSI has them of length 1
COUNT = Whole(0, 1_000_000_000)
IDENTIFIER = Whole(0, (1 << 64) - 1)
STAND_IN_RANGE_M = 100.0
"""Range of a LiDAR if the file states none; it is that of the stand-in model."""
CAPITAL = re.compile(r"(?<=[a-z0-9])([A-Z])")


def write(sensors: PortableRig, into: MergeTarget | None) -> Export:
    """Return a configuration with all sensors, and messages on names and ranges it cannot hold. Ids
    of new sensors count from 0 in rig order, around those of the file. Every beam is written, so
    more than `MAX_BEAMS` raise `InputError`."""
    beams = sum(s.scan.beam_count for s in sensors if s.scan is not None)
    require_at_most("osi", "sensors", beams, MAX_BEAMS, noun="beams, each of which is written")
    top: dict[str, Any] = {} if into is None else into.document
    lines = _write_range(top, sensors)
    ids = _new_ids(top, sensors, () if into is None else into.gone)

    def fresh(sensor: PortableSensor) -> dict[str, Any]:
        return {"sensor_id": {"value": ids.get(sensor.name)}, **_row(sensor)}

    for kind in dict.fromkeys([*(sensor.kind for sensor in sensors), *LISTS]):
        own = [sensor for sensor in sensors if sensor.kind == kind]
        key = LISTS.get(kind or "", OTHER)
        rows = top.get(key, [])
        merge_rows(rows, own, into, fresh, pose_keys=("mounting_position",), figure_keys=FIGURES)
        if rows or key in top:
            top[key] = rows
    text = json.dumps(top, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    order = ", ".join(f"{number} {name}" for name, number in ids.items())
    return {FILE: text.encode()}, [f"OSI numbers sensors, it has no names: {order}", *lines]


def _write_range(top: dict[str, Any], sensors: PortableRig) -> list[str]:
    """Write the range of all sensors, the farthest; return a message on those that are shorter."""
    figures = ((sensor.name, sensor.scan or sensor.field) for sensor in sensors)
    ranges = {name: own.max_range for name, own in figures if own is not None}
    if not ranges:
        return []
    known = Message(top, FILE).figures.number("range") or 0.0
    top["range"] = farthest = max([known, *ranges.values()])
    shorter = [f"{name} {reach:g} m" for name, reach in ranges.items() if reach != farthest]
    if not shorter:
        return []
    left_out = f"left out: {', '.join(shorter)}"
    return [f"OSI has one range for all sensors, {farthest:g} m; {left_out}"]


def _new_ids(top: dict[str, Any], sensors: PortableRig, gone: PortableRig) -> dict[str, int]:
    """Return the ids of new sensors by name, around those that stay in the file."""
    used = {
        _id_of(Message(row, FILE)) for key in (*LISTS.values(), OTHER) for row in top.get(key, ())
    }
    used -= {_id_of(Message(sensor.entry, FILE)) for sensor in gone}
    free = (number for number in count() if number not in used)
    names = (sensor.name for sensor in sensors if sensor.entry is None)
    return {name: number for name, number in zip(names, free, strict=False)}


def _id_of(row: Message) -> int | None:
    """Return the id of an entry; None if it has none."""
    return row.message("sensor_id").figures.whole("value", IDENTIFIER)


def _row(sensor: PortableSensor) -> dict[str, Any]:
    """Return the pose of a sensor, its fields of view [rad], counts and directions of beams."""
    return {"mounting_position": mounting_position(sensor.pose), **_figures(sensor)}


def mounting_position(pose: Pose, origin: Sequence[float] = (0.0, 0.0, 0.0)) -> dict[str, Any]:
    """Return a MountingPosition: a pose in the frame with its origin there [m]."""
    moved = shifted(pose, [-value for value in origin])
    return {
        "position": dict(zip(XYZ, moved.position, strict=True)),
        "orientation": dict(zip(RPY, moved.rpy, strict=True)),
    }


def _figures(sensor: PortableSensor) -> dict[str, Any]:
    if sensor.picture is not None and sensor.picture.size is not None:
        width, height = sensor.picture.size
        p = sensor.picture
        return {
            FIELD[0]: 2.0 * math.atan(width / (2.0 * p.fx)),
            FIELD[1]: 2.0 * math.atan(height / (2.0 * p.fy)),
            PIXELS[0]: width,
            PIXELS[1]: height,
        }
    if sensor.field is not None:
        angles = (2.0 * max(map(abs, ends)) for ends in (sensor.field.across, sensor.field.up))
        return dict(zip(FIELD, angles, strict=True))
    if sensor.scan is None or (beams := sensor.scan.beams) is None:
        return {}
    low, high = sensor.scan.fov
    return {
        FIELD[0]: min(high - low, 2.0 * math.pi),
        FIELD[1]: 2.0 * max(abs(sensor.scan.low), abs(sensor.scan.high)),
        "number_of_rays_horizontal": sensor.scan.azimuths,
        "number_of_rays_vertical": sensor.scan.channels,
        "max_number_of_interactions": 1,
        "num_of_pixels": len(beams),
        "directions": [
            dict(zip(XYZ, beam, strict=True)) for beam in np.round(beams, DIGITS).tolist()
        ],
    }


def read(path: Path) -> ForeignRig:
    """Read the sensors of a configuration; a sensor's name is its kind and id. Fields may have the
    names of the schema (snake case) or of protobuf's JSON (camel case)."""
    top = Message(values.json_of(path, values.BEAM_BYTES), str(path))
    max_range = top.figures.number("range", RANGE)
    sensors: dict[int, PortableSensor] = {}
    for kind, key in (*LISTS.items(), (None, OTHER)):
        rows = top.messages(key)
        if rows:
            top.value[key] = [row.value for row in rows]
        for row in rows:
            number = _id_of(row)
            number = len(sensors) if number is None else number
            if number in sensors:
                raise InputError(path, row.field("sensor_id"), "an id used once", number)
            sensors[number] = _sensor(path, row, kind, number, max_range=max_range)
    in_order = tuple(sensors[number] for number in sorted(sensors))
    return ForeignRig(in_order, document=top.value)


def _sensor(
    path: Path, row: Message, kind: str | None, number: int, max_range: float | None
) -> PortableSensor:
    mounting = row.message("mounting_position")
    figures = row.figures
    position, orientation = (mounting.message(key).figures for key in ("position", "orientation"))
    coordinates = [position.number(key, METRES) or 0.0 for key in XYZ]
    angles = [orientation.number(key) or 0.0 for key in RPY]
    pose = values.pose_from(path, mounting.path, coordinates, angles)
    sensor = PortableSensor(f"{kind or 'sensor'}_{number}", pose, kind, entry=row.value)
    # No release of OSI has a range per sensor, but configurations written by hand do.
    reach = figures.number("range", RANGE) or max_range
    across, up = (figures.number(key, WIDEST) for key in FIELD)
    if kind in OTHER_KINDS:
        if across is None or up is None or reach is None:
            return sensor
        return replace(
            sensor, field=FieldOfView((-across / 2.0, across / 2.0), (-up / 2.0, up / 2.0), reach)
        )
    for key in COUNTS:
        figures.whole(key, COUNT)
    if kind == CAMERA:
        width, height = (figures.whole(key) for key in PIXELS)
        if width is None or height is None or across is None or max(across, up or 0.0) >= math.pi:
            return sensor
        return replace(sensor, picture=picture_of_fov(across, (width, height), up))
    if kind != LIDAR or "directions" not in row:
        return sensor
    note = "" if reach else f"no range in the file; {STAND_IN_RANGE_M:g} m stands in"
    return replace(sensor, scan=_scan(path, row, reach or STAND_IN_RANGE_M), told=note)


def _component(value: Any) -> float:
    """Return a vector component: 0 if protobuf omitted it, NaN if it is not a number."""
    if value is None:
        return 0.0
    return float(value) if isinstance(value, str) and values.PLAIN.fullmatch(value) else real(value)


def _scan(path: Path, row: Message, max_range: float) -> Scan:
    beams = row.raw("directions")
    field = row.field("directions")
    directions = None
    if isinstance(beams, list) and all(isinstance(beam, dict) for beam in beams):
        require_at_most(path, field, len(beams), MAX_BEAMS, noun="beams")
        directions = numbers([[_component(beam.get(k)) for k in XYZ] for beam in beams])
    low, high = DIRECTION
    lengths = np.zeros(0) if directions is None else np.abs(directions)
    # NaN is in no range.
    if not lengths.size or not (lengths <= high).all() or not (lengths.max(axis=1) >= low).all():
        raise InputError(path, field, "a list of vectors {x, y, z} of length 1", shown(beams))
    assert directions is not None
    count = row.figures.whole("num_of_pixels", Whole(1))
    if count is not None and count != len(directions):
        raise row.error(f"{len(directions)}, one a direction", count, "num_of_pixels")
    elevations = np.arctan2(directions[:, 2], np.hypot(directions[:, 0], directions[:, 1]))
    fov = (-math.pi, math.pi)
    return Scan(
        channels=len(directions),
        low=float(elevations.min()),
        high=float(elevations.max()),
        azimuths=1,
        fov=fov,
        max_range=max_range,
        even=False,
        directions=directions,
    )


class Message(Table):
    """A protobuf message: a table with the schema's field names, ``like_this``. A field that is
    null is absent; one that occurs under both of its names raises `InputError`. Numbers may be
    given as text. Names in nested messages are converted when these are accessed."""

    def __init__(self, data: Any, source: str, path: str = "") -> None:
        fields = dict[str, Any]()
        super().__init__(fields, source, path)
        for key, value in Table(data, source, path).table.items():
            name = CAPITAL.sub(r"_\1", key).lower()
            if name in fields:
                raise self.error("a field once", "both snake_case and camelCase", name)
            if value is not None:
                fields[name] = value

    @property
    def figures(self) -> values.ForeignNumbers:
        """The numbers of its fields."""
        return values.ForeignNumbers(self.source, lambda key: self.raw(key, None), self.field)

    def message(self, key: str) -> Message:
        """Return a nested message; an empty one if the field is absent."""
        return Message(self.raw(key, {}), self.source, self.field(key))

    def messages(self, key: str) -> list[Message]:
        """Return the messages of a repeated field; an empty list if the field is absent."""
        rows = self.raw(key, [])
        if not isinstance(rows, list):
            raise self.error("a list", type(rows).__name__, key)
        return [Message(row, self.source, f"{self.field(key)}[{k}]") for k, row in enumerate(rows)]
