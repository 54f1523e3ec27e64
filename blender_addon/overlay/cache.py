"""The overlay's arrays, sensor by sensor: rebuilt for what changed, kept for the rest. No GPU."""

from __future__ import annotations

import contextlib
from collections.abc import Hashable

import bpy

from .. import bridge, roster
from ..engine import pe
from .geometry import OverlayGeometry
from .kinds import beam_budget, sensor_geometry

LEAST_LENGTH_M = 0.1


class OverlayCache:
    """Remembers names, plain values and arrays; never a Blender object."""

    def __init__(self) -> None:
        self._vehicle_version = 0
        self._vehicle_key: Hashable = None
        self._vehicle: pe.Vehicle | None = None
        self._shown: dict[str, tuple[Hashable, OverlayGeometry]] = {}

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self._vehicle_key = self._vehicle = None
        self._shown = {}

    def vehicle_changed(self) -> None:
        """Note that the vehicle's objects are not what they were."""
        self._vehicle_version += 1

    def update(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
    ) -> dict[str, OverlayGeometry]:
        """Return what to draw by the sensor's name; what did not change is the same object."""
        sensors = shown_sensors(scene, depsgraph)
        if sensors:
            self._update_vehicle(scene, depsgraph)
        settings = scene.perception_entropy
        budget = beam_budget(sensors, settings.beam_limit)
        length_m = max(LEAST_LENGTH_M, settings.beam_length)  # also of a length that is no number
        before, self._shown = self._shown, {}
        for sensor in sensors:
            key = self._vehicle_key, sensor.model, sensor.pose, budget, length_m
            known = before.get(sensor.name)
            if known is None or known[0] != key:
                built = sensor_geometry(sensor, self._vehicle, budget, length_m)
                known = key, built
            self._shown[sensor.name] = known
        return {name: geometry for name, (_, geometry) in self._shown.items()}

    def _update_vehicle(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        """Read the vehicle's triangles again when they may be others: too slow for each redraw."""
        collection = scene.perception_entropy.vehicle
        members = () if collection is None else vehicle_members(collection, depsgraph)
        key = (scene.name, self._vehicle_version, members)
        if key == self._vehicle_key:
            return
        self._vehicle_key, self._vehicle = key, None
        if members:
            # A score says what is wrong with a vehicle; here it is as if there were none.
            with contextlib.suppress(pe.InputError):
                self._vehicle = bridge.vehicle_from_collection(collection, depsgraph)


def shown_sensors(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> list[pe.Sensor]:
    """Sensors to draw, without those that are not possible; a score says what is wrong there."""
    found = []
    for each in roster.sensors(scene):
        if each.perception_entropy.show:
            with contextlib.suppress(pe.InputError):
                found.append(bridge.sensor_from_object(each, depsgraph))
    return found


def vehicle_members(
    collection: bpy.types.Collection, depsgraph: bpy.types.Depsgraph
) -> tuple[str, ...]:
    """Names of the objects of the vehicle that count."""
    members = bridge.visible_members(collection, depsgraph.view_layer)
    return tuple(sorted(each.name_full for each in members if not bridge.mounted_on_sensor(each)))


def touches_vehicle(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update moved or reshaped an object of the vehicle."""
    changed = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, bpy.types.Object)
        and (update.is_updated_geometry or update.is_updated_transform)
    }
    collection = scene.perception_entropy.vehicle
    if collection is None or not changed:
        return False
    parts = {each for each in changed if not bridge.mounted_on_sensor(each)}
    return not parts.isdisjoint(_with_instanced(collection))


def _with_instanced(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Objects of a collection, and of those that it holds instances of."""
    found: set[bpy.types.Object] = set()
    waiting, known = [collection], {collection}
    while waiting:
        members = set(waiting.pop().all_objects)
        found |= members
        inner = {each.instance_collection for each in members} - known - {None}
        waiting += inner
        known |= inner
    return found
