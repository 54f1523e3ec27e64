"""The one way from a scene to a study: scene -> record -> study.

A `SceneRecord` holds everything that a study is made of, as plain values of the engine: sensors,
vehicle, mounts and settings. It is read of a scene with its own sensors (`study_from_scene`), with
those of a variant (`variants.study_of_variant`), or with any rig (`study_of_rig`), and of an
imported study (`loading.record_of_study`). `study_of` converts each of them to a `Study`.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from bpy.types import Collection, Depsgraph, Object, PropertyGroup, Scene

from ..engine import catalog, motion, pe, requirements, search, studies
from .conditions import as_drawn, conditions_of, read_states
from .limits import limits_of
from .mounting import constraints_of, mounting_of, mounts_of
from .prior import prior_from_scene
from .requirements import requirements_of
from .rig import sensor_objects, view_layer_of
from .scene_settings import (
    clearance_of,
    perception_of,
    reference_of,
    search_of,
    space_of,
    targets_of,
    values_of,
    write_values,
)
from .sensor_records import (
    ModelOption,
    SensorRecord,
    bounds_of,
    record_of_object,
    record_of_sensor,
    records_of,
    rig_of,
)
from .time import time_of
from .transform_constraints import unlocked_axes
from .vehicle import vehicle_from_collection

AnyMount = search.AnyMount  # the record has fields of these names
Limits = search.Limits
Requirement = requirements.Requirement


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneRecord:
    """Everything that a study is made of. `search` and `selection` hold settings for all sensors
    together. The record of each sensor holds its free axes, bounds, mount and model options.
    `source` ("scene" or "variant") is the source that errors about sensors name."""

    source: str
    sensors: tuple[SensorRecord, ...]
    vehicle: pe.Vehicle
    space: pe.PerceptionSpace
    prior: pe.Prior
    model: pe.PerceptionModel
    targets: pe.TargetRule
    samples: int
    returns: str
    search: pe.Search
    mounts: Mapping[str, AnyMount]
    constraints: pe.Constraints
    limits: Limits
    selection: pe.Selection
    reference: pe.Reference | None
    requirements: tuple[Requirement, ...]
    conditions: pe.Conditions
    frames: motion.Frames
    confirmation: motion.Confirmation
    stories: tuple[motion.Story, ...]


def study_from_scene(
    scene: Scene,
    depsgraph: Depsgraph,
    vehicle: pe.Vehicle | None = None,
    sensors: Sequence[Object] | None = None,
) -> pe.Study:
    """Return the study that a scene describes.

    `vehicle` and `sensors` (all, by name) are given by callers that have already read them.

    `InputError` with one line that says what is wrong.
    """
    objects = sensor_objects(scene) if sensors is None else sensors
    check_scene(scene)  # its errors come before those of a sensor
    layer = depsgraph.view_layer
    visible = [obj for obj in objects if obj.visible_get(view_layer=layer)]
    if not visible:
        found = f"{len(objects)} hidden" if objects else "none"
        raise pe.InputError("scene", "sensors", "at least one visible sensor", found)
    records = [record_of_object(obj, depsgraph, layer) for obj in visible]
    return study_of(record_of_scene(scene, depsgraph, records, vehicle=vehicle))


def study_as_drawn(scene: Scene) -> pe.Study:
    """Return the study of a scene as its vehicle is drawn, with its states read again. `InputError`
    as `study_from_scene`, and where a part of a state bends."""
    with as_drawn(scene):
        read_states(scene)
        layer = view_layer_of(scene)
        layer.update()
        return study_from_scene(scene, layer.depsgraph)


def study_of_rig(scene: Scene, depsgraph: Depsgraph, rig: Iterable[pe.Sensor]) -> pe.Study:
    """Return the study of a scene's vehicle and settings with any rig in place of its sensors.

    The rig's sensors have the free axes of the paper, and no bounds of their own.

    `InputError` with one line that says what is wrong.
    """
    records = [record_of_sensor(sensor) for sensor in rig]
    return study_of(record_of_scene(scene, depsgraph, records))


def record_of_scene(
    scene: Scene,
    depsgraph: Depsgraph,
    records: Sequence[SensorRecord],
    *,
    source: str = "scene",
    vehicle: pe.Vehicle | None = None,
) -> SceneRecord:
    """Return a scene's vehicle, mounts and settings with these sensors. `InputError` when no study
    can be read from the scene, or a mount that a sensor is on is incomplete."""
    check_scene(scene)
    settings = scene.perception_entropy
    is_choice = any(record.options for record in records if record.visible)
    rig_of(records, source)  # errors of a sensor come before those of the vehicle
    return SceneRecord(
        source=source,
        sensors=tuple(records),
        vehicle=vehicle or vehicle_of_scene(scene, depsgraph),
        mounts=mounts_of(scene, depsgraph, records),
        constraints=constraints_of(scene),
        limits=limits_of(settings),
        space=space_of(settings),
        prior=prior_from_scene(scene),
        model=perception_of(settings),
        targets=targets_of(settings),
        **values_of(settings, pe.Study),
        search=_with_starts(search_of(settings, is_choice=is_choice), scene),
        selection=pe.Selection(**values_of(settings, pe.Selection))
        if is_choice
        else pe.Selection(),
        reference=reference_of(settings),
        requirements=requirements_of(settings),
        conditions=conditions_of(settings),
        **time_of(settings),
    )


def study_of(record: SceneRecord) -> pe.Study:
    """Return the study that a record describes: of a scene, a variant or an imported file alike.
    `InputError` with one line that says what is wrong."""
    rig = rig_of(record.sensors, record.source)
    counted = [sensor for sensor in record.sensors if sensor.visible]
    mounting = mounting_of(counted, record.mounts, record.constraints)
    search_of_rig = replace(
        record.search,
        free={sensor.name: unlocked_axes(sensor.free, sensor.locked) for sensor in counted},
        limits=_limits(counted, mounting),
        mounting=mounting,
        goals=_goals_of_sensors(record.search.goals, counted, mounting),
    )
    return pe.Study(
        rig,
        search=search_of_rig,
        mesh=studies.MESH,  # the name the mesh gets beside a study: part of what is reported
        selection=selection_of(counted, record.selection),
        **as_in_study(record),
    )


def as_in_study(given: SceneRecord | pe.Study) -> dict[str, Any]:
    """Return by name the values that a record and a study have alike."""
    names = {f.name for f in fields(SceneRecord)} & {f.name for f in fields(pe.Study)}
    return {name: getattr(given, name) for name in names - {"search", "selection"}}


def _limits(
    records: Sequence[SensorRecord], mounting: pe.Mounting
) -> dict[str, dict[str, tuple[float, float]]]:
    """Return bounds by sensor; a sensor in a slot, or one that follows another, has none."""
    own = {r.name: bounds_of(r) for r in records if not mounting.unbounded(r.name)}
    return {name: bounds for name, bounds in own.items() if bounds}


def _with_starts(settings: pe.Search, scene: Scene) -> pe.Search:
    """Return the settings of a search with the scene's other variants as starts, if they are on."""
    own = scene.perception_entropy
    if not own.start_variants:
        return settings
    starts = [
        search.Start(row.name, {record.name: record.pose for record in records_of(row)})
        for row in own.variants
        if row.key != own.variant_key
    ]
    goals = replace(settings.goals, starts=(*settings.goals.starts, *starts))
    return replace(settings, goals=goals)


def _goals_of_sensors(
    goals: search.Goals, records: Sequence[SensorRecord], mounting: pe.Mounting
) -> search.Goals:
    """Return goals for these sensors: which of them stay, and starts without the others."""
    names = {record.name for record in records}
    followers = {pair[1] for pair in mounting.pairs}
    followers |= {name for group in mounting.groups for name in group[1:]}
    fixed = [r.name for r in records if r.stays and r.name not in followers]
    starts = [
        search.Start(start.name, {n: pose for n, pose in start.poses.items() if n in names})
        for start in goals.starts
    ]
    return replace(goals, fixed=fixed, starts=starts)


def check_scene(scene: Scene) -> None:
    """Check that a study can be read from a scene. `InputError` when a unit is not a metre, or no
    vehicle is chosen."""
    units = scene.unit_settings
    if units.system == "IMPERIAL":
        raise pe.InputError("scene", "unit system", "metres (Metric)", "Imperial")
    if abs(units.scale_length - 1.0) > 1e-6:
        expected = "1, so that a unit is a metre"
        raise pe.InputError("scene", "unit scale", expected, f"{units.scale_length:g}")
    _vehicle_chosen(scene)


def vehicle_of_scene(scene: Scene, depsgraph: Depsgraph) -> pe.Vehicle:
    """Read the chosen vehicle from the scene and return it; no cache is used. `InputError` when
    none is chosen, or it cannot be scored."""
    return vehicle_from_collection(_vehicle_chosen(scene), depsgraph, clearance_of(scene))


def _vehicle_chosen(scene: Scene) -> Collection:
    """Return the vehicle's collection; raise `InputError` where none is chosen."""
    vehicle = scene.perception_entropy.vehicle
    if vehicle is None:
        expected = "a collection with the vehicle's meshes"
        raise pe.InputError("scene", "vehicle collection", expected, "none chosen")
    return vehicle


def selection_of(records: Sequence[SensorRecord], limits: pe.Selection) -> pe.Selection:
    """Return the choices of visible sensors with the scene's limits on all of them. `InputError`
    when a model is not in the catalogue, is there twice, or has no price."""
    choices = [_choice(record) for record in records if record.visible and record.options]
    return replace(limits, choices=choices) if choices else pe.Selection()


def write_options(settings: PropertyGroup, record: SensorRecord) -> None:
    """Write the model options of a record to a sensor of the scene."""
    settings.options.clear()
    settings.may_be_left_out = record.may_be_left_out
    for option in record.options:
        row = settings.options.add()
        row.model = option.model
        write_values(row, option.sheet)


def _choice(record: SensorRecord) -> pe.Choice:
    try:
        options = [_option(option) for option in record.options]
        return pe.Choice(options, [record.name], None, record.may_be_left_out)
    except pe.InputError as error:
        raise error.within("scene", f"sensor {record.name!r}") from None


def _option(option: ModelOption) -> pe.Option:
    sheet = option.sheet
    if not sheet.price:
        raise pe.InputError("choice", f"price of {option.model}", "a price above 0", 0.0)
    return pe.Option(
        catalog.load(option.model), sheet.price, sheet.mass, sheet.power, data_rate=sheet.data_rate
    )
