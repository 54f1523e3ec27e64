"""Sensor records: one sensor as plain values, read from the scene, a variant or an imported study.

A scene is read into records, a variant stores records, and an imported study is converted to
records. `scene_record.study_of` makes a study from records only.
"""

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, astuple, dataclass, field
from typing import Any, NamedTuple

import numpy as np
from bpy.types import Depsgraph, Object, PropertyGroup, Scene, ViewLayer

from ..engine import catalog, kinds, pe, search
from .rig import (
    color_of,
    curve_of,
    last_written_pose,
    pose_from_numbers,
    pose_of,
    pose_of_matrix,
    sensor_objects,
    sheet_of,
    view_layer_of,
)
from .study_table import as_typed
from .transform_constraints import locked_axes

NO_BOUNDS = (False,) * len(search.AXES)
ZEROS = (0.0,) * len(search.AXES)
PAPER_FREE = tuple(axis in search.PAPER_FREE for axis in search.AXES)
STORED = (
    "name",
    "model",
    "fusion",
    "free",
    "visible",
    "display",
    "size_m",
    "bounded",
    "low",
    "high",
    "mirror_of",
    "mount",
    "rack",
)
"""Fields that a variant stores as they are; the others have forms of their own."""


class ModelOption(NamedTuple):
    """A model that may replace a sensor's model; its price, and what else is known of it."""

    model: str
    sheet: pe.DataSheet


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorRecord:
    """One sensor: everything that a score and a search depend on, and its display settings.

    `bounded` marks the axes with own bounds, `low` and `high` are these bounds [m or deg].
    `mirror_of` is the linked mirror image, `mount` the sensor's mount, `rack` the group that moves
    as one. `curve` is an own AP curve; `sheet` are figures of its
    own, `intrinsics` is the model if the catalogue does not have it.

    The last fields belong to the sensor's object and are not stored with a variant: a variant's
    record takes them from the object that the variant would use if it were applied. `locked` axes
    restrict the search, `options` are the models to choose from, `may_be_left_out` allows designs
    without the sensor, and one that `stays` is moved by no search. `color` is the sensor's own,
    `order` its place among the sensors.
    """

    name: str
    model: str
    pose: pe.Pose
    fusion: str = ""
    free: tuple[bool, ...] = PAPER_FREE
    visible: bool = True
    display: str = "ARROWS"
    size_m: float = 0.25
    bounded: tuple[bool, ...] = NO_BOUNDS
    low: tuple[float, ...] = ZEROS
    high: tuple[float, ...] = ZEROS
    mirror_of: str = ""
    mount: str = ""
    rack: str = ""
    curve: pe.ApCurve | None = None
    sheet: pe.DataSheet = field(default_factory=pe.DataSheet)
    intrinsics: Any = None  # the engine's model, where the catalogue may not have it

    locked: tuple[str, ...] = ()
    options: tuple[ModelOption, ...] = ()
    may_be_left_out: bool = False
    stays: bool = False
    color: str | None = None
    order: int = 0

    @property
    def numbers(self) -> tuple[float, ...]:
        """Position [m] and roll, pitch, yaw [deg]."""
        return (*self.pose.position, *self.pose.rotation_deg)

    @property
    def scored(self) -> tuple[object, ...]:
        """The values that a score and its key figures depend on."""
        return self.name, self.model, self.fusion, self.numbers, self.visible, self.curve

    @property
    def identity(self) -> tuple[object, ...]:
        """Values by which two variants differ; display settings are left out."""
        bounds = zip(self.bounded, self.low, self.high, strict=True)
        links = self.mirror_of, self.mount, self.rack
        return (
            *self.scored,
            self.free,
            *((a, b) if is_bounded else None for is_bounded, a, b in bounds),
            *links,
        )


def same_sensors(records: Iterable[SensorRecord], others: Iterable[SensorRecord]) -> bool:
    """Return whether two lists of sensors are the same variant."""
    return [record.identity for record in records] == [record.identity for record in others]


def records_of_scene(scene: Scene) -> tuple[SensorRecord, ...]:
    """Return all sensors of a scene, hidden ones included. `InputError` when one of them is
    scaled or sheared, or has no finite place."""
    layer = view_layer_of(scene)
    layer.update()
    return tuple(record_of_object(obj, layer.depsgraph, layer) for obj in sensor_objects(scene))


def record_of_object(obj: Object, depsgraph: Depsgraph, layer: ViewLayer) -> SensorRecord:
    """Return the record of one sensor of a scene. `InputError` when it is scaled or sheared, has no
    finite place, or its AP curve is impossible."""
    settings = obj.perception_entropy
    visible = obj.visible_get(view_layer=layer)
    try:
        pose = pose_of(obj, depsgraph) if visible else _hidden_pose(obj)
        curve = curve_of(settings)
    except pe.InputError as error:
        raise error.within("scene", f"sensor {obj.name!r}") from None
    return SensorRecord(
        name=obj.name,
        model=settings.model,
        pose=pose,
        fusion=settings.fusion,
        free=tuple(settings.free),
        visible=visible,
        display=obj.empty_display_type,
        size_m=obj.empty_display_size,
        bounded=tuple(settings.bounded),
        low=tuple(settings.bounds_low),
        high=tuple(settings.bounds_high),
        mirror_of=settings.mirror_of,
        mount=settings.mount,
        rack=settings.rack,
        curve=curve,
        sheet=sheet_of(settings),
        **_object_fields(obj),
    )


def _object_fields(obj: Object | None) -> dict[str, Any]:
    """Return the fields of a record that belong to the object; empty without an object."""
    if obj is None:
        return {}
    settings = obj.perception_entropy
    return {
        "locked": locked_axes(obj),
        "options": tuple(ModelOption(o.model, sheet_of(o)) for o in settings.options),
        "may_be_left_out": settings.may_be_left_out,
        "stays": settings.stays,
        "color": color_of(obj),
        "order": settings.order,
    }


def _hidden_pose(obj: Object) -> pe.Pose:
    """Return the pose of a hidden sensor, which Blender does not evaluate and no file stores."""
    ground_from_sensor = _ground_from_object(obj)
    held = last_written_pose(obj, ground_from_sensor)
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
    records = (_record_of_table(variant.id_data, row) for row in json.loads(variant.sensors))
    return tuple(sorted(records, key=lambda record: (record.order, record.name)))


def _record_of_table(scene: Scene, table: dict[str, Any]) -> SensorRecord:
    values: dict[str, Any] = {
        key: tuple(v) if isinstance(v, list) else v for key, v in table.items()
    }
    pose = pose_from_numbers(values.pop("pose"))
    curve = values.pop("curve")
    own = None if curve is None else pe.ApCurve(*curve)
    obj = _object_named(scene, table["name"])
    known: dict[str, Any] = {"sheet": pe.DataSheet(**values.pop("sheet"))}
    return SensorRecord(**values, pose=pose, curve=own, **known, **_object_fields(obj))


def _object_named(scene: Scene, name: str) -> Object | None:
    """Return the sensor of a name, active or inactive, or None."""
    obj = scene.objects.get(name)
    if obj is None:
        return None
    settings = obj.perception_entropy
    return obj if settings.is_sensor or settings.is_parked else None


def write_records(variant: PropertyGroup, records: Sequence[SensorRecord]) -> None:
    """Store the records of sensors in a variant."""
    rows = []
    for record in records:
        curve = None if record.curve is None else astuple(record.curve)
        own = {key: getattr(record, key) for key in STORED}
        tables = {"sheet": asdict(record.sheet)}
        rows.append(own | {"pose": record.numbers, "curve": curve} | tables)
    variant.sensors = json.dumps(rows)


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
    )


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


def sensor_of(record: SensorRecord, source: str = "variant") -> pe.Sensor:
    """Return a record as the engine's sensor. `InputError` when the catalogue does not have its
    model, or the name or the fusion group is impossible."""
    try:
        model = record.intrinsics or catalog.load(record.model)
        return pe.Sensor(
            record.name,
            model,
            record.pose,
            record.fusion or None,
            curve=record.curve,
            color=record.color,
            sheet=record.sheet,
        )
    except pe.InputError as error:
        raise error.within(source, f"sensor {record.name!r}") from None


def bounds_of(record: SensorRecord) -> dict[str, tuple[float, float]]:
    """Return a record's own bounds by axis [m or rad]."""
    return bounds_by_axis(record.bounded, record.low, record.high)


def bounds_by_axis(
    bounded: Sequence[bool], low: Sequence[float], high: Sequence[float]
) -> dict[str, tuple[float, float]]:
    """Return the bounds of the bounded axes [m or rad]; the given angles are in degrees."""
    limits = {}
    for n, axis in enumerate(search.AXES):
        if bounded[n]:
            bounds = as_typed(low[n]), as_typed(high[n])
            if axis not in search.POSITION_AXES:
                bounds = math.radians(bounds[0]), math.radians(bounds[1])
            limits[axis] = bounds
    return limits
