"""A LiDAR's table in a catalogue or a study, in degrees, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ..fields import number
from .angles import read_angles
from .model import Lidar

KEYS = frozenset(
    {
        "angles",
        "elevations_deg",
        "azimuth_count",
        "azimuth_step_deg",
        "max_range_m",
        "azimuth_offsets_deg",
        "horizontal_fov_deg",
    }
)


def read(name: str, table: Mapping[str, Any], folder: Path) -> Lidar:
    """Build a LiDAR from its table; a file of `angles` is relative to `folder`."""
    elevations, offsets = _channels(name, table, folder)
    fov = table.get("horizontal_fov_deg", (-180.0, 180.0))
    if not (isinstance(fov, (list, tuple)) and len(fov) == 2):
        raise InputError(name, "horizontal_fov_deg", "two angles", repr(fov))
    low, high = (math.radians(number(name, "horizontal_fov_deg", v)) for v in fov)
    return Lidar(
        name,
        elevations,
        _azimuth_count(name, table),
        number(name, "max_range_m", table.get("max_range_m")),
        offsets,  # type: ignore[arg-type]
        (low, high),
    )


def write(model: Lidar) -> dict[str, Any]:
    """Return a LiDAR's table."""
    table: dict[str, Any] = {
        "azimuth_count": model.azimuth_count,
        "max_range_m": model.max_range,
        "horizontal_fov_deg": [round(math.degrees(a), 9) for a in model.horizontal_fov],
        "elevations_deg": [round(math.degrees(a), 9) for a in model.elevations],
    }
    if model.azimuth_offsets.any():
        table["azimuth_offsets_deg"] = [round(math.degrees(a), 9) for a in model.azimuth_offsets]
    return table


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
        return int(number(name, "azimuth_count", table["azimuth_count"]))
    step = number(name, "azimuth_step_deg", table.get("azimuth_step_deg"))
    if not 0.0 < step <= 360.0:
        raise InputError(name, "azimuth_step_deg", "above 0 and up to 360 degrees", step)
    return round(360.0 / step)


def _radians(name: str, table: Mapping[str, Any], key: str) -> np.ndarray:
    values = table.get(key)
    if not isinstance(values, (list, tuple)) or not values:
        raise InputError(name, key, "a list of angles", repr(values))
    return np.array([math.radians(number(name, key, v)) for v in values])
