"""A whole scene as a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy

from ..engine import pe, studies
from .advanced import Limits, all_limits, clearance_of, limits_of, perception_of, space_of
from .axles import reference_of
from .holds import constrained, free_axes
from .mounting import mounting_of
from .offers import selection_of
from .passthrough import passthrough_of
from .prior import prior_from_scene
from .rig import rig_from_objects, sensor_objects
from .targets import targets_of
from .tolerance import tolerance_of
from .vehicle import vehicle_from_collection


def study_from_scene(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    vehicle: pe.Vehicle | None = None,
    sensors: Sequence[bpy.types.Object] | None = None,
) -> pe.Study:
    """Return the study that a scene describes.

    `vehicle` and `sensors` (all, by name) if they have been read and looked for already.

    Raises
    ------
    InputError
        One line that says what in the scene is wrong, what was expected and what was found.
    """
    objects = sensor_objects(scene) if sensors is None else sensors
    check_scene(scene)  # said before what is wrong with a sensor
    free = {obj.name: free_axes(obj) for obj in objects}
    rig = rig_from_objects(objects, depsgraph)
    vehicle = vehicle or vehicle_of_scene(scene, depsgraph)
    counted = [scene.objects[sensor.name] for sensor in rig]
    mounting = mounting_of(scene, depsgraph, counted)
    limits = _limits(counted, rig, vehicle, mounting)
    study = study_of_rig(scene, depsgraph, rig, free, vehicle, limits, mounting)
    return replace(study, selection=selection_of(scene.perception_entropy, counted))


def study_of_rig(
    scene: bpy.types.Scene,
    depsgraph: bpy.types.Depsgraph,
    rig: pe.Rig,
    free: Mapping[str, tuple[str, ...]],
    vehicle: pe.Vehicle | None = None,
    limits: Mapping[str, Limits] | None = None,
    mounting: pe.Mounting | None = None,
) -> pe.Study:
    """Return the study of a scene's vehicle and settings with any rig, and what is free of it.

    `limits` are bounds of its axes, by sensor; by default those of the scene's sensors. Without
    `mounting` all sensors move in boxes of coordinates.

    Raises
    ------
    InputError
        One line that says what in the scene is wrong, what was expected and what was found.
    """
    settings = scene.perception_entropy
    _check_metres(scene)
    bounds = all_limits(sensor_objects(scene)) if limits is None else limits
    return pe.Study(
        rig,
        vehicle or vehicle_of_scene(scene, depsgraph),
        space_of(settings),
        prior=prior_from_scene(scene),
        model=perception_of(settings),
        search=_search(settings, free, bounds, mounting or pe.Mounting()),
        samples=settings.score_samples,
        mesh=studies.MESH,  # the name the mesh gets beside a study: part of what is reported
        reference=reference_of(settings),
        passthrough=passthrough_of(settings),
        targets=targets_of(settings),
    )


def _limits(
    objects: Sequence[bpy.types.Object],
    rig: pe.Rig,
    vehicle: pe.Vehicle,
    mounting: pe.Mounting,
) -> dict[str, Limits]:
    """Bounds of the sensors that may have some: not of those in slots, or that follow others."""
    found = {}
    for obj in objects:
        if mounting.unbounded(obj.name):
            continue
        if own := constrained(obj, rig[obj.name], vehicle, limits_of(obj)):
            found[obj.name] = own
    return found


def check_scene(scene: bpy.types.Scene) -> None:
    """Complain about a scene that no study can be read from.

    Raises
    ------
    InputError
        When a unit is not a metre, or no vehicle is chosen.
    """
    _check_metres(scene)
    _vehicle_chosen(scene)


def vehicle_of_scene(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> pe.Vehicle:
    """Return the vehicle that is chosen, read anew.

    Raises
    ------
    InputError
        When none is chosen, or it is none that can be scored.
    """
    return vehicle_from_collection(_vehicle_chosen(scene), depsgraph, clearance_of(scene))


def _vehicle_chosen(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The vehicle's collection; complain where none is chosen."""
    vehicle = scene.perception_entropy.vehicle
    if vehicle is None:
        expected = "a collection with the vehicle's meshes"
        raise pe.InputError("scene", "vehicle collection", expected, "none chosen")
    return vehicle


def _search(
    settings: bpy.types.PropertyGroup,
    free: Mapping[str, tuple[str, ...]],
    limits: Mapping[str, Limits],
    mounting: pe.Mounting,
) -> pe.Search:
    return pe.Search(
        dict(free),
        dict(limits),
        settings.seed,
        settings.search_samples,
        pe.Schedule(candidates=settings.candidates),
        mounting,
        settings.method,
        settings.evaluations,
        tolerance_of(settings),
    )


def _check_metres(scene: bpy.types.Scene) -> None:
    """One unit has to be one metre, and the user has to see metres."""
    units = scene.unit_settings
    if units.system == "IMPERIAL":
        raise pe.InputError("scene", "unit system", "metres (Metric)", "Imperial")
    if abs(units.scale_length - 1.0) > 1e-6:
        expected = "1, so that a unit is a metre"
        raise pe.InputError("scene", "unit scale", expected, f"{units.scale_length:g}")
