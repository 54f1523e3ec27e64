"""Sensors as tables: one sensor of a scene, of a variant or of an imported study, as plain values.

A sensor's object holds the text of its table `[[sensor]]`, with what else is known of it: its
mirror image, its rack, whether it stays. Blender has its name, pose and visibility. A variant
stores the tables of all sensors; what differs between two of them are keys.
"""

import contextlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Annotated, Any

import numpy as np
from bpy.types import Depsgraph, Object, PropertyGroup, Scene, ViewLayer

from ..engine import catalog, kinds, pe, search, studies
from ..sensor_kinds import DEFAULT_MODEL
from .rig import color_of, last_written_pose, pose_of, pose_of_matrix, sensor_objects, view_layer_of
from .study_table import LARGEST_INT, TableData, parsed
from .transform_constraints import locked_axes

OF_OBJECT = ("locked", "options", "may_be_left_out", "stays", "color", "order", "measured_from")
"""Keys that belong to the sensor's object, in whatever variant."""
OF_BLENDER = ("name", "position", "rotation", "visible", "display", "size_m", "locked", "options")
"""Keys that an object's text does not have: Blender holds them."""
SCORED = ("name", "model", "fusion", "position", "rotation", "visible", "ap")
IDENTITY = (*SCORED, "free", "bounds", "mirror_of", "mount", "rack")


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorRecord:
    """One sensor: everything that a score and a search depend on, and its display settings. Its
    table (`studies.read`, `studies.write`) has the keys of `[[sensor]]`, and those of its object.

    `mirror_of` is the linked mirror image, `rack` the group that moves as one. `intrinsics` is the
    model if the catalogue does not have it. A variant's record takes the keys `OF_OBJECT` from the
    object that the variant would use if it were applied: `locked` axes restrict the search,
    `measured_from` are edges of the vehicle by axis,
    `options` are tables of the models to choose from, `may_be_left_out` allows designs without the
    sensor, and one that `stays` is moved by no search; `order` is its place among the sensors.
    """

    name: studies.Named
    model: str
    pose: Annotated[pe.Pose, studies.Part(inline=True)]
    fusion: str = ""
    curve: Annotated[pe.ApCurve | None, studies.Part(key="ap")] = None
    color: str | None = None
    sheet: Annotated[pe.DataSheet, studies.Part(inline=True)] = field(default_factory=pe.DataSheet)
    free: Annotated[tuple[str, ...], studies.Part(rule=studies.Several(search.AXES))] = (
        search.PAPER_FREE
    )
    bounds: studies.AxisBounds = field(default_factory=studies.AxisBounds)
    mount: str = ""
    mirror_of: str = ""
    rack: str = ""
    visible: bool = True
    display: str = "ARROWS"
    size_m: float = 0.25
    stays: bool = False
    may_be_left_out: bool = False
    order: Annotated[int, studies.Part(rule=studies.Whole(-LARGEST_INT))] = 0
    measured_from: Mapping[str, str] = field(default_factory=dict)
    locked: tuple[str, ...] = ()
    options: Annotated[tuple[TableData, ...], studies.Part(stored=False)] = ()
    intrinsics: Annotated[Any, studies.Part(stored=False)] = None

    @property
    def table(self) -> TableData:
        """The record as plain data."""
        table: TableData = studies.write(self)
        return table

    def keys(self, among: Sequence[str]) -> TableData:
        """Return the values of some keys, those that have their default left out."""
        return {key: value for key, value in self.table.items() if key in among}


def same_sensors(records: Iterable[SensorRecord], others: Iterable[SensorRecord]) -> bool:
    """Return whether two lists of sensors are the same variant."""
    return [each.keys(IDENTITY) for each in records] == [each.keys(IDENTITY) for each in others]


def records_of_scene(scene: Scene) -> tuple[SensorRecord, ...]:
    """Return all sensors of a scene, hidden ones included. `InputError` when one of them is
    scaled or sheared, or has no finite place."""
    layer = view_layer_of(scene)
    layer.update()
    return tuple(record_of_object(obj, layer.depsgraph, layer) for obj in sensor_objects(scene))


def record_of_object(obj: Object, depsgraph: Depsgraph, layer: ViewLayer) -> SensorRecord:
    """Return the record of one sensor of a scene. `InputError` when it is scaled or sheared, has no
    finite place, or a value of its table is wrong."""
    visible = obj.visible_get(view_layer=layer)
    record = _placed_record(obj, depsgraph if visible else None)
    return replace(
        record,
        visible=visible,
        display=obj.empty_display_type,
        size_m=obj.empty_display_size,
        **_object_keys(obj),
    )


def _placed_record(obj: Object, depsgraph: Depsgraph | None) -> SensorRecord:
    """Return a sensor's table with its name and pose; `depsgraph` is None for a hidden one."""
    try:
        pose = _hidden_pose(obj) if depsgraph is None else pose_of(obj, depsgraph)
        known = _record_of_text(obj.perception_entropy.table)
    except pe.InputError as error:
        raise error.within("scene", f"sensor {obj.name!r}") from None
    return replace(known, name=obj.name, pose=pose, color=color_of(obj))


@lru_cache(maxsize=512)
def _record_of_text(text: str) -> SensorRecord:
    """Return the table of an object's text, without name and pose; it is asked for in drags."""
    table = parsed(text)
    if table is None:
        raise pe.InputError("sensor", "", "a table as JSON", "other text")
    usual = {"name": "sensor", "model": DEFAULT_MODEL, "position": [0.0, 0.0, 0.0]}
    return studies.read(SensorRecord, studies.Node(usual | table, "sensor"))


def object_table(record: SensorRecord) -> TableData:
    """Return the table that the record's object holds."""
    return {key: value for key, value in record.table.items() if key not in OF_BLENDER}


def _object_keys(obj: Object) -> dict[str, Any]:
    """Return the keys that a scene's object has besides its text."""
    options = tuple(parsed(row.table) or {} for row in obj.perception_entropy.options)
    return {"locked": locked_axes(obj), "options": options}


def _hidden_pose(obj: Object) -> pe.Pose:
    """Return the pose of a hidden sensor, which Blender does not evaluate and no file stores."""
    ground_from_sensor = _ground_from_object(obj)
    held = last_written_pose(obj.perception_entropy.placed, ground_from_sensor)
    return pose_of_matrix(ground_from_sensor) if held is None else held


def _ground_from_object(obj: Object) -> np.ndarray:
    """Return an object's (4, 4) pose from its own and its parents' transforms, in double."""
    ground_from_basis = np.array(obj.matrix_basis, dtype=float)
    if obj.parent is None:
        return ground_from_basis
    return (
        _ground_from_object(obj.parent)
        @ np.array(obj.matrix_parent_inverse, dtype=float)
        @ ground_from_basis
    )


def records_of(variant: PropertyGroup) -> tuple[SensorRecord, ...]:
    """Return a variant's sensors, in the order of the scene's."""
    scene = variant.id_data
    records = []
    for table in json.loads(variant.sensors):
        record = studies.read(SensorRecord, studies.Node(table, "variant"))
        obj = scene.objects.get(record.name)
        if obj is not None and (
            obj.perception_entropy.is_sensor or obj.perception_entropy.is_parked
        ):
            known = _record_of_text(obj.perception_entropy.table)
            own = {key: getattr(known, key) for key in OF_OBJECT}
            record = replace(record, **own | _object_keys(obj) | {"color": color_of(obj)})
        records.append(record)
    return tuple(sorted(records, key=lambda record: (record.order, record.name)))


def write_records(variant: PropertyGroup, records: Sequence[SensorRecord]) -> None:
    """Store the tables of sensors in a variant."""
    tables = [
        {key: value for key, value in record.table.items() if key not in OF_OBJECT}
        for record in records
    ]
    variant.sensors = json.dumps(tables)


def record_of_sensor(sensor: pe.Sensor) -> SensorRecord:
    """Return the record of an engine's sensor, with the free axes of the paper and no bounds.
    `sensor_of` returns an equal sensor from the record, also if its model is not in the catalogue.
    """
    return SensorRecord(
        name=sensor.name,
        model=sensor.model.name,
        pose=sensor.pose,
        fusion=sensor.fusion or "",
        curve=sensor.curve,
        intrinsics=sensor.model,
        color=sensor.color,
        sheet=sensor.sheet,
        measured_from=sensor.measured_from,
    )


def rig_from_objects(objects: Sequence[Object], depsgraph: Depsgraph) -> pe.Rig:
    """Return the visible sensors among some objects as a rig. `InputError` when there is none, or
    one of them is no possible sensor."""
    visible = [obj for obj in objects if obj.visible_get(view_layer=depsgraph.view_layer)]
    if not visible:
        found = f"{len(objects)} hidden" if objects else "none"
        raise pe.InputError("scene", "sensors", "at least one visible sensor", found)
    sensors = [sensor_from_object(obj, depsgraph) for obj in visible]
    try:
        return pe.Rig(sensors)
    except pe.InputError as error:
        raise error.at("scene") from None


def sensor_from_object(obj: Object, depsgraph: Depsgraph) -> pe.Sensor:
    """Return one object's model, placement, fusion group and AP curve as a sensor. `InputError`
    when it is no possible sensor; the line names the object."""
    returns = depsgraph.scene.perception_entropy.returns
    return sensor_of(_placed_record(obj, depsgraph), "scene", returns)


def possible_sensors(objects: Sequence[Object], depsgraph: Depsgraph) -> list[pe.Sensor]:
    """Return the visible sensors among some objects, without those that cannot be scored."""
    sensors = []
    for obj in objects:
        if obj.visible_get(view_layer=depsgraph.view_layer):
            with contextlib.suppress(pe.InputError):
                sensors.append(sensor_from_object(obj, depsgraph))
    return sensors


def rig_of(
    records: Sequence[SensorRecord], source: str = "variant", returns: str = "all"
) -> pe.Rig:
    """Return the visible sensors of some records as a rig, whose LiDARs have these returns.

    `source` is named by errors: "scene" or "variant".

    `InputError` when there is none, or one of them cannot be scored.
    """
    visible = [record for record in records if record.visible]
    if not visible:
        found = f"{len(records)} hidden" if records else "none"
        raise pe.InputError(source, "sensors", "at least one visible sensor", found)
    sensors = [sensor_of(record, source) for record in visible]
    try:
        return kinds.with_returns(pe.Rig(sensors), returns)
    except pe.InputError as error:
        raise error.at(source) from None


def sensor_of(record: SensorRecord, source: str = "variant", returns: str = "all") -> pe.Sensor:
    """Return a record as the engine's sensor, with these returns. `InputError` when the catalogue
    does not have its model, or the name or the fusion group is impossible."""
    try:
        model = record.intrinsics or catalog.load(record.model)
        return pe.Sensor(
            record.name,
            kinds.returning(model, returns),
            record.pose,
            record.fusion or None,
            curve=record.curve,
            color=record.color,
            sheet=record.sheet,
            measured_from=record.measured_from,
        )
    except pe.InputError as error:
        raise error.within(source, f"sensor {record.name!r}") from None
