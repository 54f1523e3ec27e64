"""Sensor presets, one TOML file a maker, each figure with its source."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..kinds.camera.model import Camera
from ..kinds.lidar.angles import read_angles
from ..kinds.lidar.model import Lidar
from ..scene.sensors import SensorModel

PAPER_FILE = "paper.toml"
"""The paper's own sensors come first in lists."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One sensor of the catalogue: its table as the file has it, and the file's name."""

    name: str
    file: str
    table: Mapping[str, Any]

    @property
    def kind(self) -> str:
        """``"lidar"`` or ``"camera"``."""
        return str(self.table["kind"])

    @property
    def source(self) -> str:
        """Where the figures come from."""
        return str(self.table.get("source", ""))


@cache
def entries() -> dict[str, Entry]:
    """All entries by name, in the order of the files."""
    found: dict[str, Entry] = {}
    files = [f for f in resources.files(__package__).iterdir() if f.name.endswith(".toml")]
    for file in sorted(files, key=lambda f: (f.name != PAPER_FILE, f.name)):
        for name, table in tomllib.loads(file.read_text("utf-8")).items():
            if name in found:
                raise InputError(file.name, name, "a name used once", found[name].file)
            found[name] = Entry(name, file.name, table)
    return found


def names(kind: str | None = None) -> list[str]:
    """Names in the catalogue, of one kind or of all."""
    return [e.name for e in entries().values() if kind in (None, e.kind)]


@cache
def load(name: str) -> Lidar | Camera:
    """Return the sensor of that name; the same object every time.

    Raises
    ------
    InputError
        When there is no such sensor; the message offers near ones.
    """
    entry = entries().get(name)
    if entry is None:
        raise InputError("catalogue", "model", f"a name such as {_near(name)}", repr(name))
    return from_table(name, entry.table)


def from_table(name: str, table: Mapping[str, Any], folder: Path | None = None) -> Lidar | Camera:
    """Build a sensor from a catalogue table, or a user's own of the same form.

    LiDAR: ``kind = "lidar"``, ``elevations_deg``, ``azimuth_count`` or ``azimuth_step_deg``,
    ``max_range_m``; optional ``azimuth_offsets_deg`` (counter-clockwise from above) and
    ``horizontal_fov_deg``. In place of elevations and offsets, ``angles``: a file that
    `read_angles` reads, relative to `folder`. Camera: ``kind = "camera"``, ``width``,
    ``height``, ``hfov_deg``.

    Raises
    ------
    InputError
        When a value or the file of angles is wrong.
    """
    kind = table.get("kind")
    if kind == "lidar":
        return _lidar(name, table, folder or Path())
    if kind == "camera":
        return _camera(name, table)
    raise InputError(name, "kind", '"lidar" or "camera"', repr(kind))


LIDAR_KEYS = {
    "angles",
    "elevations_deg",
    "azimuth_count",
    "azimuth_step_deg",
    "max_range_m",
    "azimuth_offsets_deg",
    "horizontal_fov_deg",
}
CAMERA_KEYS = {"width", "height", "hfov_deg"}
COMMON_KEYS = {"kind", "source", "note"}


def _lidar(name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
    _check_keys(name, table, LIDAR_KEYS)
    elevations, offsets = _channels(name, table, folder)
    fov = table.get("horizontal_fov_deg", (-180.0, 180.0))
    if not (isinstance(fov, (list, tuple)) and len(fov) == 2):
        raise InputError(name, "horizontal_fov_deg", "two angles", repr(fov))
    low, high = (math.radians(_number(name, "horizontal_fov_deg", v)) for v in fov)
    return Lidar(
        name,
        elevations,
        _azimuth_count(name, table),
        _number(name, "max_range_m", table.get("max_range_m")),
        offsets,  # type: ignore[arg-type]
        (low, high),
    )


def _channels(
    name: str, table: Mapping[str, Any], folder: Path
) -> tuple[np.ndarray, np.ndarray | None]:
    """(C,) elevations and, if there are any, (C,) azimuth offsets [rad]."""
    if "angles" in table:
        return _channels_of_file(name, table, folder)
    elevations = _radians(name, table, "elevations_deg")
    if "azimuth_offsets_deg" not in table:
        return elevations, None
    return elevations, _radians(name, table, "azimuth_offsets_deg")


def _channels_of_file(
    name: str, table: Mapping[str, Any], folder: Path
) -> tuple[np.ndarray, np.ndarray]:
    file = table["angles"]
    if not isinstance(file, str) or not file:
        raise InputError(name, "angles", "the name of a file", repr(file))
    for key in ("elevations_deg", "azimuth_offsets_deg"):
        if key in table:
            raise InputError(name, "angles", f"either a file of angles or {key}", "both")
    try:
        channels = read_angles(folder / file)
    except InputError as error:  # the file stays in the message when a study puts itself in front
        field = f"angles: {error.source}: {error.field}"
        raise InputError(name, field, error.expected, error.found) from None
    return (
        np.array([math.radians(c.elevation_deg) for c in channels]),
        np.array([math.radians(c.azimuth_offset_deg) for c in channels]),
    )


def _azimuth_count(name: str, table: Mapping[str, Any]) -> int:
    """Steps in a circle: given, or 360 degrees over the nominal step, rounded."""
    if "azimuth_count" in table:
        return int(_number(name, "azimuth_count", table["azimuth_count"]))
    step = _number(name, "azimuth_step_deg", table.get("azimuth_step_deg"))
    if not 0.0 < step <= 360.0:
        raise InputError(name, "azimuth_step_deg", "above 0 and up to 360 degrees", step)
    return round(360.0 / step)


def _camera(name: str, table: Mapping[str, Any]) -> Camera:
    _check_keys(name, table, CAMERA_KEYS)
    width, height = (int(_number(name, k, table.get(k))) for k in ("width", "height"))
    return Camera(
        name, width, height, math.radians(_number(name, "hfov_deg", table.get("hfov_deg")))
    )


def _check_keys(name: str, table: Mapping[str, Any], known: set[str]) -> None:
    unknown = sorted(set(table) - known - COMMON_KEYS)
    if unknown:
        raise InputError(name, unknown[0], f"one of {', '.join(sorted(known))}", "an unknown key")


def _number(name: str, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(name, key, "a number", repr(value))
    return float(value)


def _radians(name: str, table: Mapping[str, Any], key: str) -> np.ndarray:
    values = table.get(key)
    if not isinstance(values, list) or not values:
        raise InputError(name, key, "a list of angles", repr(values))
    return np.array([math.radians(_number(name, key, v)) for v in values])


def _near(name: str) -> str:
    from difflib import get_close_matches

    lowered = {n.lower(): n for n in names()}
    close = get_close_matches(name.lower(), lowered, n=3, cutoff=0.4)
    return ", ".join(repr(lowered[c]) for c in close) or repr(names()[0])


def to_table(model: SensorModel) -> dict[str, Any]:
    """Return the table that `from_table` turns into this sensor again."""
    if isinstance(model, Camera):
        hfov = round(math.degrees(model.hfov), 9)
        return {"kind": "camera", "width": model.width, "height": model.height, "hfov_deg": hfov}
    assert isinstance(model, Lidar)
    table: dict[str, Any] = {
        "kind": "lidar",
        "azimuth_count": model.azimuth_count,
        "max_range_m": model.max_range,
        "horizontal_fov_deg": [round(math.degrees(a), 9) for a in model.horizontal_fov],
        "elevations_deg": [round(math.degrees(a), 9) for a in model.elevations],
    }
    if model.azimuth_offsets.any():
        table["azimuth_offsets_deg"] = [round(math.degrees(a), 9) for a in model.azimuth_offsets]
    return table
