"""The one way from a scene to a study: its table, read as the document of a study file.

What Blender holds takes its place in the document: sensors (the scene's own, those of a variant, or
any rig), vehicle, prior, and the rows of lists.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from bpy.types import Collection, Depsgraph, Object, Scene

from ..engine import pe, search, studies
from .conditions import as_drawn, conditions_of, read_states
from .edges import edges_of
from .mounting import constraints_of, mounting_of, mounts_of
from .prior import prior_from_scene
from .requirements import requirements_of
from .rig import sensor_objects, view_layer_of
from .sensor_records import SensorRecord, record_of_object, record_of_sensor, records_of, rig_of
from .study_table import TableData, document_of
from .time import scenarios_of
from .transform_constraints import unlocked_axes
from .vehicle import vehicle_from_collection


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
    return study_of(scene, depsgraph, records, vehicle=vehicle)


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
    return study_of(scene, depsgraph, [record_of_sensor(sensor) for sensor in rig])


def study_of(
    scene: Scene,
    depsgraph: Depsgraph,
    records: Sequence[SensorRecord],
    *,
    source: str = "scene",
    vehicle: pe.Vehicle | None = None,
) -> pe.Study:
    """Return the study of a scene's vehicle, mounts and settings with these sensors. `source`
    ("scene" or "variant") is what errors about sensors name. `InputError` with one line that says
    what is wrong."""
    check_scene(scene)
    settings = scene.perception_entropy
    counted = [record for record in records if record.visible]
    rig = rig_of(records, source)  # errors of a sensor come before those of the vehicle
    body = vehicle or vehicle_of_scene(scene, depsgraph)
    choices = tuple(_choice(record) for record in counted if record.options)
    document = document_of(settings, is_choice=bool(choices))
    wanted = document.optimize.search
    mounting = mounting_of(
        counted, mounts_of(scene, depsgraph, records), constraints_of(scene, wanted.mounting)
    )
    goals = _goals_of_sensors(_with_starts(wanted.goals, scene), counted, mounting)
    document = replace(
        document,
        prior=prior_from_scene(scene),
        vehicle=replace(document.vehicle, edge=edges_of(scene, depsgraph)),
        sensor=tuple(
            _sensor_table(sensor, record, mounting)
            for sensor, record in zip(rig, counted, strict=True)
        ),
        requirements=requirements_of(settings),
        conditions=conditions_of(settings),
        scenarios=scenarios_of(settings),
        optimize=studies.Optimize(search=replace(wanted, mounting=mounting, goals=goals)),
        selection=replace(document.selection, choices=choices),
    )
    return document.study(studies.Node({}, "scene"), body)


def _sensor_table(
    sensor: pe.Sensor, record: SensorRecord, mounting: pe.Mounting
) -> studies.SensorTable:
    """Return the table of a sensor; one in a slot, or one that follows another, has no bounds."""
    has_bounds = not mounting.unbounded(record.name)
    return studies.SensorTable(
        sensor,
        free=unlocked_axes(record.free, record.locked),
        bounds=record.bounds if has_bounds else studies.AxisBounds(),
        mount=mounting.on.get(record.name),
    )


def _with_starts(goals: search.Goals, scene: Scene) -> search.Goals:
    """Return the goals of a search with the scene's other variants as starts, if they are on."""
    own = scene.perception_entropy
    if not own.start_variants:
        return goals
    starts = [
        search.Start(row.name, {record.name: record.pose for record in records_of(row)})
        for row in own.variants
        if row.key != own.variant_key
    ]
    return replace(goals, starts=(*goals.starts, *starts))


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
    clearance = document_of(scene.perception_entropy, "vehicle").vehicle.clearance
    return vehicle_from_collection(_vehicle_chosen(scene), depsgraph, clearance)


def _vehicle_chosen(scene: Scene) -> Collection:
    """Return the vehicle's collection; raise `InputError` where none is chosen."""
    vehicle = scene.perception_entropy.vehicle
    if vehicle is None:
        expected = "a collection with the vehicle's meshes"
        raise pe.InputError("scene", "vehicle collection", expected, "none chosen")
    return vehicle


def _choice(record: SensorRecord) -> pe.Choice:
    """Return the models of which a sensor takes one. `InputError` when a model is not in the
    catalogue, is there twice, or has no price."""
    try:
        options = [_option(option) for option in record.options]
        return pe.Choice(options, [record.name], None, record.may_be_left_out)
    except pe.InputError as error:
        raise error.within("scene", f"sensor {record.name!r}") from None


def _option(table: TableData) -> pe.Option:
    if not table.get("price"):
        field = f"price of {table.get('model', '')}"
        raise pe.InputError("choice", field, "a price above 0", 0.0)
    return studies.read(pe.Option, studies.Node(table, "choice"))
