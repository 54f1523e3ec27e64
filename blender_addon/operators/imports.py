"""Imports: sensors from a file or a known rig; and whole studies.

Sensors replace those of the scene and become a variant; sensors that were no variant yet are kept
as one.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .. import document, signals
from ..caches import vehicle_cache
from ..engine import catalog, exchange, graphics, pe, search, studies
from ..sensor_kinds import mount_of
from .declared import INTERNAL, Report, chosen_file, operator
from .named_places import places_of
from .variants import stand_as_variant

BY_NAME = "TOLD"
STUDY = "study"
FORMAT_OR_NAME = (
    (BY_NAME, "By Name", "By the file's name"),
    (STUDY, "Study", "A study (.toml), and the mesh that it names"),
    *((row.name, row.title, "") for row in exchange.RIG_FORMATS.values()),
)


def _about_rig(about: str, chosen: bpy.types.OperatorProperties) -> str:
    if (template := catalog.templates().get(chosen.key)) is not None:
        return f"{len(template.sensors)} sensors on named places, to start from. {template.note}"
    rig = catalog.known_rigs().get(chosen.key)
    if rig is None:
        return about
    return f"{len(rig.sensors)} sensors of {rig.vehicle}. {rig.note}\nSource: {rig.source}"


@operator(
    "Add Rig",
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
    on_places=BoolProperty(
        name="On Named Places",
        description="Move each of its sensors to the nearest named place: roof, mirror, bumper",
    ),
)
def add_rig(context: bpy.types.Context, key: str, fit: bool, on_places: bool) -> str:
    """Replace the sensors of the scene by those of a template or a known rig, as a variant.

    Present sensors that are no variant yet are saved as one"""
    scene = context.scene
    rig = catalog.rig_named(key)
    before = document.records_of_scene(scene)
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    if isinstance(rig, catalog.RigTemplate):
        at = None if vehicle is None else places_of(scene, vehicle)
        sensors = catalog.sensors_on(rig, vehicle, at)
        kinds = ((each.name, catalog.load(each.model).kind) for each in sensors)
        tints = graphics.place_tints(kinds)
        note = f"A template on named places. {rig.note}"
        records = tuple(replace(record_of(s), color=tints[s.name]) for s in sensors)
    else:
        on_it = vehicle if fit else None
        at = places_of(scene, vehicle) if on_places and vehicle is not None else None
        records = tuple(map(record_of, catalog.sensors_on(rig, on_it, at)))
        fitted = "as published" if on_it is None or rig.size is None else "fitted to its box"
        how = fitted if at is None else "on named places"
        note = (
            f"{rig.vehicle}; published with the origin {rig.origin}, here about the vehicle's "
            f"centre, {how}. {rig.note} Source: {rig.source}"
        )
    name = stand_as_variant(scene, rig.title, records, note, before=before)
    return f"Added {name}: {len(records)} sensors"


def record_of(sensor: catalog.KnownSensor) -> document.SensorRecord:
    """Return a sensor of a known rig as a variant holds it."""
    mount = mount_of(catalog.load(sensor.model).kind)
    values = (*sensor.pose.position, *sensor.pose.rpy)
    pose = search.pose_from_values(dict(zip(search.AXES, values, strict=True)))
    return document.SensorRecord(
        name=sensor.name, model=sensor.model, pose=pose, display=mount.display, size_m=mount.size_m
    )


def menu_of_rigs() -> tuple[tuple[str, str], ...]:
    """Return keys and titles of the templates, then of the known rigs, for a menu.

    An empty key is between them."""
    templates = ((key, row.title) for key, row in catalog.templates().items())
    return (*templates, ("", ""), *((key, row.title) for key, row in catalog.known_rigs().items()))


def replace_sensors(
    scene: bpy.types.Scene,
    title: str,
    sensors: Iterable[pe.Sensor],
    lines: Sequence[str],
    origin: str,
) -> Report:
    """Replace the sensors of the scene, as a variant; return what to report. `InputError` when they
    cannot be put into the scene."""
    before = document.records_of_scene(scene)
    records = tuple(
        replace(
            record_of(_known_sensor(scene, sensor)),
            fusion=sensor.fusion or "",
            curve=sensor.curve,
            color=sensor.color,
            sheet=sensor.sheet,
        )
        for sensor in sensors
    )
    name = stand_as_variant(scene, title, records, f"{origin}. {' '.join(lines)}", before=before)
    signals.study_changed.emit()
    count = len(records)
    return Report(f"Added {name}: {count} sensor{'s' if count > 1 else ''}", tuple(lines))


def _known_sensor(scene: bpy.types.Scene, sensor: pe.Sensor) -> catalog.KnownSensor:
    """Return a sensor with a model of the catalogue; an unknown model becomes an own sensor."""
    name = sensor.model.name
    if name not in catalog.entries() or catalog.load(name) is not sensor.model:
        name = document.add_own_sensor(scene, name, catalog.to_table(sensor.model))
    return catalog.KnownSensor(sensor.name, name, sensor.pose)


@operator(
    "Copy as Text",
    unless=lambda context: (
        None if document.sensor_objects(context.scene) else "There are no sensors yet"
    ),
    options=INTERNAL,
)
def copy_rig(context: bpy.types.Context) -> str:
    """Copy the sensors as one line of text, to send. Paste Rig reads it, and so does pe"""
    depsgraph = context.evaluated_depsgraph_get()
    found = [
        document.sensor_from_object(o, depsgraph) for o in document.sensor_objects(context.scene)
    ]
    context.window_manager.clipboard = studies.rig_line(pe.Rig(found))
    return f"Copied as one line of text: {len(found)} sensors"


@operator(
    "Paste Rig",
    mode="Rigs are added in Object Mode",
    text=StringProperty(name="Text", description="A line of Copy as Text; empty: the clipboard"),
)
def paste_rig(context: bpy.types.Context, text: str) -> Report:
    """Replace the sensors of the scene by those of a copied line or study, as a variant.

    Present sensors that are no variant yet are saved as one"""
    rig = studies.read_rig_line(text or context.window_manager.clipboard, "clipboard")
    return replace_sensors(context.scene, "Pasted", rig, lines=(), origin="Pasted")


def _draw(self: bpy.types.Operator, _context: bpy.types.Context) -> None:
    self.layout.prop(self, "format")


@operator(
    "Import",
    mode="Files are imported in Object Mode",
    bases=(ImportHelper,),
    draw=_draw,
    filename_ext="",
    filter_glob=StringProperty(default="*", options={"HIDDEN"}),
    format=EnumProperty(
        items=FORMAT_OR_NAME, name="Format", description="The format of the file", default=BY_NAME
    ),
)
def import_file(context: bpy.types.Context, filepath: str, format: str) -> Report:
    """Load a study, or replace the sensors by those of another program's file.

    A study brings its vehicle, mounts and settings; a vehicle that is already the same stays.
    Sensors of another program become a variant; present ones that are no variant yet are saved as
    one. A sensor whose model the file does not name gets a usual one, and a line that says so"""
    path = chosen_file(filepath)
    if format == STUDY or (format == BY_NAME and path.suffix.lower() == ".toml"):
        told = _load_study(context.scene, path)
        signals.study_changed.emit()
        return told
    found = rig_of_file(context.scene, path, format)
    title = path.stem or path.parent.name
    lines = found.lines
    return replace_sensors(
        context.scene, title, tuple(found.rig), lines, origin=f"Read from {path}"
    )


def _load_study(scene: bpy.types.Scene, path: Path) -> Report:
    study = pe.load_study(path)
    if lost := document.load_into(scene, study):
        return Report(f"The scene differs from the file in: {', '.join(lost)}", level="WARNING")
    if study.mesh_notes:
        return Report(f"Imported {path}; {study.mesh}: {'; '.join(study.mesh_notes)}")
    return Report(f"Imported {path} without any loss")


def rig_of_file(scene: bpy.types.Scene, path: Path, format_name: str) -> exchange.ImportedRig:
    """Return the rig in a file of another program, in the scene's frame; of a format of several
    files, in the file's folder. `format_name`: `BY_NAME`, or a name of `RIG_FORMATS`."""
    several = [row.files for row in exchange.RIG_FORMATS.values() if row.is_folder]
    place = path.parent if any(path.name in files for files in several) else path
    reference = document.document_of(scene.perception_entropy, "reference").reference
    return exchange.import_rig(place, None if format_name == BY_NAME else format_name, reference)
