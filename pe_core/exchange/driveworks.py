"""NVIDIA DriveWorks' rig.json: degrees; origin: the rear axle on the ground."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..text.tables import Table
from .carried import CAMERA, LIDAR, CarriedSensor, Picture
from .files import Written, json_bytes, json_of, json_rows, plain_number, pose_from

FILE = "rig.json"
POSE, TURN, PLACE = "nominalSensor2Rig_FLU", "roll-pitch-yaw", "t"
PROTOCOLS = {CAMERA: "camera.gmsl", LIDAR: "lidar.virtual"}
"""Protocols to write; kinds are read from the word before the dot."""
LENS = ("fx", "fy", "cx", "cy")


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a rig; properties are texts there."""
    rows = [_row(each) for each in sensors]
    lines = [f"{s.name}: DriveWorks has no {s.kind}" for s in sensors if s.kind not in PROTOCOLS]
    return {FILE: json_bytes({"rig": {"sensors": rows}, "version": 2})}, lines


def _row(each: CarriedSensor) -> dict[str, Any]:
    properties: dict[str, str] = {}
    p = each.picture
    if p is not None and p.size is not None:
        lens = zip(LENS, (p.fx, p.fy, p.cx, p.cy), strict=True)
        properties = {"Model": "pinhole", "width": str(p.size[0]), "height": str(p.size[1])}
        properties |= {key: plain_number(value) for key, value in lens}
    return {
        "name": each.name,
        "protocol": PROTOCOLS.get(each.kind or "", "virtual"),
        "parameter": f"model={each.model}",
        POSE: {TURN: list(each.pose.rotation_deg), PLACE: list(each.pose.position)},
        "properties": properties,
    }


def read(path: Path) -> tuple[CarriedSensor, ...]:
    """Read the sensors that have a pose; those without one (CAN, GPS) are passed over."""
    rig = Table(json_of(path), str(path)).table("rig")
    rows = [row for row in json_rows(path, rig.raw("sensors"), "rig.sensors") if POSE in row]
    if not rows:
        raise InputError(path, "rig.sensors", f"sensors with {POSE}", "none")
    return tuple(_sensor(path, row) for row in rows)


def _sensor(path: Path, row: Table) -> CarriedSensor:
    pose = row.table(POSE)
    place, turn = pose.raw(PLACE), pose.raw(TURN)
    word = row.text("protocol", "").partition(".")[0]
    kind = word if word in PROTOCOLS else None
    _, _, model = row.text("parameter", "").partition("model=")
    where = pose_from(path, pose.path, place, turn, degrees=True)
    picture = _picture(row.table("properties")) if kind == CAMERA else None
    return CarriedSensor(row.text("name"), where, kind, model.split(",")[0] or None, picture)


def _picture(properties: Table) -> Picture | None:
    """Return a pinhole's picture; another model's is left to be chosen."""
    if not all(key in properties for key in (*LENS, "width", "height")):
        return None
    fx, fy, cx, cy, width, height = (_number(properties, key) for key in (*LENS, "width", "height"))
    return Picture(fx, fy, cx, cy, (int(width), int(height)))


def _number(properties: Table, key: str) -> float:
    value = properties.raw(key)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise properties.error(key, "a number", shown(value)) from None
