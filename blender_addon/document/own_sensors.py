"""A file's own sensors: stored in the .blend, and in the catalogue while the file is open.

A camera's lens is stored as one line of text, with the keys of a study file.
"""

import tomllib
from collections.abc import Mapping
from typing import Any, TypeVar

import bpy
from bpy.types import PropertyGroup, Scene

from ..choices import free_name
from ..engine import catalog, pe, studies
from ..sensor_kinds import OwnCamera, OwnLidar
from .rig import sensor_objects
from .study_table import value_at

T = TypeVar("T")
_added: dict[str, dict[str, Any]] = {}
"""Tables that this add-on has added to the catalogue, by name."""
LENS_KEYS = frozenset({"fx", "fy", "cx", "cy", "fov_deg", "distortion"})
"""Any of these takes the place of a field of view."""
LINE_KEYS = ("fx", "fy", "cx", "cy", "fov_deg", "min_range_m", "max_range_m", "distortion")


def sync_own_sensors() -> None:
    """Update the catalogue so that it holds exactly the own sensors of the open file. A row with
    impossible figures or a name that is taken shows its error and is left out."""
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
            problem = problems.get(row.name, "")
            if row.problem != problem:
                row.problem = problem


def remove_own_sensors() -> None:
    """Remove all own sensors from the catalogue."""
    while _added:
        catalog.remove(_added.popitem()[0])


def table_of(row: PropertyGroup) -> dict[str, Any]:
    """Return an own sensor's figures as a table of the catalogue."""
    to_table, _ = CONVERSIONS.get(row.kind, OTHER)
    return {"kind": row.kind} | to_table(row)


def own_of(row: PropertyGroup, cls: type[T]) -> T:
    """Return the figures of an own sensor's row, impossible ones included."""
    found = {name: value_at(row.table, (name,)) for name in studies.settings_of(cls)}
    return cls(**{name: value for name, value in found.items() if value is not None})


def _camera_table(row: PropertyGroup) -> dict[str, Any]:
    own = own_of(row, OwnCamera)
    size = {"width": own.width, "height": own.height}
    lens = read_line(own.lens, "distortion")
    return size | ({} if LENS_KEYS & set(lens) else {"hfov_deg": own.hfov}) | lens


def _lidar_table(row: PropertyGroup) -> dict[str, Any]:
    own = own_of(row, OwnLidar)
    low, high = own.elevations
    steps = max(own.channels - 1, 1)
    return ({"min_range_m": own.min_range} if own.min_range > 0.0 else {}) | {
        "elevations_deg": [round(low + (high - low) * n / steps, 6) for n in range(own.channels)],
        "azimuth_step_deg": own.azimuth_step,
        "max_range_m": own.max_range,
        "horizontal_fov_deg": list(own.azimuths),
    }


def add_own_sensor(scene: Scene, name: str, table: Mapping[str, Any]) -> str:
    """Add an own sensor with the values of a catalogue table; return its name. The channels of a
    LiDAR become evenly spread."""
    row = scene.perception_entropy.own_sensors.add()
    row.kind = table["kind"]
    _, to_figures = CONVERSIONS.get(table["kind"], OTHER)
    for key, value in to_figures(table).items():
        setattr(row, key, value)
    row.name = free_name(name, set(catalog.entries()))
    sync_own_sensors()
    return str(row.name)


def _camera_figures(table: Mapping[str, Any]) -> dict[str, Any]:
    size = {key: table[key] for key in ("width", "height")}
    fov = {"hfov": table["hfov_deg"]} if "hfov_deg" in table else {}
    return size | fov | {"lens": lens_text(table)}


def _lidar_figures(table: Mapping[str, Any]) -> dict[str, Any]:
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


def own_sensors_signature(scene: Scene) -> list[object]:
    """Return the tables of the own sensors in use, because a score depends on them."""
    rows = {row.name: row for row in scene.perception_entropy.own_sensors}
    if not rows:
        return []
    used = {obj.perception_entropy.model for obj in sensor_objects(scene)}
    return [(name, table_of(rows[name])) for name in sorted(used & rows.keys())]


def _follow_name(scene: Scene, row: PropertyGroup) -> None:
    """Update the sensors of a model that was renamed."""
    before = row.known_as
    if before == row.name:
        return
    row.known_as = row.name
    for obj in sensor_objects(scene) if before else ():
        if obj.perception_entropy.model == before:
            obj.perception_entropy.model = row.name


def _add(name: str, table: dict[str, Any]) -> str:
    """Add a table to the catalogue; return the error, or "" for none."""
    try:
        catalog.add(name, table)
    except pe.InputError as error:
        return str(error)
    _added[name] = table
    return ""


def read_line(text: str, refused_as: str) -> dict[str, Any]:
    """Return the keys of a line of text. A line that cannot be parsed becomes the value of the key
    `refused_as`, so that the engine reports it as an error."""
    try:
        return dict(tomllib.loads(f"line = {{ {text} }}")["line"])
    except tomllib.TOMLDecodeError:
        return {refused_as: text}


def lens_text(table: Mapping[str, Any]) -> str:
    """Return the lens of a camera's table as a line of text; empty without lens keys."""
    return line_of({key: table[key] for key in LINE_KEYS if key in table})


def line_of(table: Mapping[str, Any]) -> str:
    """Return a table as a line of text, with the keys of a study file."""
    return ", ".join(f"{key} = {_value(value)}" for key, value in table.items())


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"{{ {line_of(value)} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


CONVERSIONS = {"lidar": (_lidar_table, _lidar_figures), "camera": (_camera_table, _camera_figures)}
"""By kind: from an own sensor to a table of the catalogue, and from such a table to properties."""
OTHER = (
    lambda row: read_line(row.keys, "keys"),
    lambda table: {"keys": line_of({key: table[key] for key in table if key != "kind"})},
)
"""Of a kind without fields of its own: a line of text has its keys."""
