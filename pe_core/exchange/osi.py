"""ASAM OSI: mounting positions in a SensorViewConfiguration, as protobuf's JSON.

Origin: the middle of the rear axle, at its height. Radians.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, shown
from ..text.files import LABEL_BYTES
from ..text.tables import Table
from ..text.values import Number, numbers
from .carried import CAMERA, LIDAR, CarriedSensor, Scan
from .files import Written, json_of, json_rows, pose_from
from .pictures import picture_of_fov

FILE = "sensor_view_configuration.json"
LISTS = {kind: f"{kind}_sensor_view_configuration" for kind in (CAMERA, LIDAR)}
DIGITS = 9
"""Of a beam's direction: one has up to 240,000 of them."""
OTHER = "generic_sensor_view_configuration"
PLACE, TURN = ("x", "y", "z"), ("roll", "pitch", "yaw")
FOV = Number(0.0, math.pi, above=True, below=True, unit="rad", noun="angle")


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a configuration with all sensors; ids are their places in the rig, from 0."""
    lists: dict[str, list[dict[str, Any]]] = {}
    for number, each in enumerate(sensors):
        row = {"sensor_id": {"value": number}, "mounting_position": _mounting(each)}
        lists.setdefault(LISTS.get(each.kind or "", OTHER), []).append(row | _figures(each))
    order = ", ".join(f"{k} {s.name}" for k, s in enumerate(sensors))
    text = json.dumps(lists, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return {FILE: text.encode()}, [f"OSI numbers sensors, it has no names: {order}"]


def _mounting(each: CarriedSensor) -> dict[str, Any]:
    return {
        "position": dict(zip(PLACE, each.pose.position, strict=True)),
        "orientation": dict(zip(TURN, each.pose.rpy, strict=True)),
    }


def _figures(each: CarriedSensor) -> dict[str, Any]:
    """Return field of view [rad], range [m], pixels, and each beam's direction."""
    if each.picture is not None and each.picture.size is not None:
        (width, height), p = each.picture.size, each.picture
        return {
            "field_of_view_horizontal": 2.0 * math.atan(width / (2.0 * p.fx)),
            "field_of_view_vertical": 2.0 * math.atan(height / (2.0 * p.fy)),
            "number_of_pixels_horizontal": width,
            "number_of_pixels_vertical": height,
        }
    if each.scan is not None and (beams := each.scan.directions) is not None:
        scan, (low, high) = each.scan, each.scan.fov
        vertical = 2.0 * max(abs(scan.low), abs(scan.high))
        figures = {"field_of_view_horizontal": high - low, "field_of_view_vertical": vertical}
        rounded = np.round(beams, DIGITS)
        rays = [dict(zip(PLACE, beam, strict=True)) for beam in rounded.tolist()]
        return {**figures, "range": scan.max_range, "directions": rays}
    return {}


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read a configuration's sensors, called by kind and id."""
    top = Table(json_of(path, LABEL_BYTES), str(path))
    found: dict[int, CarriedSensor] = {}
    for kind, key in (*LISTS.items(), (None, OTHER)):
        for row in json_rows(path, top.raw(key, []), key):
            number = row.table("sensor_id").whole("value", len(found))
            found[number] = _sensor(path, row, kind, number)
    return tuple(found[number] for number in sorted(found))


def _sensor(path: Path, row: Table, kind: str | None, number: int) -> CarriedSensor:
    mounting = row.table("mounting_position")
    place, turn = (
        [table.number(key, 0.0) for key in keys]
        for table, keys in (
            (mounting.table("position"), PLACE),
            (mounting.table("orientation"), TURN),
        )
    )
    where = CarriedSensor(
        f"{kind or 'sensor'}_{number}", pose_from(path, mounting.path, place, turn), kind
    )
    keys = ("number_of_pixels_horizontal", "number_of_pixels_vertical", "field_of_view_horizontal")
    if kind == CAMERA and all(key in row for key in keys):
        size, across = (row.whole(keys[0]), row.whole(keys[1])), row.number(keys[2], rule=FOV)
        down = row.number("field_of_view_vertical", None, rule=FOV)
        return replace(where, picture=picture_of_fov(across, size, down))
    if kind == LIDAR and "directions" in row and "range" in row:
        return replace(where, scan=_scan(path, row))
    return where


def _scan(path: Path, row: Table) -> Scan:
    beams = row.raw("directions")
    plain = isinstance(beams, list) and all(isinstance(beam, dict) for beam in beams)
    found = numbers([[beam.get(key) for key in PLACE] for beam in beams]) if plain else None
    if found is None or not len(found):
        raise InputError(path, row.field("directions"), "a list of vectors {x, y, z}", shown(beams))
    up = np.arctan2(found[:, 2], np.hypot(found[:, 0], found[:, 1]))
    fov, ends = (-math.pi, math.pi), (float(up.min()), float(up.max()))
    return Scan(len(found), *ends, 1, fov, row.number("range"), False, found)
