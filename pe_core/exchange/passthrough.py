"""What a file had besides the rig: kept at import, and written again into the same format.

Kinds of sensors that are not known here, fields that nobody reads, comments: out of what came in
comes what came in. An entry is written as it stands while its sensor has not moved and has the
model that it came with.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import catalog
from ..errors import InputError, shown
from ..scene.geometry import Pose
from ..scene.sensors import SensorModel
from .carried import CarriedSensor
from .files import pose_from

ORIGIN = Pose((0.0, 0.0, 0.0))
UNMOVED_M, UNTURNED = 2e-5, 4e-6
"""A pose nearer than this to the one that came in is that one: .blend files and studies round to
0.01 mm and 0.0001 degrees. The second is a difference of rotation matrices."""
FIGURES_ALIKE = 1e-6
"""Figures of a model that differ by less are the same: .blend files hold single precision."""
LONGEST_MODEL = 50_000
"""Characters of a model's figures; of more (single beams) a digest is kept."""


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

    def restored(self, now: CarriedSensor, model: str) -> CarriedSensor:
        """Return a sensor as it is now, with its entry, and without what nobody has changed."""
        untouched = bool(self.entry or self.is_stand_in) and same_model(self.model, model)
        if untouched:
            now = replace(now, picture=None, scan=None, is_stand_in=self.is_stand_in)
            now = replace(now, min_range=None, max_range=None)
        unmoved = self.pose is not None and same_pose(self.pose, now.pose)
        return replace(now, entry=self.entry, is_unmoved=unmoved)


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

    def restored(
        self, sensors: Iterable[CarriedSensor], models: Mapping[str, str]
    ) -> tuple[CarriedSensor, ...]:
        """Return a rig's sensors with their entries, in the file's order, and those left out.

        `models` are the `model_text` of the rig's models by the sensors' names.
        """
        own, found = {each.name: each for each in sensors}, []
        for source in self.sensors:
            if source.pose is None:
                values = source.name, ORIGIN, source.kind
                found.append(CarriedSensor(*values, entry=source.entry, is_left_out=True))
            elif source.name in own:
                found.append(source.restored(own.pop(source.name), models[source.name]))
        return (*found, *own.values())


def same_pose(a: Pose, b: Pose) -> bool:
    """Whether two poses are the same, but for rounding."""
    return all(map(is_there, a.position, b.position)) and is_turned_so(a, b)


def is_there(a: float, b: float) -> bool:
    """Whether two coordinates [m] are the same, but for rounding."""
    return abs(a - b) <= UNMOVED_M


def is_turned_so(a: Pose, b: Pose) -> bool:
    """Whether two poses are turned alike, but for rounding."""
    apart = np.abs(a.ground_from_sensor - b.ground_from_sensor)
    return bool(apart.max() <= UNTURNED)


def model_text(model: SensorModel) -> str:
    """Return what tells a model from others: its name in the catalogue, or its figures."""
    entry = catalog.entries().get(model.name)
    if entry is not None and entry.file != catalog.OWN and catalog.load(model.name) is model:
        return model.name
    text = json_entry(catalog.to_table(model))
    return text if len(text) <= LONGEST_MODEL else hashlib.sha256(text.encode()).hexdigest()


def same_model(a: str, b: str) -> bool:
    """Whether two models' texts are of one model, but for rounding."""
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
    each: CarriedSensor,
    fresh: Callable[[CarriedSensor], Mapping[str, Any]],
    pose_keys: Sequence[str],
    figure_keys: Sequence[str],
    part: str = "",
) -> dict[str, Any]:
    """Return a sensor's JSON object: that of its entry, with what has changed since.

    Parameters
    ----------
    each : CarriedSensor
    fresh : callable
        The object of a sensor that has no entry.
    pose_keys, figure_keys : sequence of str
        Keys that say where it is, and what its model is.
    part : str
        The key of this object, where an entry has several.
    """
    if not each.entry:
        return dict(fresh(each))
    row = _object_of(each, part)
    if each.is_left_out:
        return row
    changed = [*([] if each.is_unmoved else pose_keys)]
    changed += figure_keys if each.picture is not None or each.scan is not None else []
    now = fresh(each) if changed else {}
    for key in changed:
        if key in now:
            row[key] = now[key]
        else:
            row.pop(key, None)
    return row


def _object_of(each: CarriedSensor, part: str) -> dict[str, Any]:
    row = json.loads(each.entry)
    row = row.get(part) if part else row
    if not isinstance(row, dict):
        raise InputError("passthrough", f"entry of {each.name}", "a JSON object", shown(row))
    return row


def pose_entry(each: CarriedSensor, **more: Any) -> str:
    """Return an entry of a pose: position [m] and angles [rad], and what else stands there."""
    return json_entry({"pose": [list(each.pose.position), list(each.pose.rpy)], **more})


def pose_of_entry(each: CarriedSensor) -> Pose:
    """Return the pose of such an entry, or raise `InputError`."""
    found = entry_row(each, lambda _: {}, (), ()).get("pose")
    place, turn = found if isinstance(found, list) and len(found) == 2 else (found, None)
    return pose_from("passthrough", each.name, place, turn)


def json_entry(row: Any) -> str:
    """Return an object of a file as an entry."""
    return json.dumps(row, ensure_ascii=False, separators=(",", ":"))
