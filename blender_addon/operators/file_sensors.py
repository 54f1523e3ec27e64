"""Sensors that come from elsewhere: they stand in the scene as a variant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from .. import bridge, changes
from ..engine import catalog, pe
from .known_rigs import record_of
from .reports import tell
from .variants import stand_as_variant


def stand_sensors(
    operator: bpy.types.Operator,
    scene: bpy.types.Scene,
    title: str,
    sensors: Iterable[pe.Sensor],
    lines: Sequence[str],
    origin: str,
) -> set[str]:
    """Put sensors in place of those that stand here, as a variant, and tell what has to be known.

    Raises
    ------
    InputError
        When they cannot stand here.
    """
    before = bridge.records_of_scene(scene)
    records = tuple(record_of(_known(scene, sensor)) for sensor in sensors)
    note = f"{origin}. {' '.join(lines)}"
    name = stand_as_variant(scene, title, records, note, before)
    changes.study.tell()
    for line in lines:
        tell(operator, "WARNING", line)
    count = len(records)
    tell(operator, "INFO", f"Added {name}: {count} sensor{'s' if count > 1 else ''}")
    return {"FINISHED"}


def _known(scene: bpy.types.Scene, sensor: pe.Sensor) -> catalog.KnownSensor:
    """Return a sensor as known rigs have them; a model that nobody has becomes the file's own."""
    name = sensor.model.name
    if name not in catalog.entries() or catalog.load(name) is not sensor.model:
        name = bridge.add_own_sensor(scene, name, catalog.to_table(sensor.model))
    return catalog.KnownSensor(sensor.name, name, sensor.pose)
