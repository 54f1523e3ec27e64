"""ASAM OSI: mounting positions in a SensorViewConfiguration, as protobuf's JSON.

Origin: the middle of the rear axle, at its height. Radians. Fields are those of
osi_sensorviewconfiguration.proto (OpenSimulationInterface/open-simulation-interface, 00eec02): a
LiDAR has no range of its own, the configuration has one for all its sensors.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, shown
from ..scene.geometry import METRES
from ..text.values import FINITE, Number, Whole, numbers, real
from .carried import CAMERA, LIDAR, CarriedSensor, Scan
from .figures import PIXELS, PLAIN, RANGE
from .files import Written, json_of, pose_from
from .limits import BEAM_BYTES, MAX_BEAMS, require_at_most
from .passthrough import entry_row, json_entry
from .pictures import picture_of_fov
from .protobuf_json import Message

FILE = "sensor_view_configuration.json"
OTHER_KINDS = ("radar", "ultrasonic")
"""Kinds of OSI's that are not known here: they pass through."""
LISTS = {k: f"{k}_sensor_view_configuration" for k in (CAMERA, LIDAR, *OTHER_KINDS)}
DIGITS = 9
"""Of a beam's direction: one has up to 240,000 of them."""
OTHER = "generic_sensor_view_configuration"
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")
WIDEST = Number(0.0, 2.0 * math.pi, above=True, unit="rad", noun="angle")
"""Field of view, of fisheyes too; of a pinhole it is below half a turn."""
IDENTIFIER = Whole(0, (1 << 64) - 1)
STAND_IN_RANGE_M = 100.0
"""Of LiDARs whose file says no range: that of the model which stands in for unknown ones."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a configuration with all sensors; ids are their places in the rig, from 0.

    Raises
    ------
    InputError
        When LiDARs have more than `MAX_BEAMS` beams: each is written.
    """
    beams = sum(s.scan.beam_count for s in sensors if s.scan is not None)
    require_at_most("osi", "sensors", beams, MAX_BEAMS, "beams, each of which is written")
    ranges = {s.name: s.scan.max_range for s in sensors if s.scan is not None}
    top: dict[str, Any] = {"range": max(ranges.values())} if ranges else {}
    kept = [(each, entry_row(each, lambda _: {}, (), ())) for each in sensors if each.is_left_out]
    taken = {_id_of(row) for _, row in kept}
    free = (number for number in count() if number not in taken)
    named = {number: each for number, each in zip(free, _ours(sensors), strict=False)}
    for number, each in named.items():
        row = {"sensor_id": {"value": number}, **_row(each)}
        top.setdefault(LISTS.get(each.kind or "", OTHER), []).append(row)
    for each, row in kept:
        top.setdefault(LISTS.get(each.kind or "", OTHER), []).append(row)
    text = json.dumps(top, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return {FILE: text.encode()}, _lines(named, ranges)


def _ours(sensors: Sequence[CarriedSensor]) -> list[CarriedSensor]:
    return [each for each in sensors if not each.is_left_out]


def _id_of(row: Mapping[str, Any]) -> int | None:
    """Return the id of an entry, if it has one."""
    return Message(row, "passthrough").message("sensor_id").whole_figure("value", IDENTIFIER)


def _lines(named: Mapping[int, CarriedSensor], ranges: dict[str, float]) -> list[str]:
    """Return what the configuration has no room for."""
    order = ", ".join(f"{number} {each.name}" for number, each in named.items())
    lines = [f"OSI numbers sensors, it has no names: {order}"]
    farthest = max(ranges.values(), default=0.0)
    shorter = [f"{name} {reach:g} m" for name, reach in ranges.items() if reach != farthest]
    if shorter:
        lines.append(
            f"OSI has one range for all LiDARs, {farthest:g} m; left out: {', '.join(shorter)}"
        )
    return lines


def _row(each: CarriedSensor) -> dict[str, Any]:
    mounting = {
        "position": dict(zip(PLACE, each.pose.position, strict=True)),
        "orientation": dict(zip(TURN, each.pose.rpy, strict=True)),
    }
    return {"mounting_position": mounting, **_figures(each)}


def _figures(each: CarriedSensor) -> dict[str, Any]:
    """Return field of view [rad], pixels, rays, and each beam's direction."""
    if each.picture is not None and each.picture.size is not None:
        (width, height), p = each.picture.size, each.picture
        return {
            "field_of_view_horizontal": 2.0 * math.atan(width / (2.0 * p.fx)),
            "field_of_view_vertical": 2.0 * math.atan(height / (2.0 * p.fy)),
            "number_of_pixels_horizontal": width,
            "number_of_pixels_vertical": height,
        }
    if each.scan is None or (beams := each.scan.beams) is None:
        return {}
    low, high = each.scan.fov
    return {
        "field_of_view_horizontal": min(high - low, 2.0 * math.pi),
        "field_of_view_vertical": 2.0 * max(abs(each.scan.low), abs(each.scan.high)),
        "number_of_rays_horizontal": each.scan.azimuths,
        "number_of_rays_vertical": each.scan.channels,
        "max_number_of_interactions": 1,
        "num_of_pixels": len(beams),
        "directions": [
            dict(zip(PLACE, beam, strict=True)) for beam in np.round(beams, DIGITS).tolist()
        ],
    }


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read a configuration's sensors, called by kind and id.

    Fields may be named as in the schema or as protobuf's own JSON has them.
    """
    top = Message(json_of(path, BEAM_BYTES), str(path))
    reach = top.figure("range", RANGE)
    found: dict[int, CarriedSensor] = {}
    for kind, key in (*LISTS.items(), (None, OTHER)):
        for row in top.messages(key):
            number = row.message("sensor_id").whole_figure("value", IDENTIFIER)
            number = len(found) if number is None else number
            if number in found:
                raise InputError(path, row.field("sensor_id"), "an id used once", number)
            found[number] = _sensor(path, row, kind, number, reach)
    return tuple(found[number] for number in sorted(found))


def _sensor(
    path: Path, row: Message, kind: str | None, number: int, reach: float | None
) -> CarriedSensor:
    mounting = row.message("mounting_position")
    position, orientation = mounting.message("position"), mounting.message("orientation")
    place = [position.figure(key, METRES) or 0.0 for key in PLACE]
    turn = [orientation.figure(key, FINITE) or 0.0 for key in TURN]
    where = CarriedSensor(
        f"{kind or 'sensor'}_{number}", pose_from(path, mounting.path, place, turn), kind
    )
    if kind in OTHER_KINDS:
        return replace(where, entry=json_entry(row.data))
    if kind == CAMERA:
        return _camera(row, where)
    return _lidar(path, row, where, reach) if kind == LIDAR and "directions" in row else where


def _camera(row: Message, where: CarriedSensor) -> CarriedSensor:
    """Return a camera with its picture, if its size and its field of view are there."""
    ways = ("horizontal", "vertical")
    width, height = (row.whole_figure(f"number_of_pixels_{way}", PIXELS) for way in ways)
    across, down = (row.figure(f"field_of_view_{way}", WIDEST) for way in ways)
    if width is None or height is None or across is None or max(across, down or 0.0) >= math.pi:
        return where
    return replace(where, picture=picture_of_fov(across, (width, height), down))


def _lidar(path: Path, row: Message, where: CarriedSensor, reach: float | None) -> CarriedSensor:
    """Return a LiDAR with its beams, and a line where its range had to be made up."""
    own = row.figure("range", RANGE)  # no release has it; configurations written by hand do
    told = "" if own or reach else f"no range in the file; {STAND_IN_RANGE_M:g} m stands in"
    return replace(where, scan=_scan(path, row, own or reach or STAND_IN_RANGE_M), told=told)


def _component(value: Any) -> float:
    """Return a component of a vector: 0 where protobuf leaves it out, NaN for what is none."""
    if value is None:
        return 0.0
    return float(value) if isinstance(value, str) and PLAIN.fullmatch(value) else real(value)


def _scan(path: Path, row: Message, max_range: float) -> Scan:
    beams, field = row.raw("directions"), row.field("directions")
    plain = isinstance(beams, list) and all(isinstance(beam, dict) for beam in beams)
    if plain:
        require_at_most(path, field, len(beams), MAX_BEAMS, "beams")
    found = numbers([[_component(beam.get(k)) for k in PLACE] for beam in beams]) if plain else None
    if found is None or not len(found) or not np.isfinite(found).all():
        raise InputError(path, field, "a list of vectors {x, y, z}", shown(beams))
    count = row.whole_figure("num_of_pixels", Whole(1))
    if count is not None and count != len(found):
        raise InputError(path, row.field("num_of_pixels"), f"{len(found)}, one a direction", count)
    up = np.arctan2(found[:, 2], np.hypot(found[:, 0], found[:, 1]))
    fov, ends = (-math.pi, math.pi), (float(up.min()), float(up.max()))
    return Scan(len(found), *ends, 1, fov, max_range, False, found)
