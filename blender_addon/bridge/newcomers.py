"""Sensors that came by Shift+D, copying, appending, or from an older file."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from .rig import sensor_objects

SENSORS = "Sensors"
"""The collection of a scene's sensors."""


def drop_foreign_results(
    scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object] | None = None
) -> list[str]:
    """Take away results that are another sensor's, or another file's; return whose were dropped.

    A duplicate brings its original's result, under the original's name. A sensor that was renamed
    keeps its own: nobody else has that name. `sensors` are the scene's, if they are known already.
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
    """Whether a sensor's figures came with the scene's; of older files it is taken so."""
    last = scene.perception_entropy
    return last.has_result and settings.result_run in ("", last.result_signature)


def _is_copy(obj: bpy.types.Object, sensors: Sequence[bpy.types.Object]) -> bool:
    """Whether what an object holds is under the name of another sensor."""
    whose = obj.perception_entropy.result_of
    return whose not in ("", obj.name) and any(other.name == whose for other in sensors)


def unlink_doubles(scene: bpy.types.Scene) -> list[str]:
    """Take sensors that are in their collection out of the scene's own; return their names.

    Where their collection is excluded from a view, they are left: they would vanish from it.
    """
    if any(_excluded(layer.layer_collection) for layer in scene.view_layers):
        return []
    doubled = [
        each
        for each in sensor_objects(scene)
        if scene.collection in each.users_collection
        and any(of.name == SENSORS for of in each.users_collection)
    ]
    for each in doubled:
        scene.collection.objects.unlink(each)
    return [each.name for each in doubled]


def _excluded(layer: bpy.types.LayerCollection) -> bool:
    """Whether a collection of sensors is excluded, anywhere in a view."""
    own = layer.exclude and layer.collection.name == SENSORS
    return own or any(map(_excluded, layer.children))
