"""Passthrough: content of an imported file besides the rig, written again to the same format.
Sensors of unknown kinds, fields that are not read, and comments survive import and export. The
entry of a sensor is written unchanged while the sensor has its imported pose and model."""

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.errors import InputError, plural, shown
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import SensorModel
from pe_core.sensors import KINDS
from pe_core.study.passthrough import Passthrough, json_entry

from .foreign_values import pose_from
from .portable import ORIGIN, PortableRig, PortableSensor
from .portable_kinds import RADAR, ULTRASONIC, has_model
from .sensor_names import FRAME, NO_SENSOR_WORDS, said_kind

UNMOVED_M, UNTURNED = 2e-5, 4e-6
"""A pose nearer than this to the imported one is unchanged: .blend files and studies round to
0.01 mm and 0.0001 degrees. The second number is a difference of rotation matrices."""
FIGURES_ALIKE = 1e-6
"""Figures of a model that differ by less are the same: .blend files hold single precision."""
MAX_MODEL_LENGTH = 50_000
"""Characters of a model's figures; of more (single beams) a digest is kept."""


def restored(
    passthrough: Passthrough, sensors: Iterable[PortableSensor], models: Mapping[str, str]
) -> PortableRig:
    """Return a rig's sensors with their imported entries, and the sensors left out at import.
    Sensors are in the order of the file; sensors added since follow. `models` are the `model_text`
    of the rig's models by the sensors' names; properties of a model that is still the imported one
    are left out."""
    by_name, result = {sensor.name: sensor for sensor in sensors}, []
    for source in passthrough.sensors:
        if source.pose is None:
            left_out = PortableSensor(source.name, ORIGIN, source.kind)
            result.append(replace(left_out, entry=source.entry, is_left_out=True))
        elif source.name in by_name:
            sensor = by_name.pop(source.name)
            kept = bool(source.entry or source.is_stand_in)
            if kept and _is_same_model(source.model, models[source.name]):
                sensor = replace(sensor, picture=None, scan=None, field=None, parameters="")
                sensor = replace(sensor, min_range=None, max_range=None)
                sensor = replace(sensor, is_stand_in=source.is_stand_in)
            unmoved = is_same_pose(source.pose, sensor.pose)
            result.append(replace(sensor, entry=source.entry, is_unmoved=unmoved))
    return (*result, *by_name.values())


def is_there(a: float, b: float) -> bool:
    """Whether two coordinates [m] are the same, but for rounding."""
    return abs(a - b) <= UNMOVED_M


def is_turned_so(a: Pose, b: Pose) -> bool:
    """Whether two poses have the same rotation within rounding."""
    difference = np.abs(a.ground_from_sensor - b.ground_from_sensor)
    return bool(difference.max() <= UNTURNED)


def is_same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are the same, but for rounding."""
    return all(map(is_there, a.position, b.position)) and is_turned_so(a, b)


def model_text(model: SensorModel) -> str:
    """Return a text that identifies a model: its catalogue name, or its parameters as JSON."""
    entry = catalog.entries().get(model.name)
    if entry is not None and entry.file != catalog.OWN and catalog.load(model.name) is model:
        return model.name
    text = json_entry(catalog.to_table(model))
    return text if len(text) <= MAX_MODEL_LENGTH else hashlib.sha256(text.encode()).hexdigest()


def _is_same_model(a: str, b: str) -> bool:
    """Whether two model texts identify the same model within rounding."""
    if not (a.startswith("{") and b.startswith("{")):
        return a == b
    try:
        return _alike(json.loads(a), json.loads(b))
    except (ValueError, RecursionError):
        return False


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_alike, a, b))
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=FIGURES_ALIKE, abs_tol=FIGURES_ALIKE)
    return bool(a == b)


def entry_row(
    sensor: PortableSensor,
    fresh: Callable[[PortableSensor], Mapping[str, Any]],
    pose_keys: Sequence[str],
    figure_keys: Sequence[str],
    part: str = "",
) -> dict[str, Any]:
    """Return a sensor's JSON object: its imported entry with the changed keys updated. `fresh`
    returns the object of a sensor without an entry; `pose_keys` and `figure_keys` are the keys of
    the pose and of the model in it. `part` is its key, if the entry has several objects."""
    if not sensor.entry:
        return dict(fresh(sensor))
    row = json.loads(sensor.entry)
    row = row.get(part) if part else row
    if not isinstance(row, dict):
        raise InputError("passthrough", f"entry of {sensor.name}", "a JSON object", shown(row))
    if sensor.is_left_out:
        return row
    changed = [*([] if sensor.is_unmoved else pose_keys)]
    changed += figure_keys if sensor.has_figures else []
    current = fresh(sensor) if changed else {}
    for key in changed:
        if key in current:
            row[key] = current[key]
        else:
            row.pop(key, None)
    return row


def pose_entry(sensor: PortableSensor, **more: Any) -> str:
    """Return an entry with a pose, position [m] and angles [rad], and further fields `more`."""
    return json_entry({"pose": [list(sensor.pose.position), list(sensor.pose.rpy)], **more})


def pose_of_entry(sensor: PortableSensor) -> Pose:
    """Return the pose in an entry of `pose_entry`. Raise `InputError` if it is malformed."""
    values = entry_row(sensor, lambda _: {}, (), ()).get("pose")
    position, angles = values if isinstance(values, list) and len(values) == 2 else (values, None)
    return pose_from("passthrough", sensor.name, position, angles)


SENSORS = frozenset(["gnss", "gps", "imu", "ins", "collision", "sonar", "lane_invasion"])
NOUNS = frozenset({RADAR, ULTRASONIC, "link", FRAME}) | (NO_SENSOR_WORDS - SENSORS)
"""Kinds that are nouns; of others one says sensor."""


def parted(
    sensors: Iterable[PortableSensor], chosen: Mapping[str, str]
) -> tuple[list[PortableSensor], list[PortableSensor]]:
    """Return the sensors of known kinds, and the sensors to leave out. If the file states no kind,
    the sensor's name decides, unless a model was `chosen` for it."""
    included, left_out = [], []
    for sensor in sensors:
        kind = sensor.kind or ""
        if not (kind or sensor.name in chosen or sensor.model or sensor.has_figures):
            kind = said_kind(sensor.name) or ""
        is_chosen = kind in KINDS and sensor.name in chosen
        if not kind or is_chosen or has_model(replace(sensor, kind=kind)):
            included.append(sensor)
        else:
            entry = sensor.entry or pose_entry(sensor)
            left_out.append(replace(sensor, kind=kind, entry=entry, is_left_out=True))
    return included, left_out


def listed_kinds(sensors: Iterable[tuple[str, str]]) -> str:
    """Return a text with the count and the names of each kind, from pairs (kind, name)."""
    names: dict[str, list[str]] = {}
    for kind, name in sensors:
        names.setdefault(kind, []).append(name)
    return ", ".join(
        f"{plural(len(own), kind if kind in NOUNS else f'{kind} sensor')} ({', '.join(own)})"
        for kind, own in names.items()
    )
