"""Duplicates of sensors: made by Shift+D, copied, appended, or from an older file."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from .rig import sensor_objects

SENSORS = "Sensors"
"""The collection of a scene's sensors."""


def drop_foreign_results(
    scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object] | None = None
) -> list[str]:
    """Remove results that belong to another sensor or file; return the names of these sensors.

    A duplicate still stores the result of its original, under the original's name. A renamed
    sensor keeps its result, because no other sensor has its old name. `sensors` are the scene's
    sensors, if the caller has already read them.
    """
    sensors = sensor_objects(scene) if sensors is None else sensors
    holding = [each for each in sensors if each.perception_entropy.has_result]
    wrong = []
    for obj in holding:
        settings = obj.perception_entropy
        if not _of_the_last_result(settings, scene) or _is_copy(obj, sensors):
            settings.has_result = False
            wrong.append(obj.name)
        elif settings.result_of != obj.name:
            settings.result_of = obj.name
    return wrong


def _of_the_last_result(settings: bpy.types.PropertyGroup, scene: bpy.types.Scene) -> bool:
    """Whether a sensor's figures belong to the scene's last result; always so in older files."""
    last = scene.perception_entropy
    return last.has_result and settings.result_run in ("", last.result_signature)


def _is_copy(obj: bpy.types.Object, sensors: Sequence[bpy.types.Object]) -> bool:
    """Whether a sensor's result is stored under the name of another sensor."""
    whose = obj.perception_entropy.result_of
    return whose not in ("", obj.name) and any(other.name == whose for other in sensors)


def unlink_duplicates(scene: bpy.types.Scene) -> list[str]:
    """Unlink sensors from the root collection if they are in the collection of sensors, too.

    Return their names. If a view layer excludes the collection of sensors, nothing is unlinked:
    the sensors would disappear from that layer.
    """
    if any(_excluded(layer.layer_collection) for layer in scene.view_layers):
        return []
    doubled = [
        obj
        for obj in sensor_objects(scene)
        if scene.collection in obj.users_collection
        and any(collection.name == SENSORS for collection in obj.users_collection)
    ]
    for obj in doubled:
        scene.collection.objects.unlink(obj)
    return [obj.name for obj in doubled]


def _excluded(layer: bpy.types.LayerCollection) -> bool:
    """Whether a view layer excludes a collection of sensors."""
    is_excluded = layer.exclude and layer.collection.name == SENSORS
    return is_excluded or any(map(_excluded, layer.children))
