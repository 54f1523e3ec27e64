"""A whole scene as a study, and a short text that tells whether it is still the same one."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence

import bpy

from ..engine import pe, studies
from .prior import prior_from_scene, prior_signature
from .rig import free_axes, rig_from_objects, sensor_objects, view_layer_of
from .vehicle import vehicle_from_collection, visible_members

SIGNATURE_DECIMALS = 5


def study_from_scene(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> pe.Study:
    """Return the study that a scene describes.

    Raises
    ------
    InputError
        One line that says what in the scene is wrong, what was expected and what was found.
    """
    objects = sensor_objects(scene)
    _check_metres(scene)  # said before what is wrong with a sensor
    _vehicle_chosen(scene)
    free = {obj.name: free_axes(obj) for obj in objects}
    return study_of_rig(scene, depsgraph, rig_from_objects(objects, depsgraph), free)


def study_of_rig(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    rig: pe.Rig,
    free: Mapping[str, tuple[str, ...]],
) -> pe.Study:
    """Return the study of a scene's vehicle and settings with any rig, and what is free of it.

    Raises
    ------
    InputError
        One line that says what in the scene is wrong, what was expected and what was found.
    """
    settings = scene.perception_entropy
    _check_metres(scene)
    return pe.Study(
        rig,
        vehicle_from_collection(_vehicle_chosen(scene), depsgraph),
        prior=prior_from_scene(scene),
        search=_search(settings, free),
        samples=settings.score_samples,
        mesh=studies.MESH,  # the name the mesh gets beside a study: part of what is reported
    )


def signature(scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object] | None = None) -> str:
    """Return a text that changes when a sensor or the vehicle moves, or a setting changes.

    It is cheap, not complete: a mesh edited without a change in its number of points is not seen.
    `sensors` are the scene's, by name, when they have been looked for already.
    """
    layer, seen = view_layer_of(scene), surroundings(scene)
    for obj in sensor_objects(scene) if sensors is None else sensors:
        own, visible = obj.perception_entropy, obj.visible_get(view_layer=layer)
        seen += [obj.name, own.model, own.fusion, visible, _rounded(obj)]
    return hashlib.sha256(repr(seen).encode()).hexdigest()


def surroundings(scene: bpy.types.Scene) -> list[object]:
    """Return what a score depends on besides the sensors: settings, prior, vehicle."""
    settings, layer = scene.perception_entropy, view_layer_of(scene)
    seen: list[object] = [*prior_signature(scene), settings.score_samples]
    if settings.vehicle is not None:
        members = visible_members(settings.vehicle, layer)
        for obj in sorted(members, key=lambda each: each.name_full):
            size = len(obj.data.vertices) if obj.type == "MESH" else 0
            glass = obj.perception_entropy.see_through
            seen += [obj.name_full, size, len(obj.modifiers), glass, _rounded(obj)]
    return seen


def _vehicle_chosen(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The vehicle's collection; complain where none is chosen."""
    vehicle = scene.perception_entropy.vehicle
    if vehicle is None:
        expected = "a collection with the vehicle's meshes"
        raise pe.InputError("scene", "vehicle collection", expected, "none chosen")
    return vehicle


def _rounded(obj: bpy.types.Object) -> list[float]:
    return [round(v, SIGNATURE_DECIMALS) + 0.0 for row in obj.matrix_world for v in row]


def _search(settings: bpy.types.PropertyGroup, free: Mapping[str, tuple[str, ...]]) -> pe.Search:
    schedule = pe.Schedule(candidates=settings.candidates)
    return pe.Search(
        free=dict(free), seed=settings.seed, samples=settings.search_samples, schedule=schedule
    )


def _check_metres(scene: bpy.types.Scene) -> None:
    """One unit has to be one metre, and the user has to see metres."""
    units = scene.unit_settings
    if units.system == "IMPERIAL":
        raise pe.InputError("scene", "unit system", "metres (Metric)", "Imperial")
    if abs(units.scale_length - 1.0) > 1e-6:
        expected = "1, so that a unit is a metre"
        raise pe.InputError("scene", "unit scale", expected, f"{units.scale_length:g}")
