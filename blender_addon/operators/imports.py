"""Imports: sensors from a file, a known rig or Blender's own objects; and whole studies.

Sensors replace those of the scene and become a variant; sensors that were no variant yet are kept
as one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import bridge, signals, vehicle_cache
from ..engine import catalog, exchange, kinds, pe, search
from ..language import draw_label
from ..properties import FREE_BY_DEFAULT
from ..sensor_kinds import mount_of, row_of
from .declared import (
    INTERNAL,
    UNDO,
    USER_ERRORS,
    Answer,
    OperatorResult,
    Told,
    chosen_file,
    declared,
    operator,
    report_error,
)
from .exports import FORMAT_ITEMS
from .variants import stand_as_variant


def _about_rig(about: str, chosen: bpy.types.OperatorProperties) -> str:
    rig = catalog.known_rigs().get(chosen.key)
    if rig is None:
        return about
    return f"{len(rig.sensors)} sensors of {rig.vehicle}. {rig.note}\nSource: {rig.source}"


@operator(
    "Add Known Rig",
    mode="Rigs are added in Object Mode",
    signal=signals.study_changed,
    tooltip=_about_rig,
    key=StringProperty(name="Rig", description="Name of the known rig", options={"HIDDEN"}),
    fit=BoolProperty(
        name="Fit to Vehicle",
        description="Scale its positions from its own vehicle's box to this one's; otherwise they "
        "are as published, about the vehicle's centre",
        default=True,
    ),
)
def add_rig(context: bpy.types.Context, key: str, fit: bool) -> str:
    """Replace the sensors of the scene by those of a known rig, as a variant.

    Present sensors that are no variant yet are saved as one"""
    scene = context.scene
    rig = catalog.known_rig(key)
    before = bridge.records_of_scene(scene)
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    sensors, fitted = rig.sensors, False
    if fit and vehicle is not None and rig.size is not None:
        sensors, fitted = rig.on_vehicle(*vehicle.bounds), True
    how = "scaled to this vehicle's box" if fitted else "as published"
    note = (
        f"{rig.vehicle}; published with the origin {rig.origin}, here about the vehicle's centre, "
        f"{how}. {rig.note} Source: {rig.source}"
    )
    name = stand_as_variant(scene, rig.title, tuple(map(record_of, sensors)), note, before)
    return f"Added {name}: {len(rig.sensors)} sensors"


def record_of(sensor: catalog.KnownSensor) -> bridge.SensorRecord:
    """Return a sensor of a known rig as a variant holds it."""
    mount = mount_of(catalog.load(sensor.model).kind)
    values = (*sensor.pose.position, *sensor.pose.rpy)
    pose = search.pose_from_values(dict(zip(search.AXES, values, strict=True)))
    return bridge.SensorRecord(
        name=sensor.name,
        model=sensor.model,
        pose=pose,
        free=FREE_BY_DEFAULT,
        display=mount.display,
        size_m=mount.size_m,
    )


def known_rigs() -> tuple[tuple[str, str], ...]:
    """Return keys and titles of the known rigs, for a menu."""
    return tuple((rig.key, rig.title) for rig in catalog.known_rigs().values())


def replace_sensors(
    scene: bpy.types.Scene,
    title: str,
    sensors: Iterable[pe.Sensor],
    lines: Sequence[str],
    origin: str,
) -> Told:
    """Replace the sensors of the scene, as a variant; return what to report.

    `InputError` when they cannot be put into the scene.
    """
    before = bridge.records_of_scene(scene)
    records = tuple(record_of(_known_sensor(scene, sensor)) for sensor in sensors)
    name = stand_as_variant(scene, title, records, f"{origin}. {' '.join(lines)}", before)
    signals.study_changed.emit()
    count = len(records)
    return Told(f"Added {name}: {count} sensor{'s' if count > 1 else ''}", tuple(lines))


def _known_sensor(scene: bpy.types.Scene, sensor: pe.Sensor) -> catalog.KnownSensor:
    """Return a sensor with a model of the catalogue; an unknown model becomes an own sensor."""
    name = sensor.model.name
    if name not in catalog.entries() or catalog.load(name) is not sensor.model:
        name = bridge.add_own_sensor(scene, name, catalog.to_table(sensor.model))
    return catalog.KnownSensor(sensor.name, name, sensor.pose)


LIDAR = "lidar"


def empty_models(_operator: object, _context: object, typed: str) -> list[str]:
    """Return the models that an empty may stand for: those that are no cameras.

    Of these the ones whose names contain what is typed; all where none does.
    """
    names = [
        name
        for name, entry in catalog.entries().items()
        if entry.kind in kinds.KINDS and row_of(entry.kind).camera is None
    ]
    return [name for name in catalog.matching(typed) if name in names] or names


def _ask_which(self: Any, context: bpy.types.Context, _event: object) -> OperatorResult:
    self.selected = bool(bridge.plain_objects(context.selected_objects))
    return context.window_manager.invoke_props_dialog(self, width=420)


@operator(
    "Sensors from Cameras and Empties",
    mode="Sensors are made in Object Mode",
    invoke=_ask_which,
    selected=BoolProperty(
        name="Selected Only", description="Use only the selected cameras and empties"
    ),
    model=StringProperty(
        name="Empties' Model",
        description="For empties without a model of their own (custom property `model`)",
        default=exchange.STAND_INS[LIDAR],
        search=empty_models,
        search_options=set(),
    ),
)
def sensors_from_objects(context: bpy.types.Context, selected: bool, model: str) -> Told:
    """Replace the sensors of the scene by Blender's cameras and empties, as a variant.

    A sensor takes a camera's lens, shift, clipping and picture size; an empty looks along x"""
    scene = context.scene
    objects = context.selected_objects if selected else scene.objects
    sensors, lines = bridge.sensors_of_objects(scene, objects, {}, model)
    origin = "From Blender's cameras and empties"
    return replace_sensors(scene, "From Objects", sensors, lines, origin)


@operator("Cameras and Empties from Sensors")
def sensors_to_objects(context: bpy.types.Context) -> Told:
    """Add a camera for each camera sensor and an empty for each other one, in a collection"""
    scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
    rig = bridge.rig_from_objects(bridge.sensor_objects(scene), depsgraph)
    made, lines = bridge.put_objects(scene, rig)
    text = f"Added {len(made)} to {made[0].users_collection[0].name}"
    return Told(text, tuple(lines))


@operator(
    "Import Study",
    mode="Studies are imported in Object Mode",
    signal=signals.study_changed,
    bases=(ImportHelper,),
    filename_ext=".toml",
    filter_glob=StringProperty(default="*.toml", options={"HIDDEN"}),
)
def import_study(context: bpy.types.Context, filepath: str) -> Told:
    """Load a study into the scene: its vehicle, sensors, mounts, and search settings.

    A vehicle that is already the same stays"""
    path = chosen_file(filepath)
    study = bridge.with_mesh_files_of(pe.load_study(path), path.parent)
    if lost := bridge.load_into(context.scene, study):
        return Told(f"The scene differs from the file in: {', '.join(lost)}", level="WARNING")
    return Told(f"Imported {filepath} without any loss")


BY_NAME = "TOLD"
FORMAT_OR_NAME = (*FORMAT_ITEMS, (BY_NAME, "By Name", "By the file's name", len(FORMAT_ITEMS)))


@operator(
    "Import Rig",
    bases=(ImportHelper,),
    filter_glob=StringProperty(default="*", options={"HIDDEN"}),
    format=EnumProperty(items=FORMAT_OR_NAME, name="Format", default=BY_NAME),
    ask=BoolProperty(
        name="Ask for Models",
        description="Ask for the models that the file does not name; otherwise default models are "
        "used",
        default=True,
    ),
)
def import_rig(context: bpy.types.Context, filepath: str, format: str, ask: bool) -> Answer:
    """Replace the sensors of the scene by those of another program's file, as a variant.

    Present sensors that are no variant yet are saved as one"""
    path = chosen_file(filepath)
    found = read_rig(context.scene, path, format, {})
    if ask and found.to_choose and not bpy.app.background:
        wanted = {"filepath": str(path), "format": format}
        return bpy.ops.pe.choose_models("INVOKE_DEFAULT", True, **wanted)
    return place_rig(context.scene, path, found)


def models_for(row: bpy.types.PropertyGroup, _context: object, typed: str) -> list[str]:
    """Return models of a row's kind whose names contain what is typed; all where none does."""
    return catalog.matching(typed, row.kind) or catalog.names(row.kind)


@declared
class PE_ModelChoice(bpy.types.PropertyGroup):
    """A sensor of a file, and the model chosen for it."""

    sensor: StringProperty(name="Sensor")
    kind: StringProperty(name="Kind")
    model: StringProperty(
        name="Model",
        description="Name of the sensor in the catalogue",
        search=models_for,
        search_options=set(),
    )


def _ask_for_models(self: Any, context: bpy.types.Context, _event: object) -> OperatorResult:
    try:
        found = read_rig(context.scene, chosen_file(self.filepath), self.format, {})
    except USER_ERRORS as error:
        return report_error(self, error)
    self.rows.clear()
    for name in found.to_choose:
        row, sensor = self.rows.add(), found.rig[name]
        row.sensor, row.kind, row.model = name, sensor.kind, sensor.model.name
    return context.window_manager.invoke_props_dialog(self, width=480)


def _draw_models(self: Any, _context: bpy.types.Context) -> None:
    draw_label(self.layout, "The file does not name the models of:")
    for row in self.rows:
        split = self.layout.split(factor=0.4)
        split.label(text=row.sensor, translate=False)
        split.prop(row, "model", text="")


@operator(
    "Choose Models",
    options=UNDO | INTERNAL,
    invoke=_ask_for_models,
    draw=_draw_models,
    filepath=StringProperty(subtype="FILE_PATH", options={"HIDDEN"}),
    format=EnumProperty(items=FORMAT_OR_NAME, default=BY_NAME, options={"HIDDEN"}),
    rows=CollectionProperty(type=PE_ModelChoice),
)
def choose_models(context: bpy.types.Context, filepath: str, format: str, rows: Any) -> Told:
    """Choose the models of imported sensors, because the file does not name them"""
    path, models = chosen_file(filepath), {row.sensor: row.model for row in rows}
    return place_rig(context.scene, path, read_rig(context.scene, path, format, models))


def read_rig(
    scene: bpy.types.Scene, path: Path, name: str, chosen: Mapping[str, str]
) -> exchange.ImportedRig:
    """Return the rig of a file, with the chosen models by the sensors' names."""
    several = [row.files for row in exchange.RIG_FORMATS.values() if len(row.files) > 1]
    place = path.parent if any(path.name in files for files in several) else path
    reference = bridge.reference_of(scene.perception_entropy)
    return exchange.import_rig(place, None if name == BY_NAME else name, reference, chosen)


def place_rig(scene: bpy.types.Scene, path: Path, found: exchange.ImportedRig) -> Told:
    """Put the rig of a file into the scene, as a variant; return what to report."""
    title = path.stem or path.parent.name
    told = replace_sensors(scene, title, tuple(found.rig), found.lines, f"Read from {path}")
    bridge.write_passthrough(scene.perception_entropy, found.passthrough)
    return told
