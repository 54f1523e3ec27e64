"""The study file: TOML to `Study` and back."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from .. import catalog
from ..base.errors import InputError, shown
from ..base.files import decode_text, read_bytes, write_bytes
from ..base.plugins import shipped
from ..base.setting import read_declared, read_settings, settings_table
from ..base.table_reader import Table, dumps, load_toml
from ..base.values import A_NAME, A_PATH, ANY
from ..geometry.grids import PerceptionSpace
from ..geometry.poses import Pose
from ..scene.mesh import MeshAxes, require_vehicle_size
from ..scene.rig import Rig, Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..search import PAPER_FREE, checked_axes
from .conditions import condition_tables, read_conditions
from .mounting_file import areas_of, same_model
from .passthrough import passthrough_table, read_passthrough
from .requirement_file import mesh_files, read_requirements, requirement_table
from .scoring_file import (
    curves_table,
    prior_table,
    read_curve,
    read_model,
    read_prior,
    read_targets,
    targets_table,
)
from .search_file import (
    in_file,
    read_limits,
    read_search,
    read_selection,
    search_table,
    selection_tables,
)
from .study import Search, Study

OWN_MODEL = "own"
"""Name of an own model in a choice that has no name."""


def load_study(path: str | Path) -> Study:
    """Read a study from its TOML file.

    Raises
    ------
    InputError
        One line with the file, the field, what was expected and what was found.
    """
    path = Path(path)
    return study_from_dict(load_study_data(path), str(path), path.parent)


def load_study_data(path: Path) -> dict[str, Any]:
    """Read the plain data of a study's TOML file; `InputError` where it is none."""
    return load_toml(path, "study", decode_text(read_bytes(path)))


def save_study(study: Study, path: str | Path) -> None:
    """Write a study's TOML file, atomically.

    Mesh, areas and boxes are not written, but have to be there; `export_study` writes them, too.

    Raises
    ------
    InputError
        When the vehicle's mesh, an area or the prior's boxes are in no file, or the study cannot
        be written.
    """
    path = Path(path)
    _check_beside(path, "vehicle.mesh", study.vehicle is not None, study.mesh)
    boxes = study.prior.boxes
    _check_beside(path, "prior.boxes", boxes is not None, boxes.file if boxes else None)
    for name, file in mesh_files(study.requirements):
        _check_beside(path, f"requirement {name!r}: body.mesh", True, file)
    for name, area in areas_of(study.search.mounting).items():
        _check_beside(path, f"mount {name!r}: area", True, area.file)
    write_bytes(path, study_bytes(study))


def study_bytes(study: Study) -> bytes:
    """Return a study file's text; the files that it names need not exist."""
    return dumps(study_to_dict(study)).encode()


def study_from_dict(data: Any, source: str = "study", folder: Path | None = None) -> Study:
    """Build a study from the plain data of its file; paths in it are relative to `folder`."""
    table = Table(data, source)
    try:
        study = _read_study(table, folder or Path())
    except InputError as error:
        raise error if error.source == source else _named(error, source) from None
    table.finish()
    return study


def study_to_dict(study: Study) -> dict[str, Any]:
    """Return a study as the plain data its file holds."""
    data = {
        "samples": study.samples or None,
        "space": settings_table(study.space),
        "prior": prior_table(study.prior),
        "metric": targets_table(study.targets),
        "ap": curves_table(study.model),
        "fusion": {"blind": study.model.blind},
        "vehicle": _vehicle_table(study),
        "reference": None if study.reference is None else settings_table(study.reference),
        "sensor": [_sensor_table(s, study.search) for s in study.rig],
        "passthrough": passthrough_table(study.passthrough),
        "requirement": [requirement_table(each) for each in study.requirements] or None,
        **condition_tables(study.conditions),
        "optimize": search_table(study.search, is_choice=bool(study.selection.choices)),
        **selection_tables(study.selection, _model_value),
    }
    plain: dict[str, Any] = _without_none(data)
    return plain


def _check_beside(path: Path, field: str, needed: bool, file: str | None) -> None:
    """Raise `InputError` for a file that the study names and that does not exist."""
    if needed and not (file and os.path.exists(path.parent / file)):
        expected = "a file beside the study (pe.export_study writes it)"
        raise InputError(path, field, expected, shown(file) if file else "none")


def _named(error: InputError, source: str) -> InputError:
    """Return an error with the study's file as its source."""
    return InputError(source, f"{error.source}: {error.field}", error.expected, error.found)


def _read_study(table: Table, folder: Path) -> Study:
    vehicle, file = _read_vehicle(table.table("vehicle"), folder)
    sensors, search = table.tables("sensor"), table.table("optimize")
    if not sensors:
        raise table.error("sensor", "at least one [[sensor]]", "none")
    default_free = _axes(search, "free", PAPER_FREE)
    mounted = [_read_sensor(s, folder) for s in sensors]
    free, limits, on = {}, {}, {}
    for sensor, own in zip(mounted, sensors, strict=True):
        free[sensor.name] = _axes(own, "free", default_free)
        limits[sensor.name] = read_limits(own.table("bounds"))
        if (mount := own.text("mount", None, rule=A_NAME)) is not None:
            on[sensor.name] = mount
        own.finish()
    study = Study(
        Rig(mounted),
        vehicle,
        read_declared(table.table("space"), PerceptionSpace),
        read_prior(table.table("prior"), folder),
        read_model(table.table("ap"), table.table("fusion")),
        read_search(search, free, limits, on, folder, is_choice="choice" in table),
        read_settings(table, Study)["samples"],
        *file,
        read_declared(table.table("reference"), Reference) if "reference" in table else None,
        read_selection(table, lambda option: _read_intrinsics(option, OWN_MODEL, folder)),
        read_targets(table.table("metric")),
        read_passthrough(table.table("passthrough")) if "passthrough" in table else None,
        read_requirements(table, folder),
        read_conditions(table),
    )
    study.designs()
    if study.requirements:
        study.checker()  # zones that cannot be placed are bad input, too
    study.coding()  # bounds that do not hold their start are bad input, not a late surprise
    return study


def _read_vehicle(table: Table, folder: Path) -> tuple[Vehicle | None, MeshFile]:
    mesh = table.text("mesh", None, rule=A_PATH)
    keys = ("glass", "covers", "clearance", *AXES_KEYS)
    if mesh is None and any(key in table for key in keys):
        raise table.error("mesh", "the file of the vehicle's mesh", "nothing")
    glass = table.texts("glass", ())
    settings = {"covers": table.raw("covers", {}), **read_settings(table, Vehicle)}
    axes = read_axes(table)
    table.finish()
    if mesh is None:
        return None, MeshFile()
    read = shipped("reader.mesh")(folder / mesh, axes)
    require_vehicle_size(mesh, read)
    vehicle = Vehicle(read.triangles, read.parts, read.part_names, glass, **settings)
    return vehicle, MeshFile(mesh, axes, read.axes)


def _read_sensor(table: Table, folder: Path) -> Sensor:
    name = table.text("name", rule=A_NAME)
    position = table.numbers("position", 3)
    rotation = table.numbers("rotation", 3, (0.0, 0.0, 0.0))
    fusion = table.text("fusion", None, rule=A_NAME)
    with table.naming():
        pose = Pose.from_degrees(position, rotation)
        intrinsics = _read_intrinsics(table, name, folder)
    curve = read_curve(table.table("ap")) if "ap" in table else None
    color = table.text("color", None)
    with table.naming():
        return Sensor(name, intrinsics, pose, fusion, curve, color)


def _read_intrinsics(table: Table, sensor: str, folder: Path) -> SensorModel:
    """Return a model of the catalogue, or an own model from the table's values."""
    model = table.raw("model")
    if isinstance(model, str):
        return catalog.load(model)
    if not isinstance(model, Mapping):
        raise table.error("model", "a catalogue name or a table", shown(model))
    own = dict(model)
    name = own.pop("name", sensor)
    try:
        return catalog.from_table(name, own, folder)
    except InputError as error:
        raise table.error(f"model.{error.field}", error.expected, error.found) from None


def _axes(table: Table, key: str, default: tuple[str, ...]) -> tuple[str, ...]:
    return checked_axes(table.source, table.field(key), table.texts(key, default))


def _vehicle_table(study: Study) -> dict[str, Any] | None:
    if study.vehicle is None:
        return None
    rotation = None if study.axes.rotation_deg is None else list(study.axes.rotation_deg)
    scale = None if study.axes.scale == 1.0 else study.axes.scale
    return {
        "mesh": study.mesh,
        "glass": list(study.vehicle.glass),
        **({"covers": dict(study.vehicle.covers)} if study.vehicle.covers else {}),
        **settings_table(study.vehicle),
        "scale": scale,
        "rotation": rotation,
        "up": study.axes.up,
        "forward": study.axes.forward,
    }


def _sensor_table(sensor: Sensor, search: Search) -> dict[str, Any]:
    own = search.limits.get(sensor.name, {})
    limits = {axis: [in_file(axis, v) for v in bounds] for axis, bounds in own.items()}
    return {
        "name": sensor.name,
        "model": _model_value(sensor.model, sensor.name),
        "position": list(sensor.pose.position),
        "rotation": list(sensor.pose.rotation_deg),
        "fusion": sensor.fusion,
        "ap": None if sensor.curve is None else settings_table(sensor.curve),
        "color": sensor.color,
        "free": list(search.free.get(sensor.name, PAPER_FREE)),
        "bounds": limits or None,
        "mount": search.mounting.on.get(sensor.name),
    }


def _model_value(model: SensorModel, unnamed: str = OWN_MODEL) -> str | dict[str, Any]:
    """Return the catalogue's name of a model, or the values of an own model.

    `unnamed` is the name of a model that has none in the file.
    """
    entry = catalog.entries().get(model.name)
    if (
        entry is not None
        and entry.file != catalog.OWN
        and same_model(catalog.load(model.name), model)
    ):
        return model.name
    name = {} if model.name == unnamed else {"name": model.name}
    return name | catalog.to_table(model)


def _without_none(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {k: _without_none(v) for k, v in value.items() if v is not None}
    if isinstance(value, list):
        return [_without_none(v) for v in value]
    return value


AXES_KEYS = ("scale", "rotation", "up", "forward")


class MeshFile(NamedTuple):
    """A vehicle's mesh file, its axes by the study, and the axes that were used, in words."""

    mesh: str | None = None
    axes: MeshAxes = MeshAxes()
    faces: str = ""


def read_axes(table: Table) -> MeshAxes:
    """Return the axes of the mesh file, from [vehicle]."""
    up, forward = table.text("up", None), table.text("forward", None)
    scale = table.number("scale", 1.0, rule=ANY)
    rotation = table.numbers("rotation", 3, None)
    with table.naming():
        return MeshAxes(up, forward, scale, rotation)  # type: ignore[arg-type]  # three of them
