"""The study file: TOML to `Study` and back; all its settings by table, for panel and docs."""

import functools
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from .. import catalog
from ..base.errors import InputError, shown
from ..base.files import decode_text, read_bytes, write_bytes
from ..base.plugins import shipped
from ..base.setting import (
    REQUIRED,
    OneOf,
    Setting,
    Several,
    changed_settings,
    key_of,
    read_declared,
    read_settings,
    settings_of,
    settings_table,
    value_in_file,
)
from ..base.table_reader import Table, dumps, inline, load_toml
from ..base.values import A_NAME, A_PATH, ANY, Angle
from ..geometry.grids import PerceptionSpace
from ..geometry.poses import Pose
from ..metric.entropy import ApCurve
from ..metric.frames import Frames
from ..motion import Confirmation, Story
from ..prior.prior import Focus
from ..scene.data_sheet import DataSheet
from ..scene.mesh import MeshAxes, require_vehicle_size
from ..scene.rig import Rig, Sensor, SensorModel
from ..scene.vehicle import Vehicle
from ..scene.vehicle_description import Reference
from ..scene.vehicle_state import Motion, State
from ..scoring.requirements import Criterion, Under, Zone
from ..scoring.targets import TargetRule
from ..search import (
    PAPER_FREE,
    Constraints,
    Front,
    Goals,
    Limits,
    NoGo,
    Option,
    Schedule,
    Selection,
    Stop,
    SurfaceMount,
    Tolerance,
    checked_axes,
)
from ..search.tolerance import CASES, ERRORS
from ..sensors import PerceptionModel
from ..sensors.weather import Weather
from .conditions import BODY, OF_STATE, condition_tables, read_conditions
from .mounting_file import areas_of, same_model
from .requirement_file import read_requirements, requirement_table
from .scoring_file import (
    curve_table,
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
from .time_file import read_stories, read_time, story_table, time_table

OWN_MODEL = "own"  # Name of an own model in a choice that has no name
MEASUREMENT = ("returns",)  # Settings of a study in [measurement]
AXES_KEYS = ("scale", "rotation", "up", "forward")


def load_study(path: str | Path, *, starts_anywhere: bool = False) -> Study:
    """Read a study from its TOML file.

    `InputError`: one line with the file, the field, what was expected and what was found.

    Parameters
    ----------
    starts_anywhere : bool
        Whether sensors may be off their mounts: `Study.on_mounts` puts them there. Such a study
        cannot be searched before.
    """
    path = Path(path)
    data = load_study_data(path)
    return study_from_dict(data, str(path), path.parent, starts_anywhere=starts_anywhere)


def load_study_data(path: Path) -> dict[str, Any]:
    """Read the plain data of a study's TOML file; `InputError` where it is none."""
    return load_toml(path, "study", decode_text(read_bytes(path)))


def save_study(study: Study, path: str | Path) -> None:
    """Write a study's TOML file, atomically.

    The files that it names are not written, but have to be there; `export_study` writes them, too.

    `InputError` when the vehicle's mesh, an area or the prior's boxes or weights are in no file, or
    the study cannot be written.
    """
    path = Path(path)
    _check_beside(path, "vehicle.mesh", study.vehicle is not None, study.mesh)
    for key, prior in (("boxes", study.prior.boxes), ("grid", study.prior.grid)):
        _check_beside(path, f"prior.{key}", prior is not None, prior.file if prior else None)
    for name, area in areas_of(study.search.mounting).items():
        _check_beside(path, f"mount {name!r}: area", True, area.file)
    write_bytes(path, study_bytes(study))


def study_bytes(study: Study) -> bytes:
    """Return a study file's text; the files that it names need not exist."""
    return dumps(study_to_dict(study)).encode()


def rig_line(rig: Rig) -> str:
    """Return a rig as one line: a line of a study file, and a study file by itself."""
    rows = [_without_none(_mounted_table(sensor)) for sensor in rig]
    return f"sensor = {inline(rows)}"


def read_rig_line(text: str, source: str = "rig") -> Rig:
    """Return the rig of a text of `rig_line`, or of a study file's; all else in it is left out."""
    sensors = load_toml(source, "study", text).get("sensor")
    if not sensors:
        raise InputError(source, "sensor", "a line as `pe rigs --of STUDY` prints it", shown(text))
    return study_from_dict({"sensor": sensors}, source).rig


def study_from_dict(
    data: Any, source: str = "study", folder: Path | None = None, *, starts_anywhere: bool = False
) -> Study:
    """Build a study from the plain data of its file; paths in it are relative to `folder`. For
    `starts_anywhere` see `load_study`."""
    table = Table(data, source)
    try:
        study = _read_study(table, folder or Path())
        if not starts_anywhere:
            study.coding()  # bounds that do not hold their start are bad input, not a late surprise
    except InputError as error:
        raise error if error.source == source else error.within(source) from None
    table.finish()
    return study


def study_to_dict(study: Study) -> dict[str, Any]:
    """Return a study as the plain data its file holds."""
    data = {
        "samples": study.samples or None,
        "space": settings_table(study.space),
        "prior": prior_table(study.prior),
        "metric": targets_table(study.targets),
        "measurement": changed_settings(study, MEASUREMENT) or None,
        "ap": curves_table(study.model),
        "fusion": {"blind": study.model.blind},
        "vehicle": _vehicle_table(study),
        "reference": None if study.reference is None else settings_table(study.reference),
        "sensor": [_sensor_table(s, study.search) for s in study.rig],
        "requirement": [requirement_table(each) for each in study.requirements] or None,
        **condition_tables(study.conditions),
        "time": time_table(study.frames, study.confirmation) or None,
        "story": [story_table(each) for each in study.stories] or None,
        "limits": changed_settings(study.limits) or None,
        "optimize": search_table(study.search, is_choice=bool(study.selection.choices)),
        **selection_tables(study.selection, _model_value),
    }
    plain: dict[str, Any] = _without_none(data)
    return plain


def _check_beside(path: Path, field: str, needed: bool, file: str | None) -> None:
    """Raise `InputError` for a file that the study names and that does not exist."""
    if needed and not (file and os.path.exists(path.parent / file)):
        expected = "a file beside the study (export_study of pe_tools writes it)"
        raise InputError(path, field, expected, shown(file) if file else "none")


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
    frames, confirmation = read_time(table.table("time"))
    study = Study(
        Rig(mounted),
        vehicle,
        read_declared(table.table("space"), PerceptionSpace),
        read_prior(table.table("prior"), folder),
        read_model(table.table("ap"), table.table("fusion")),
        read_search(search, free, limits, on, folder, is_choice="choice" in table),
        read_settings(table, Study, ("samples",))["samples"],
        *file,
        read_declared(table.table("reference"), Reference) if "reference" in table else None,
        read_selection(table, lambda option: _read_intrinsics(option, OWN_MODEL, folder)),
        read_targets(table.table("metric")),
        read_requirements(table),
        read_conditions(table),
        **_read_measurement(table.table("measurement")),
        limits=read_declared(table.table("limits"), Limits),
        frames=frames,
        confirmation=confirmation,
        stories=read_stories(table.tables("story")),
    )
    study.designs()
    if study.requirements:
        study.checker()  # zones that cannot be placed are bad input, too
    return study


def _read_measurement(table: Table) -> dict[str, Any]:
    values = read_settings(table, Study, MEASUREMENT)
    table.finish()
    return values


def _read_vehicle(table: Table, folder: Path) -> "tuple[Vehicle | None, MeshFile]":
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
    return vehicle, MeshFile(mesh, axes, read.axes, read.notes)


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
        sheet = DataSheet(**read_settings(table, DataSheet))
        return Sensor(name, intrinsics, pose, fusion, curve, color, sheet)


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
        **_mounted_table(sensor),
        "free": list(search.free.get(sensor.name, PAPER_FREE)),
        "bounds": limits or None,
        "mount": search.mounting.on.get(sensor.name),
    }


def _mounted_table(sensor: Sensor) -> dict[str, Any]:
    """Return a sensor without what a search may change of it."""
    return {
        "name": sensor.name,
        "model": _model_value(sensor.model, sensor.name),
        "position": list(sensor.pose.position),
        "rotation": list(sensor.pose.rotation_deg),
        "fusion": sensor.fusion,
        "ap": None if sensor.curve is None else curve_table(sensor.curve),
        "color": sensor.color,
        **settings_table(sensor.sheet),
    }


def _model_value(model: SensorModel, unnamed: str = OWN_MODEL) -> str | dict[str, Any]:
    """Return the catalogue's name of a model, or the values of an own model. `unnamed` is the name
    of a model that has none in the file."""
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


class MeshFile(NamedTuple):
    """A vehicle's mesh file, its axes by the study, the axes that were used, in words, and notes
    on what of the file is left out."""

    mesh: str | None = None
    axes: MeshAxes = MeshAxes()
    faces: str = ""
    mesh_notes: tuple[str, ...] = ()


def read_axes(table: Table) -> MeshAxes:
    """Return the axes of the mesh file, from [vehicle]."""
    up, forward = table.text("up", None), table.text("forward", None)
    scale = table.number("scale", 1.0, rule=ANY)
    rotation = table.numbers("rotation", 3, None)
    with table.naming():
        return MeshAxes(up, forward, scale, rotation)  # type: ignore[arg-type]  # three of them


@dataclass(frozen=True, slots=True)
class StudyTable:
    """A table of the study file, and the dataclass whose settings stand in it.

    `names` are those of the settings, where the table has not all of the dataclass's. Of `rows`
    there are several in a study: each is a row, or an object, of a Blender scene, not the scene.
    `part` is the part of Blender's panel with these settings; that of the table if it is empty.
    """

    table: str
    cls: type
    names: tuple[str, ...] = ()
    rows: bool = False
    part: str = ""

    @property
    def settings(self) -> list[Setting]:
        """The settings of the table, in their order."""
        settings = settings_of(self.cls)
        return [settings[name] for name in self.names or settings]


SECTIONS = (
    StudyTable("", Study, ("samples",), part="score"),
    StudyTable("space", PerceptionSpace),
    StudyTable("vehicle", Vehicle),
    StudyTable("metric", TargetRule),
    StudyTable("measurement", Study, MEASUREMENT, part="metric"),
    StudyTable("ap", PerceptionModel),
    StudyTable("reference", Reference),
    StudyTable("time", Frames),
    StudyTable("time", Confirmation),
    StudyTable("limits", Limits),
    StudyTable("optimize", Search, part="search"),
    StudyTable("optimize", Schedule, part="schedule"),
    StudyTable("optimize", Constraints, part="constraints"),
    StudyTable("optimize", Tolerance, CASES, part="cases"),
    StudyTable("optimize", Goals, part="goals"),
    StudyTable("optimize.tolerance", Tolerance, ERRORS),
    StudyTable("optimize.stop", Stop),
    StudyTable("optimize.front", Front),
    StudyTable("selection", Selection),
    StudyTable("optimize.mount", SurfaceMount, rows=True),
    StudyTable("optimize.no_go", NoGo, rows=True),
    StudyTable("sensor", DataSheet, rows=True),
    StudyTable("choice.option", Option, rows=True),
    StudyTable("prior.focus", Focus, rows=True),
    StudyTable("ap.KIND", ApCurve, rows=True),
    StudyTable("requirement.zone", Zone, rows=True),
    StudyTable("requirement.criterion", Criterion, rows=True),
    StudyTable("requirement.under", Under, rows=True),
    StudyTable("weather", Weather, rows=True),
    StudyTable("state", State, OF_STATE, rows=True),
    StudyTable("story", Story, rows=True),
    StudyTable("state.body", State, BODY, rows=True),
    StudyTable("state.move", Motion, rows=True),
)


class Key(NamedTuple):
    """A key of the study file, and its setting."""

    name: str
    setting: Setting


def setting_keys(*, of_scene: bool = False) -> Iterator[Key]:
    """Yield settings by their key in the file: ``optimize.seed``; all, or those of a scene."""
    for section in SECTIONS:
        for setting in () if of_scene and section.rows else section.settings:
            yield Key(".".join(filter(None, (section.table, key_of(setting.name)))), setting)


@functools.cache
def settings_of_part(part: str) -> tuple[Setting, ...]:
    """Return the settings of a part of Blender's panel, in their order."""
    sections = [each for each in SECTIONS if part == (each.part or each.table)]
    own = (setting for each in sections for setting in each.settings)
    return tuple(setting for setting in own if setting.panel is not None)


def panel_default(setting: Setting) -> Any:
    """Return the value that a setting has in a new scene, as the panel shows it."""
    assert setting.panel is not None
    default = setting.panel.default
    if default is None and setting.default is not REQUIRED:
        is_angle = isinstance(setting.rule, Angle)  # in degrees, as in a file
        default = value_in_file(setting, setting.default) if is_angle else setting.default
    if default is None and setting.default is REQUIRED:
        return None
    return default if default is not None else setting.panel.none


def is_switch(setting: Setting) -> bool:
    """Whether an optional text is shown as a switch: it has one value, or is absent."""
    return setting.is_optional and isinstance(setting.rule, OneOf) and len(setting.rule.among) == 1


def menu_of(setting: Setting) -> tuple[tuple[str, str, str], ...]:
    """Return text, label and meaning of each entry of a setting's menu."""
    panel, rule = setting.panel, setting.rule
    assert panel is not None and isinstance(rule, OneOf | Several)
    rows = zip(rule.among, panel.menu, strict=True)
    absent = () if panel.absent is None else (panel.absent,)
    return (*absent, *((text, label, about) for text, (label, about) in rows))
