"""Load an imported study: write its table to the scene, and make what Blender holds.

A comparison of the imported study with the study of the scene finds what the scene cannot hold.
"""

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import bpy
import numpy as np
from bpy.types import Collection, Object, PropertyGroup, Scene

from ..choices import BY_GROUP, BY_MESH, BY_PARTS, ON_SLOTS
from ..engine import catalog, kinds, pe, search, studies
from .apply_variant import apply_records
from .conditions import write_conditions
from .edges import write_edges
from .prior import write_prior
from .requirements import write_requirements
from .rig import place_at, view_layer_of
from .scene_study import study_from_scene, vehicle_of_scene
from .sensor_records import SensorRecord, record_of_sensor
from .study_table import TableData, value_at, write_table
from .time import write_scenarios
from .vehicle import make_body, paint_area, same_body

RACK = "rack {}"
FAR_M = 1e4
HELD = (
    *(
        ("vehicle", key)
        for key in ("mesh", "glass", "covers", "forward", "up", "scale", "rotation", "edge")
    ),
    *(("optimize", key) for key in ("mount", "pairs", "groups", "no_go", "fixed")),
    ("selection", "choice"),
)
"""Keys of a study's tables that Blender holds."""


def load_into(scene: Scene, study: pe.Study) -> list[str]:
    """Write a study to a scene; return the keys of its file that the scene cannot hold.

    Before them are the sensors that have another name here, as another object has theirs. If
    sensors choose their model together, each of them gets the options.

    The scene's vehicle is kept if its triangles are equal to the study's to the bit.

    `InputError` when the study has no vehicle, or a sensor is of a model that the catalogue does
    not have.
    """
    if study.vehicle is None:
        raise pe.InputError("study", "vehicle.mesh", "a vehicle", "none")
    sensors = _sensor_records(study)  # an error comes before anything is changed
    settings = scene.perception_entropy
    mounting = study.search.mounting
    write_table(settings, scene_table(study))
    _write_vehicle(scene, study.vehicle)
    write_edges(scene, study.edges)
    write_prior(settings, study.prior)
    write_requirements(settings, study.requirements)
    write_conditions(settings, study.conditions)
    write_scenarios(settings, study.scenarios)
    _show_curves(settings)
    settings.start_variants = False
    _write_mounts(scene, mounting.mounts)
    _write_no_go(scene, mounting.constraints.no_go)
    names = apply_records(scene, sensors)
    for sensor in sensors:
        own = scene.objects[names[sensor.name]].perception_entropy
        _write_options(own, sensor.options)
    layer = view_layer_of(scene)
    layer.update()
    renamed = {name: here for name, here in names.items() if name != here}
    lines = [
        f"sensor {name!r} (here {new_name!r}: another object has its name)"
        for name, new_name in renamed.items()
    ]
    return lines + differences(study, study_from_scene(scene, layer.depsgraph), renamed)


def scene_table(study: pe.Study) -> TableData:
    """Return the table of a study's file without what Blender holds: sensors, mesh, prior, and what
    is a list in the panel."""
    table = studies.study_to_dict(study)
    for key in ("sensor", "requirement", "weather", "state", "scenario", "prior"):
        table.pop(key, None)
    for path in HELD:
        owner = table.get(path[0], {})
        owner.pop(path[1], None)
    return {key: value for key, value in table.items() if value != {}}


def differences(
    study: pe.Study, held: pe.Study, renamed: Mapping[str, str] = MappingProxyType({})
) -> list[str]:
    """Return the keys in which two studies differ; names of other files are left out. `renamed` has
    the names that sensors of the first study have in the second."""
    one = _comparable(study, renamed)
    other = _comparable(held)
    keys = sorted(key for key in {*one, *other} if one.get(key) != other.get(key))
    if not same_body(study.vehicle, held.vehicle):
        keys.append("vehicle.mesh")
    held_mounts = held.search.mounting.mounts
    for name, mount in study.search.mounting.mounts.items():
        if _faces(mount) != _faces(held_mounts.get(name)):
            keys.append(f"area of mount {name!r}")
    return keys


def _faces(mount: search.AnyMount | None) -> object:
    """Return the triangles of a mount's area; None for a mount without one."""
    area = getattr(mount, "area", None)
    return None if area is None else area.triangles.tolist()


def _comparable(
    study: pe.Study, renamed: Mapping[str, str] = MappingProxyType({})
) -> dict[str, object]:
    """Return the values of a study's file by key, without the names of other files."""
    data = studies.study_to_dict(study)
    flat = {**data, **{f"optimize.{key}": value for key, value in data["optimize"].items()}}
    del flat["optimize"]
    flat["vehicle"] = {k: v for k, v in data.get("vehicle", {}).items() if k == "clearance"}
    mounts = flat.pop("optimize.mount", [])
    plain = ({k: v for k, v in m.items() if k not in ("area", "parts")} for m in mounts)
    flat["optimize.mount"] = sorted(plain, key=lambda mount: mount["name"])
    flat["sensor"] = [s | {"name": renamed.get(s["name"], s["name"])} for s in data["sensor"]]
    return flat


def _sensor_records(study: pe.Study) -> tuple[SensorRecord, ...]:
    """Return a study's sensors as records."""
    mounting = study.search.mounting
    linked = {a: b for a, b in mounting.pairs} | {b: a for a, b in mounting.pairs}
    racks = {name: RACK.format(n) for n, group in enumerate(mounting.groups, 1) for name in group}
    records = []
    for order, sensor in enumerate(study.rig, -len(study.rig)):  # before what is added later
        model = None
        with contextlib.suppress(pe.InputError):
            model = catalog.load(sensor.model.name)
        if model is None or catalog.to_table(model) != catalog.to_table(sensor.model):
            field = f"sensor {sensor.name!r}: model"
            raise pe.InputError("study", field, "one of the catalogue's", repr(sensor.model.name))
        name = sensor.name
        mount = mounting.on.get(name, "")
        records.append(
            replace(
                record_of_sensor(sensor),
                free=study.search.free[name],
                bounds=studies.AxisBounds(**study.search.limits.get(name, {})),
                mirror_of=linked.get(name, ""),
                mount=mount,
                rack=racks.get(name, ""),
                stays=name in study.search.goals.fixed,
                order=order,
                **_options(study.selection, name, mount),
            )
        )
    return tuple(records)


def _options(selection: pe.Selection, name: str, mount: str) -> dict[str, Any]:
    """Return the models that a sensor is offered, and whether it may be left out."""
    choices = [c for c in selection.choices if name in c.sensors or c.mount == mount]
    options = tuple(studies.write(option) for choice in choices for option in choice.options)
    return {"options": options, "may_be_left_out": bool(choices) and choices[-1].optional}


def _write_vehicle(scene: Scene, vehicle: pe.Vehicle) -> None:
    settings = scene.perception_entropy
    layer = view_layer_of(scene)
    present = None
    with contextlib.suppress(pe.InputError):
        present = vehicle_of_scene(scene, layer.depsgraph)
    if not same_body(present, vehicle):
        settings.vehicle = make_body(scene, vehicle)
        layer.update()


def _show_curves(settings: PropertyGroup) -> None:
    """Have a row for each kind of sensor whose curve the table has."""
    settings.curves.clear()
    for kind in kinds.KINDS:
        if value_at(settings.table, ("ap", kind)):
            settings.curves.add().name = kind


def _write_options(settings: PropertyGroup, options: Sequence[TableData]) -> None:
    """Write the models that a sensor is offered."""
    settings.options.clear()
    for table in options:
        write_table(settings.options.add(), table)


def _write_mounts(scene: Scene, mounts: Mapping[str, search.AnyMount]) -> None:
    settings = scene.perception_entropy
    settings.mounts.clear()
    for name, mount in mounts.items():
        row = settings.mounts.add()
        row.name = name
        write_mount(scene, row, mount)


def write_mount(scene: Scene, row: PropertyGroup, mount: search.AnyMount) -> None:
    """Write a mount to its row. An area that is no faces of the vehicle becomes a mesh beside
    it."""
    members = scene.perception_entropy.vehicle.all_objects
    if isinstance(mount, pe.SlotMount):
        row.kind = ON_SLOTS
        row.slots = _slots(scene, row.name, mount)
        return
    table = studies.write(mount)
    for key in ("parts", "area"):  # objects, or painted faces
        table.pop(key, None)
    write_table(row, table)
    if mount.area is None:
        row.faces = BY_PARTS
        for part in mount.parts:
            row.parts.add().part = members.get(part)
        return
    row.faces = BY_GROUP
    row.group = row.name
    if not paint_area(list(members), row.name, mount.area.triangles):
        row.faces = BY_MESH
        row.area = _area_object(scene, row.name, mount.area.triangles)


def _area_object(scene: Scene, name: str, triangles: np.ndarray) -> Object:
    """Return a new mesh of faces (F, 3, 3) in the ground frame, drawn as wire and not rendered."""
    mesh = bpy.data.meshes.new(name)
    corners = triangles.reshape(-1, 3)
    mesh.from_pydata(corners.tolist(), [], np.arange(len(corners)).reshape(-1, 3).tolist())
    obj = bpy.data.objects.new(name, mesh)
    obj.display_type = "WIRE"
    obj.hide_render = True
    scene.collection.objects.link(obj)
    return obj


def _slots(scene: Scene, name: str, mount: pe.SlotMount) -> Collection:
    """Return the named collection with exactly one empty for each slot."""
    made = bpy.data.collections.get(name) or bpy.data.collections.new(name)
    if made not in scene.collection.children_recursive:
        scene.collection.children.link(made)
    for obj in tuple(made.objects):
        made.objects.unlink(obj)
    for slot in mount.slots:
        obj = _empty(slot.name)
        made.objects.link(obj)
        place_at(obj, slot.pose)
    return made


def _empty(name: str) -> Object:
    """Return the empty with that name, or a new one; a sensor is never returned."""
    obj = bpy.data.objects.get(name)
    if obj is not None and obj.type == "EMPTY" and not obj.perception_entropy.is_sensor:
        return obj
    return bpy.data.objects.new(name, None)


def _write_no_go(scene: Scene, areas: Sequence[pe.NoGo]) -> None:
    for obj in scene.objects:
        if obj.perception_entropy.is_no_go:
            obj.perception_entropy.is_no_go = False
    for area in areas:
        obj = _empty(area.name)
        obj.empty_display_type = "CUBE"
        obj.empty_display_size = 1.0
        sides = [getattr(area, axis) or (-FAR_M, FAR_M) for axis in "xyz"]
        sides = [(max(low, -FAR_M), min(high, FAR_M)) for low, high in sides]
        obj.location = [(low + high) / 2.0 for low, high in sides]
        obj.scale = [(high - low) / 2.0 for low, high in sides]
        if obj.name not in scene.objects:
            scene.collection.objects.link(obj)
        obj.perception_entropy.is_no_go = True
