"""NVIDIA DriveWorks' rig.json: degrees; origin: the rear axle on the ground."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..errors import InputError
from ..text.tables import Table
from .carried import CAMERA, LIDAR, CarriedSensor
from .driveworks_lens import read_properties, write_properties
from .files import Written, json_bytes, json_of, json_rows, pose_from

FILE = "rig.json"
POSE, TURN, PLACE = "nominalSensor2Rig_FLU", "roll-pitch-yaw", "t"
PROTOCOLS = {CAMERA: "camera.gmsl", LIDAR: "lidar.virtual"}
"""Protocols to write; kinds are read from the word before the dot."""


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a rig; properties are texts there."""
    rows = [_row(each) for each in sensors]
    lines = [f"{s.name}: DriveWorks has no {s.kind}" for s in sensors if s.kind not in PROTOCOLS]
    return {FILE: json_bytes({"rig": {"sensors": rows}, "version": 2})}, lines


def _row(each: CarriedSensor) -> dict[str, Any]:
    properties = {} if each.picture is None else write_properties(each.picture)
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
    found = read_properties(row.table("properties")) if kind == CAMERA else (None, "")
    named = row.text("name"), where, kind, model.split(",")[0] or None
    return CarriedSensor(*named, found[0], told=found[1])
