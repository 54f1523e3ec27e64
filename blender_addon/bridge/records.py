"""Sensors as variants hold them: read from the scene, written to a .blend, turned into a rig."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ..engine import catalog, pe, search
from .own_curves import curve_of, put_curve
from .rig import (
    held_pose,
    pose_from_numbers,
    pose_of,
    pose_of_matrix,
    sensor_objects,
    view_layer_of,
)

NO_BOUNDS, ZEROS = (False,) * len(search.AXES), (0.0,) * len(search.AXES)


@dataclass(frozen=True, slots=True)
class Record:
    """One sensor: what the score and the search know of it, whether it counts, and its look.

    `bounded` says which axes have bounds of their own, `low` and `high` which [m or deg];
    `mirror_of` is the sensor it is linked to, `mount` and `rack` where it may sit, and with whom;
    `curve` its own AP curve.
    """

    name: str
    model: str
    fusion: str
    pose: pe.Pose
    free: tuple[bool, ...]
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

    @property
    def numbers(self) -> tuple[float, ...]:
        """Position [m] and roll, pitch, yaw [deg]."""
        return (*self.pose.position, *self.pose.rotation_deg)

    @property
    def scored(self) -> tuple[object, ...]:
        """What a score depends on."""
        return self.name, self.model, self.fusion, self.numbers, self.visible, self.curve

    @property
    def told_apart(self) -> tuple[object, ...]:
        """What makes it another idea: all but its look."""
        bounds = zip(self.bounded, self.low, self.high, strict=True)
        held = self.mirror_of, self.mount, self.rack
        return (*self.scored, self.free, *((a, b) if own else None for own, a, b in bounds), *held)


def alike(some: Iterable[Record], others: Iterable[Record]) -> bool:
    """Whether two lists of sensors are one idea."""
    return [each.told_apart for each in some] == [each.told_apart for each in others]


def records_of_scene(scene: bpy.types.Scene) -> tuple[Record, ...]:
    """Return all sensors of a scene by name, hidden ones included.

    Raises
    ------
    InputError
        When one of them is scaled, sheared or nowhere.
    """
    layer = view_layer_of(scene)
    layer.update()
    return tuple(_record_of(obj, layer) for obj in sensor_objects(scene))


def _record_of(obj: bpy.types.Object, layer: bpy.types.ViewLayer) -> Record:
    own, visible = obj.perception_entropy, obj.visible_get(view_layer=layer)
    try:
        pose = pose_of(obj, layer.depsgraph) if visible else _hidden_pose(obj)
    except pe.InputError as error:
        field = f"sensor {obj.name!r}: {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None
    return Record(
        obj.name,
        own.model,
        own.fusion,
        pose,
        tuple(own.free),
        visible,
        obj.empty_display_type,
        obj.empty_display_size,
        tuple(own.bounded),
        tuple(own.bounds_low),
        tuple(own.bounds_high),
        own.mirror_of,
        own.mount,
        own.rack,
        curve_of(own),
    )


def _hidden_pose(obj: bpy.types.Object) -> pe.Pose:
    """Where a hidden sensor stands: Blender does not work its place out, and a file lacks it."""
    ground_from_sensor = _ground_from_object(obj)
    held = held_pose(obj, ground_from_sensor)
    return pose_of_matrix(ground_from_sensor) if held is None else held


def _ground_from_object(obj: bpy.types.Object) -> np.ndarray:
    """(4, 4) place of an object by its own and its parents' figures, in double precision."""
    own = np.array(obj.matrix_basis, dtype=float)
    if obj.parent is None:
        return own
    return _ground_from_object(obj.parent) @ np.array(obj.matrix_parent_inverse, dtype=float) @ own


def records_of(variant: bpy.types.PropertyGroup) -> tuple[Record, ...]:
    """Return a variant's sensors, by name."""
    found = (
        Record(
            row.name,
            row.model,
            row.fusion,
            pose_from_numbers(row.pose),
            tuple(row.free),
            row.visible,
            row.display,
            row.size,
            tuple(row.bounded),
            tuple(row.bounds_low),
            tuple(row.bounds_high),
            *_ties_of(variant, row),
            curve_of(row),
        )
        for row in variant.sensors
    )
    return tuple(sorted(found, key=lambda record: record.name))


def _ties_of(
    variant: bpy.types.PropertyGroup, row: bpy.types.PropertyGroup
) -> tuple[str, str, str]:
    """Mirror link, mount and rack of a variant's sensor; of an older one those that it has now."""
    obj = None if variant.holds_ties else variant.id_data.objects.get(row.name)
    own = row if obj is None else obj.perception_entropy
    return own.mirror_of, own.mount, own.rack


def write_records(variant: bpy.types.PropertyGroup, records: Sequence[Record]) -> None:
    """Have a variant hold these sensors."""
    variant.sensors.clear()
    variant.holds_ties = True
    for record in records:
        row = variant.sensors.add()
        row.name, row.model, row.fusion = record.name, record.model, record.fusion
        put_curve(row, record.curve)
        row.pose, row.free, row.visible = record.numbers, record.free, record.visible
        row.display, row.size = record.display, record.size_m
        row.bounded, row.bounds_low, row.bounds_high = record.bounded, record.low, record.high
        row.mirror_of, row.mount, row.rack = record.mirror_of, record.mount, record.rack


def rig_of(records: Sequence[Record]) -> pe.Rig:
    """Return the visible ones of a variant's sensors as a rig: the scene's, would they stand there.

    Raises
    ------
    InputError
        When there is none, or one of them is no possible sensor.
    """
    visible = [record for record in records if record.visible]
    if not visible:
        found = f"{len(records)} hidden" if records else "none"
        raise pe.InputError("variant", "sensors", "at least one visible sensor", found)
    return pe.Rig([_sensor(record) for record in visible])


def free_axes_of(records: Sequence[Record]) -> dict[str, tuple[str, ...]]:
    """Return which axes the search may change, by the sensor's name."""
    return {
        record.name: tuple(a for a, free in zip(search.AXES, record.free, strict=True) if free)
        for record in records
    }


def _sensor(record: Record) -> pe.Sensor:
    try:
        model = catalog.load(record.model)
        return pe.Sensor(record.name, model, record.pose, record.fusion or None, record.curve)
    except pe.InputError as error:
        field = f"sensor {record.name!r}: {error.field}"
        raise pe.InputError("variant", field, error.expected, error.found) from None
