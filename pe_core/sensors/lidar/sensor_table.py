"""A LiDAR's table in a catalogue or a study: read, and written, in degrees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...base.degrees import degrees_in_file
from ...base.errors import InputError, shown
from ...base.plugins import shipped
from ...base.values import A_PATH, Number, listed, vector
from ..field_of_view import NEAREST
from .model import RANGE, STEPS, Lidar

KEYS = frozenset(
    {
        "angles",
        "elevations_deg",
        "azimuth_count",
        "azimuth_step_deg",
        "max_range_m",
        "min_range_m",
        "azimuth_offsets_deg",
        "horizontal_fov_deg",
    }
)
DEGREES = Number(cap=1e6, unit="degrees", noun="angle")
STEP_DEG = Number(0.001, 360.0, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
    """Build a LiDAR from its table; the path of a file of `angles` is relative to `folder`."""
    elevations, offsets = _channels(name, table, folder)
    fov = table.get("horizontal_fov_deg", (-180.0, 180.0))
    low, high = map(math.radians, vector(name, "horizontal_fov_deg", fov, 2, DEGREES))
    return Lidar(
        name,
        elevations,
        _azimuth_count(name, table),
        RANGE.checked(name, "max_range_m", table.get("max_range_m")),
        offsets,  # type: ignore[arg-type]
        (low, high),
        table.get("min_range_m", NEAREST),
    )


def write(model: Lidar) -> dict[str, Any]:
    """Return a LiDAR's table."""
    table: dict[str, Any] = {
        "azimuth_count": model.azimuth_count,
        "max_range_m": model.max_range,
        "horizontal_fov_deg": [degrees_in_file(a) for a in model.horizontal_fov],
        "elevations_deg": [degrees_in_file(a) for a in model.elevations.tolist()],
    }
    if any(offsets := model.azimuth_offsets.tolist()):
        table["azimuth_offsets_deg"] = [degrees_in_file(a) for a in offsets]
    if model.min_range > NEAREST:
        table["min_range_m"] = model.min_range
    return table


def _channels(
    name: str, table: Mapping[str, Any], folder: Path
) -> tuple[np.ndarray, np.ndarray | None]:
    """Elevations (C,) and, if the table has them, azimuth offsets (C,) [rad]."""
    if "angles" in table:
        return _channels_of_file(name, table, folder)
    elevations = _radians(name, table, "elevations_deg")
    if "azimuth_offsets_deg" not in table:
        return elevations, None
    return elevations, _radians(name, table, "azimuth_offsets_deg")


def _channels_of_file(
    name: str, table: Mapping[str, Any], folder: Path
) -> tuple[np.ndarray, np.ndarray]:
    file = A_PATH.checked(name, "angles", table["angles"])
    for key in ("elevations_deg", "azimuth_offsets_deg"):
        if key in table:
            raise InputError(name, "angles", f"either a file of angles or {key}", "both")
    try:
        channels = shipped("reader.angles")(folder / file)
    except InputError as error:  # a study replaces the source; the field keeps the file's name
        field = f"angles: {error.source}: {error.field}"
        raise InputError(name, field, error.expected, error.found) from None
    return (
        np.array([math.radians(c.elevation_deg) for c in channels]),
        np.array([math.radians(c.azimuth_offset_deg) for c in channels]),
    )


def _azimuth_count(name: str, table: Mapping[str, Any]) -> int:
    """Azimuth steps in a circle: given, or 360 degrees over the nominal step, rounded."""
    if "azimuth_count" in table:
        return STEPS.checked(name, "azimuth_count", table["azimuth_count"])
    step = STEP_DEG.checked(name, "azimuth_step_deg", table.get("azimuth_step_deg"))
    return round(360.0 / step)


def _radians(name: str, table: Mapping[str, Any], key: str) -> np.ndarray:
    values = listed(table.get(key))
    if not values:
        raise InputError(name, key, "a list of angles", shown(table.get(key)))
    return np.array([math.radians(DEGREES.checked(name, key, v)) for v in values])
