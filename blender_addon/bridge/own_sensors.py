"""A file's own sensors: figures in the .blend, entries of the catalogue while it is open."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy

from ..choices import free_name
from ..engine import catalog, pe
from .lens_text import LENS_KEYS, lens_text, read_lens
from .rig import sensor_objects
from .typed import as_typed, pair_as_typed

_added: dict[str, dict[str, Any]] = {}
"""What this add-on has put into the catalogue, by name: tables."""


def sync_own_sensors() -> None:
    """Have the catalogue hold the own sensors of the open file, as they are now, and no others.

    A row whose figures are impossible, or whose name is taken, says so and is left out.
    """
    wanted: dict[str, dict[str, Any]] = {}
    for scene in bpy.data.scenes:
        for row in scene.perception_entropy.own_sensors:
            _follow_name(scene, row)
            wanted.setdefault(row.name, table_of(row))
    for name in [name for name, table in _added.items() if wanted.get(name) != table]:
        catalog.remove(name)
        del _added[name]
    problems = {name: _add(name, table) for name, table in wanted.items() if name not in _added}
    for scene in bpy.data.scenes:
        for row in scene.perception_entropy.own_sensors:
            said = problems.get(row.name, "")
            if row.problem != said:
                row.problem = said


def forget_own_sensors() -> None:
    """Take them all out of the catalogue."""
    while _added:
        catalog.remove(_added.popitem()[0])


def table_of(row: bpy.types.PropertyGroup) -> dict[str, Any]:
    """Return an own sensor's figures as the catalogue takes them."""
    if row.kind == "camera":
        size = {"kind": "camera", "width": row.width, "height": row.height}
        lens = read_lens(row.lens)
        return size | ({} if LENS_KEYS & set(lens) else {"hfov_deg": as_typed(row.hfov)}) | lens
    least = {"min_range_m": as_typed(row.min_range)} if row.min_range > 0.0 else {}
    return least | {
        "kind": "lidar",
        "elevations_deg": _elevations(row),
        "azimuth_step_deg": as_typed(row.azimuth_step),
        "max_range_m": as_typed(row.max_range),
        "horizontal_fov_deg": list(pair_as_typed(row.azimuths)),
    }


def add_own_sensor(scene: bpy.types.Scene, name: str, table: Mapping[str, Any]) -> str:
    """Add an own sensor with a catalogue table's figures, and return what it is called.

    LiDARs have evenly spread channels here.
    """
    row = scene.perception_entropy.own_sensors.add()
    row.kind = table["kind"]
    for key, value in _figures(table).items():
        setattr(row, key, value)
    row.name = free_name(name, set(catalog.entries()))
    sync_own_sensors()
    return str(row.name)


def _figures(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the properties of a row that has a table's figures."""
    if table["kind"] == "camera":
        known = {k: table[k] for k in ("width", "height")}
        known |= {"hfov": table["hfov_deg"]} if "hfov_deg" in table else {}
        return known | {"lens": lens_text(table)}
    elevations = table["elevations_deg"]
    step = table.get("azimuth_step_deg") or 360.0 / table["azimuth_count"]
    return {
        "channels": len(elevations),
        "elevations": (min(elevations), max(elevations)),
        "azimuths": tuple(table.get("horizontal_fov_deg", (-180.0, 180.0))),
        "azimuth_step": step,
        "max_range": table["max_range_m"],
        "min_range": table.get("min_range_m", 0.0),
    }


def own_sensors_signature(scene: bpy.types.Scene) -> list[object]:
    """Return what a score depends on of own sensors that are mounted."""
    rows = {row.name: row for row in scene.perception_entropy.own_sensors}
    if not rows:
        return []
    used = {obj.perception_entropy.model for obj in sensor_objects(scene)}
    return [(name, table_of(rows[name])) for name in sorted(used & rows.keys())]


def _elevations(row: bpy.types.PropertyGroup) -> list[float]:
    """Elevations of channels that are evenly spread, lowest first [deg]."""
    low, high = pair_as_typed(row.elevations)
    steps = max(row.channels - 1, 1)
    return [round(low + (high - low) * n / steps, 6) for n in range(row.channels)]


def _follow_name(scene: bpy.types.Scene, row: bpy.types.PropertyGroup) -> None:
    """Have sensors of a renamed model go with it."""
    before = row.known_as
    if before == row.name:
        return
    row.known_as = row.name
    for obj in sensor_objects(scene) if before else ():
        if obj.perception_entropy.model == before:
            obj.perception_entropy.model = row.name


def _add(name: str, table: dict[str, Any]) -> str:
    """Put one into the catalogue; return why that is not possible, or nothing."""
    try:
        catalog.add(name, table)
    except pe.InputError as error:
        return str(error)
    _added[name] = table
    return ""
