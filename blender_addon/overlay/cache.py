"""The overlay's arrays, sensor by sensor: rebuilt for what changed, kept for the rest. No GPU."""

from __future__ import annotations

import contextlib
from collections.abc import Hashable

import bpy

from .. import body, bridge, roster
from ..engine import pe
from .geometry import OverlayGeometry
from .kinds import beam_budget, sensor_geometry

LEAST_LENGTH_M = 0.1


class OverlayCache:
    """Remembers names, plain values and arrays; never a Blender object."""

    def __init__(self) -> None:
        self._shown: dict[str, tuple[Hashable, OverlayGeometry]] = {}

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self._shown = {}

    def update(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
    ) -> dict[str, OverlayGeometry]:
        """Return what to draw by the sensor's name; what did not change is the same object."""
        sensors = shown_sensors(scene, depsgraph)
        vehicle, body_key = body.shared.read(scene, depsgraph) if sensors else body.NOTHING
        settings = scene.perception_entropy
        budget = beam_budget(sensors, settings.beam_limit)
        length_m = max(LEAST_LENGTH_M, settings.beam_length)  # also of a length that is no number
        before, self._shown = self._shown, {}
        for sensor in sensors:
            key = body_key, sensor.model, sensor.pose, budget, length_m
            known = before.get(sensor.name)
            if known is None or known[0] != key:
                built = sensor_geometry(sensor, vehicle, budget, length_m)
                known = key, built
            self._shown[sensor.name] = known
        return {name: geometry for name, (_, geometry) in self._shown.items()}


def shown_sensors(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> list[pe.Sensor]:
    """Sensors to draw, without those that are not possible; a score says what is wrong there."""
    found = []
    for each in roster.sensors(scene):
        if each.perception_entropy.show:
            with contextlib.suppress(pe.InputError):
                found.append(bridge.sensor_from_object(each, depsgraph))
    return found
