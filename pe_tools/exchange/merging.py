"""An export into a file that is there: what the file has besides the rig stays. Sensors that did
not move, models that are still the file's, fields that are not read, sensors of unknown kinds and
comments keep their text."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.errors import plural
from pe_core.geometry.poses import Pose
from pe_core.scene.rig import SensorModel

from .portable import MergeTarget, PortableSensor
from .portable_kinds import RADAR, ULTRASONIC
from .sensor_names import FRAME, NO_SENSOR_WORDS

UNMOVED_M = 2e-5
UNTURNED = 4e-6
"""A pose nearer than this to the file's is unchanged: .blend files and studies round to 0.01 mm and
0.0001 degrees. The second number is a difference of rotation matrices."""
FIGURES_ALIKE = 1e-6
"""Figures of a model that differ by less are the same: .blend files hold single precision."""
Row = dict[str, Any]
SENSORS = frozenset(["gnss", "gps", "imu", "ins", "collision", "sonar", "lane_invasion"])
NOUNS = frozenset({RADAR, ULTRASONIC, "link", FRAME}) | (NO_SENSOR_WORDS - SENSORS)
"""Kinds that are nouns; of others one says sensor."""


def merged(
    sensor: PortableSensor,
    model: SensorModel,
    in_file: PortableSensor,
    file_model: SensorModel | None,
) -> PortableSensor:
    """Return a sensor of a rig with its entry in the file. The figures of a model that is still the
    file's are left out. A `file_model` of None is another one."""
    is_unmoved = is_same_pose(in_file.pose, sensor.pose)
    found = replace(sensor, entry=in_file.entry, is_unmoved=is_unmoved)
    if file_model is None or not is_same_model(model, file_model):
        return found
    return replace(
        found,
        is_unchanged=True,
        is_stand_in=in_file.is_stand_in and is_unmoved,
        picture=None,
        scan=None,
        field=None,
        parameters="",
        min_range=None,
        max_range=None,
    )


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


def is_same_model(a: SensorModel, b: SensorModel) -> bool:
    """Whether two models are the same within rounding."""
    same_kind = a.kind == b.kind and a.name == b.name
    return a is b or (same_kind and _alike(catalog.to_table(a), catalog.to_table(b)))


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_alike, a, b))
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=FIGURES_ALIKE, abs_tol=FIGURES_ALIKE)
    return bool(a == b)


def merge_rows(
    rows: list[Row],
    sensors: Iterable[PortableSensor],
    into: MergeTarget | None,
    fresh: Callable[[PortableSensor], Mapping[str, Any]],
    *,
    pose_keys: Sequence[str],
    figure_keys: Sequence[str],
) -> None:
    """Update a file's list of objects, one per sensor; the entry of a sensor is its object. New
    sensors are added at the end, and those that are gone removed. `fresh` returns the object of a
    new sensor; `pose_keys` and `figure_keys` are the keys of the pose and of the model in it."""
    gone = [] if into is None else [sensor.entry for sensor in into.gone]
    rows[:] = [row for row in rows if not any(row is entry for entry in gone)]
    for sensor in sensors:
        if sensor.entry is None:
            rows.append(dict(fresh(sensor)))
            continue
        changed = [] if sensor.is_unmoved else list(pose_keys)
        changed += [] if sensor.is_unchanged else figure_keys
        current = fresh(sensor) if changed else {}
        for key in changed:
            if key in current:
                sensor.entry[key] = current[key]
            else:
                sensor.entry.pop(key, None)


def gone_lines(names: Iterable[str]) -> list[str]:
    """Return a message on frames of sensors that the rig no longer has, in a format that keeps
    them."""
    listed = ", ".join(sorted(names))
    return [f"no sensors of the rig, their frames are kept: {listed}"] if listed else []


def listed_kinds(sensors: Iterable[tuple[str, str]]) -> str:
    """Return a text with the count and the names of each kind, from pairs (kind, name)."""
    names: dict[str, list[str]] = {}
    for kind, name in sensors:
        names.setdefault(kind, []).append(name)
    return ", ".join(
        f"{plural(len(own), kind if kind in NOUNS else f'{kind} sensor')} ({', '.join(own)})"
        for kind, own in names.items()
    )
