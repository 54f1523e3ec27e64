"""Sensors from a file, a known rig or Blender's own objects replace those of the scene.

They become a variant; sensors that were no variant yet are kept as one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import bridge, signals, vehicle_cache
from ..engine import catalog, exchange, kinds, pe, search
from ..language import shown
from ..properties import FREE_BY_DEFAULT
from ..sensor_kinds import mount_of, row_of
from .reports import USER_ERRORS, OperatorResult, report, report_error
from .variants import stand_as_variant


class PE_OT_add_rig(bpy.types.Operator):
    """Replace the sensors of the scene by those of a known rig, as a variant.

    Present sensors that are no variant yet are saved as one"""

    bl_idname = "pe.add_rig"
    bl_label = "Add Known Rig"
    bl_options = {"REGISTER", "UNDO"}

    key: StringProperty(name="Rig", description="Name of the known rig", options={"HIDDEN"})
    fit: BoolProperty(
        name="Fit to Vehicle",
        description="Scale its positions from its own vehicle's box to this one's; otherwise they "
        "are as published, about the vehicle's centre",
        default=True,
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.Operator) -> str:
        rig = catalog.known_rigs().get(properties.key)
        if rig is None:
            return shown(str(cls.__doc__))
        return f"{len(rig.sensors)} sensors of {rig.vehicle}. {rig.note}\nSource: {rig.source}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Rigs are added in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        try:
            rig = catalog.known_rig(self.key)
            before = bridge.records_of_scene(scene)
            vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
            sensors, fitted = rig.sensors, False
            if self.fit and vehicle is not None and rig.size is not None:
                sensors, fitted = rig.on_vehicle(*vehicle.bounds), True
            note, records = note_of(rig, fitted), tuple(map(record_of, sensors))
            name = stand_as_variant(scene, rig.title, records, note, before)
        except USER_ERRORS as error:
            return report_error(self, error)
        signals.study_changed.emit()
        report(self, "INFO", f"Added {name}: {len(rig.sensors)} sensors")
        return {"FINISHED"}


def note_of(rig: catalog.KnownRig, fitted: bool) -> str:
    """Return the variant's note: whose rig it is, and how its positions were changed."""
    how = "scaled to this vehicle's box" if fitted else "as published"
    return (
        f"{rig.vehicle}; published with the origin {rig.origin}, here about the vehicle's centre, "
        f"{how}. {rig.note} Source: {rig.source}"
    )


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
    operator: bpy.types.Operator,
    scene: bpy.types.Scene,
    title: str,
    sensors: Iterable[pe.Sensor],
    lines: Sequence[str],
    origin: str,
) -> OperatorResult:
    """Replace the sensors of the scene, as a variant, and report warnings.

    Raises
    ------
    InputError
        When they cannot be put into the scene.
    """
    before = bridge.records_of_scene(scene)
    records = tuple(record_of(_known_sensor(scene, sensor)) for sensor in sensors)
    note = f"{origin}. {' '.join(lines)}"
    name = stand_as_variant(scene, title, records, note, before)
    signals.study_changed.emit()
    for line in lines:
        report(operator, "WARNING", line)
    count = len(records)
    report(operator, "INFO", f"Added {name}: {count} sensor{'s' if count > 1 else ''}")
    return {"FINISHED"}


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


class PE_OT_sensors_from_objects(bpy.types.Operator):
    """Replace the sensors of the scene by Blender's cameras and empties, as a variant.

    A sensor takes a camera's lens, shift, clipping and picture size; an empty looks along x"""

    bl_idname = "pe.sensors_from_objects"
    bl_label = "Sensors from Cameras and Empties"
    bl_options = {"REGISTER", "UNDO"}

    selected: BoolProperty(
        name="Selected Only", description="Use only the selected cameras and empties"
    )
    model: StringProperty(
        name="Empties' Model",
        description="For empties without a model of their own (custom property `model`)",
        default=exchange.STAND_INS[LIDAR],
        search=empty_models,
        search_options=set(),
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> OperatorResult:
        self.selected = bool(bridge.plain_objects(context.selected_objects))
        return context.window_manager.invoke_props_dialog(self, width=420)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set(shown("Sensors are made in Object Mode"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        objects = context.selected_objects if self.selected else scene.objects
        try:
            sensors, lines = bridge.sensors_of_objects(scene, objects, {}, self.model)
            return replace_sensors(
                self, scene, "From Objects", sensors, lines, "From Blender's cameras and empties"
            )
        except USER_ERRORS as error:
            return report_error(self, error)


class PE_OT_sensors_to_objects(bpy.types.Operator):
    """Add a camera for each camera sensor and an empty for each other one, in a collection"""

    bl_idname = "pe.sensors_to_objects"
    bl_label = "Cameras and Empties from Sensors"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        try:
            rig = bridge.rig_from_objects(bridge.sensor_objects(scene), depsgraph)
            made, lines = bridge.put_objects(scene, rig)
        except USER_ERRORS as error:
            return report_error(self, error)
        for line in lines:
            report(self, "WARNING", line)
        report(self, "INFO", f"Added {len(made)} to {made[0].users_collection[0].name}")
        return {"FINISHED"}


CLASSES = (
    PE_OT_add_rig,
    PE_OT_sensors_from_objects,
    PE_OT_sensors_to_objects,
)
