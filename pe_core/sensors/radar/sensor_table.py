"""A radar's table in a catalogue or a study: read, and written, in degrees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ...base.degrees import degrees_in_file
from ...base.errors import InputError, shown
from ...base.values import Number, listed
from .model import Radar, RadarMode
from .reflectivity import read_reflectivity, write_reflectivity

OWN = (
    *("reference_rcs_dbsm", "detection_probability", "false_alarm", "list_length"),
    *("cover_loss_db", "attenuation_db_km"),
)
"""Keys that are fields of the model."""
MODE_KEYS = frozenset(
    {
        *("name", "azimuth_deg", "range_m", "elevation_deg", "elevation_scale"),
        *("range_resolution_m", "azimuth_resolution_deg", "elevation_resolution_deg"),
        *("min_range_m", "max_range_m", "bandwidth_mhz"),
    }
)
KEYS = frozenset({"mode", "rcs_dbsm", *OWN})
DEGREES = Number(cap=1e6, unit="degrees", noun="angle")


def read(name: str, table: Mapping[str, Any]) -> Radar:
    """Build a radar from its table; `mode` is a list of tables, one for each scan of a frame.

    Raises
    ------
    InputError
        When a key is missing or unknown, or a figure is impossible.
    """
    modes = listed(table.get("mode"), 100)
    if not modes:
        raise InputError(name, "mode", "a list of tables, one a mode", shown(table.get("mode")))
    own = {key: table[key] for key in OWN if key in table}
    rcs = read_reflectivity(name, table.get("rcs_dbsm", {}))
    read_modes = [_mode(name, mode, number) for number, mode in enumerate(modes)]
    return Radar(name, read_modes, rcs=rcs, **own)


def _mode(name: str, table: Any, number: int) -> RadarMode:
    if not isinstance(table, Mapping):
        raise InputError(name, f"mode {number + 1}", "a table", shown(table))
    for key in table:
        if key not in MODE_KEYS:
            expected = f"one of {', '.join(sorted(MODE_KEYS))}"
            raise InputError(name, f"mode {number + 1}: {key}", expected, "an unknown key")
    try:
        return RadarMode(
            table.get("name", f"mode {number + 1}"),
            _radians("azimuth_deg", table),
            table.get("range_m"),  # type: ignore[arg-type]  # checked by the model
            _radians("elevation_deg", table),
            table.get("elevation_scale", 1.0),
            table.get("range_resolution_m"),
            _radian("azimuth_resolution_deg", table),
            _radian("elevation_resolution_deg", table),
            table.get("min_range_m", 0.0),
            table.get("max_range_m"),
            table.get("bandwidth_mhz"),
        )
    except InputError as error:  # name the radar as well
        raise InputError(
            name, f"{error.source}: {error.field}", error.expected, error.found
        ) from None


def _radians(key: str, table: Mapping[str, Any]) -> Any:
    values = listed(table.get(key))
    if values is None:
        return table.get(key)
    return [math.radians(DEGREES.checked("mode", key, value)) for value in values]


def _radian(key: str, table: Mapping[str, Any]) -> float | None:
    if table.get(key) is None:
        return None
    return math.radians(DEGREES.checked("mode", key, table[key]))


def write(model: Radar) -> dict[str, Any]:
    """Return a radar's table."""
    default = Radar(model.name, model.modes)
    own = {key: getattr(model, key) for key in OWN}
    table = {k: v for k, v in own.items() if v is not None and v != getattr(default, k)}
    if model.rcs:
        table["rcs_dbsm"] = write_reflectivity(model.rcs)
    table["mode"] = [_mode_table(mode) for mode in model.modes]
    return table


def _mode_table(mode: RadarMode) -> dict[str, Any]:
    table: dict[str, Any] = {
        "name": mode.name,
        "azimuth_deg": [degrees_in_file(a) for a in mode.azimuths.tolist()],
        "range_m": _shortest(mode.ranges.tolist()),
        "elevation_deg": [degrees_in_file(a) for a in mode.elevations.tolist()],
        "min_range_m": mode.min_range,
        "max_range_m": mode.max_range,
    }
    if any(scale != 1.0 for scale in mode.scales.tolist()):
        table["elevation_scale"] = _shortest(mode.scales.tolist())
    if mode.range_resolution is not None:
        table["range_resolution_m"] = mode.range_resolution
    if mode.bandwidth_mhz is not None:
        table["bandwidth_mhz"] = mode.bandwidth_mhz
    for key in ("azimuth_resolution", "elevation_resolution"):
        if (angle := getattr(mode, key)) is not None:
            table[f"{key}_deg"] = degrees_in_file(angle)
    return table


def _shortest(values: list[float]) -> float | list[float]:
    """Return one number in place of a list of equal ones."""
    return values[0] if len(set(values)) == 1 else values
