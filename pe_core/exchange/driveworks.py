"""NVIDIA DriveWorks' rig.json: degrees; origin: the rear axle on the ground."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene.geometry import METRES, Pose
from ..text.tables import Table
from ..text.values import vector
from .carried import CAMERA, LIDAR, CarriedSensor
from .driveworks_lens import read_properties, write_properties
from .files import Written, json_bytes, json_of, json_rows, json_text, pose_from
from .frames import composed, shifted
from .passthrough import ORIGIN, entry_row, json_entry

FILE = "rig.json"
POSE, TURN, PLACE = "nominalSensor2Rig_FLU", "roll-pitch-yaw", "t"
TURN_CORRECTION, SHIFT_CORRECTION = "correction_sensor_R_FLU", "correction_rig_T"
PROTOCOLS = {CAMERA: "camera.gmsl", LIDAR: "lidar.virtual"}
"""Protocols to write; kinds are read from the word before the dot."""
UNKNOWN = ("", "virtual")
"""Protocols that tell no kind."""
FIGURES, CORRECTION = ("properties", "parameter"), "correction_"


def write(sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    """Return a rig; properties are texts there."""
    return _written({"rig": {}, "version": 2}, sensors)


def write_over(
    texts: Mapping[str, str], sensors: tuple[CarriedSensor, ...]
) -> tuple[Written, list[str]]:
    """Return the file that came in, with the rig's sensors."""
    return _written(json_text("passthrough", texts.get(FILE, "")), sensors)


def source(path: Path) -> dict[str, str]:
    """Return the file's text without its sensors, which go in again."""
    document = json_of(path)
    document["rig"]["sensors"] = []
    return {FILE: json_entry(document)}


def _written(document: Any, sensors: tuple[CarriedSensor, ...]) -> tuple[Written, list[str]]:
    rig = document.get("rig") if isinstance(document, dict) else None
    if not isinstance(rig, dict):
        raise InputError("passthrough", FILE, "a rig", "none")
    rig["sensors"] = [_row_over(each) for each in sensors]
    lines = [f"{s.name}: DriveWorks has no {s.kind}" for s in sensors
             if s.kind not in PROTOCOLS and not s.is_left_out]  # fmt: skip
    return {FILE: json_bytes(document)}, lines


def _row_over(each: CarriedSensor) -> dict[str, Any]:
    """Return a sensor's object; of one that moved the corrections are in its pose."""
    row = entry_row(each, _row, (POSE,), FIGURES)
    if not each.is_unmoved and not each.is_left_out:
        row = {key: value for key, value in row.items() if not key.startswith(CORRECTION)}
    return row


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
    """Read the sensors; those without a pose (CAN, GPS) are of kinds of their own."""
    rig = Table(json_of(path), str(path)).table("rig")
    rows = json_rows(path, rig.raw("sensors"), "rig.sensors")
    if not any(POSE in row for row in rows):
        raise InputError(path, "rig.sensors", f"sensors with {POSE}", "none")
    return tuple(_sensor(path, row) for row in rows)


def _corrected(path: Path, row: Table, nominal: Pose) -> Pose:
    """Return a nominal pose with what calibration found: a turn in the sensor's axes, a shift.

    The shift is in the rig's axes: R = R_nominal R_correction, t = t_nominal + t_correction.
    """
    shift, turn = row.raw(SHIFT_CORRECTION, None), row.raw(TURN_CORRECTION, None)
    if shift is None and turn is None:
        return nominal
    angles = [0.0, 0.0, 0.0] if turn is None else row.table(TURN_CORRECTION).raw(TURN)
    field = row.field(TURN_CORRECTION)
    turned = pose_from(path, field, (0.0, 0.0, 0.0), angles, degrees=True)
    moved = (0.0, 0.0, 0.0) if shift is None else shift
    by = vector(path, row.field(SHIFT_CORRECTION), moved, 3, METRES)
    return shifted(composed(nominal, turned), by)


def _sensor(path: Path, row: Table) -> CarriedSensor:
    word, entry = row.text("protocol", "").partition(".")[0], json_entry(row.data)
    if POSE not in row:
        return CarriedSensor(row.text("name"), ORIGIN, word or "other", entry=entry)
    pose = row.table(POSE)
    place, turn = pose.raw(PLACE), pose.raw(TURN)
    kind = None if word in UNKNOWN else word
    _, _, model = row.text("parameter", "").partition("model=")
    where = _corrected(path, row, pose_from(path, pose.path, place, turn, degrees=True))
    found = read_properties(row.table("properties")) if kind == CAMERA else (None, "")
    named = row.text("name"), where, kind, model.split(",")[0] or None
    return CarriedSensor(*named, found[0], told=found[1], entry=entry)
