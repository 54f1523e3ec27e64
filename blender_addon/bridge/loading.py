"""A study put into a scene: vehicle, sensors, mounts, and how it is scored and searched."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping

import bpy

from ..choices import BY_GROUP, BY_PARTS, ON_SLOTS
from ..engine import catalog, kinds, pe, search, studies
from .axles import write_reference
from .loaded_body import make_body, paint_area, same_body
from .offers import put_selection
from .passthrough import write_passthrough
from .records import NO_BOUNDS, ZEROS, Record
from .rig import stand_at, view_layer_of
from .scene import study_from_scene, vehicle_of_scene
from .standing import stand
from .targets import put_targets

RACK = "rack {}"
FAR_M = 1e4


def load_into(scene: bpy.types.Scene, study: pe.Study) -> list[str]:
    """Have a scene hold a study; return the keys of its file that the scene cannot hold.

    The scene's vehicle stays where it is the study's to the bit.

    Raises
    ------
    InputError
        When a sensor is of a model that the catalogue does not have.
    """
    records = records_of_study(study)  # what is wrong is said before anything is changed
    _put_vehicle(scene, study)
    _put_settings(scene.perception_entropy, study)
    _put_mounts(scene, study.search.mounting)
    _put_constraints(scene, study.search.mounting.constraints)
    stand(scene, records)
    put_selection(scene, study)
    layer = view_layer_of(scene)
    layer.update()
    return differences(study, study_from_scene(scene, layer.depsgraph))


def differences(study: pe.Study, held: pe.Study) -> list[str]:
    """Return the keys of two studies' files that differ; files' names count for nothing."""
    one, other = (_told(each) for each in (study, held))
    found = sorted(key for key in {*one, *other} if one.get(key) != other.get(key))
    if not same_body(study.vehicle, held.vehicle):
        found.append("vehicle.mesh")
    now = held.search.mounting.mounts
    for name, mount in study.search.mounting.mounts.items():
        if _faces(mount) != _faces(now.get(name)):
            found.append(f"area of mount {name!r}")
    return found


def _faces(mount: search.AnyMount | None) -> object:
    """The faces of an area, to be compared; None for all else."""
    area = getattr(mount, "area", None)
    return None if area is None else area.triangles.tolist()


def _told(study: pe.Study) -> dict[str, object]:
    """A study's file by key, without the names of other files."""
    data = studies.study_to_dict(study)
    flat = {**data, **{f"optimize.{key}": value for key, value in data["optimize"].items()}}
    del flat["optimize"]
    flat["vehicle"] = {k: v for k, v in data.get("vehicle", {}).items() if k == "clearance"}
    mounts = flat.pop("optimize.mount", [])
    plain = ({k: v for k, v in m.items() if k not in ("area", "parts")} for m in mounts)
    flat["optimize.mount"] = sorted(plain, key=lambda mount: mount["name"])
    flat["sensor"] = sorted(data["sensor"], key=lambda sensor: sensor["name"])
    return flat


def records_of_study(study: pe.Study) -> tuple[Record, ...]:
    """Return a study's sensors as variants hold them, by name.

    Raises
    ------
    InputError
        When the catalogue does not have one's model.
    """
    mounting = study.search.mounting
    linked = {a: b for a, b in mounting.pairs} | {b: a for a, b in mounting.pairs}
    racks = {name: RACK.format(n) for n, g in enumerate(mounting.groups, 1) for name in g}
    found = []
    for sensor in study.rig:
        _check_model(sensor)
        name, own = sensor.name, study.search.limits.get(sensor.name, {})
        free = study.search.free[name]
        found.append(
            Record(
                *(name, sensor.model.name, sensor.fusion or "", sensor.pose),
                tuple(axis in free for axis in search.AXES),
                **_bounds(own),
                mirror_of=linked.get(name, ""),
                mount=mounting.on.get(name, ""),
                rack=racks.get(name, ""),
                curve=sensor.curve,
            )
        )
    return tuple(sorted(found, key=lambda record: record.name))


def _bounds(own: Mapping[str, tuple[float, float]]) -> dict[str, tuple]:
    """Bounds as a record has them: degrees for angles."""
    bounded, low, high = list(NO_BOUNDS), list(ZEROS), list(ZEROS)
    for number, axis in enumerate(search.AXES):
        if axis in own:
            ends = own[axis] if axis in "xyz" else tuple(map(math.degrees, own[axis]))
            bounded[number], (low[number], high[number]) = True, ends
    return {"bounded": tuple(bounded), "low": tuple(low), "high": tuple(high)}


def _check_model(sensor: pe.Sensor) -> None:
    known = None
    with contextlib.suppress(pe.InputError):
        known = catalog.load(sensor.model.name)
    if known is None or catalog.to_table(known) != catalog.to_table(sensor.model):
        field = f"sensor {sensor.name!r}: model"
        raise pe.InputError("study", field, "one of the catalogue's", repr(sensor.model.name))


def _put_vehicle(scene: bpy.types.Scene, study: pe.Study) -> None:
    if study.vehicle is None:
        raise pe.InputError("study", "vehicle.mesh", "a vehicle", "none")
    settings, layer, here = scene.perception_entropy, view_layer_of(scene), None
    with contextlib.suppress(pe.InputError):
        here = vehicle_of_scene(scene, layer.depsgraph)
    settings.clearance = study.vehicle.clearance
    if not same_body(here, study.vehicle):
        settings.vehicle = make_body(scene, study.vehicle)
        layer.update()


def _put_settings(settings: bpy.types.PropertyGroup, study: pe.Study) -> None:
    """Space, prior, AP curves, and the search's own."""
    own = study.search
    settings.space_x, settings.space_y, settings.space_z = (
        getattr(study.space, f"{axis}") for axis in "xyz"
    )
    settings.space_interval = study.space.interval
    with contextlib.suppress(TypeError):  # a model of boxes: told as a difference
        settings.prior = study.prior.model
    put_targets(settings, study.targets)
    settings.focus.clear()
    settings.curves.clear()
    usual = pe.PerceptionModel()
    for kind in kinds.KINDS:
        if (curve := study.model.curve(kind)) != usual.curve(kind):
            row = settings.curves.add()
            row.name, row.own, row.a, row.b = kind, True, curve.a, curve.b
    settings.score_samples, settings.search_samples = study.samples, own.samples
    settings.candidates, settings.seed = own.schedule.candidates, min(own.seed, 2**31 - 1)
    settings.method, settings.evaluations = own.method, own.evaluations
    _put_tolerance(settings, own.tolerance)
    write_reference(settings, study.reference)
    write_passthrough(settings, study.passthrough)


def _put_tolerance(settings: bpy.types.PropertyGroup, own: pe.Tolerance) -> None:
    settings.mounting_errors = own.position > 0.0 or own.angle > 0.0
    if settings.mounting_errors:
        settings.tolerance_position = own.position
        settings.tolerance_angle = math.degrees(own.angle)
    settings.failures, settings.worst = own.failures, own.worst


def _put_mounts(scene: bpy.types.Scene, mounting: pe.Mounting) -> None:
    settings = scene.perception_entropy
    settings.mounts.clear()
    members = settings.vehicle.all_objects
    for name, mount in mounting.mounts.items():
        row = settings.mounts.add()
        row.name = name
        if isinstance(mount, pe.SlotMount):
            row.kind, row.slots = ON_SLOTS, _slots(scene, name, mount)
            continue
        row.standoff, row.orientation = mount.standoff, mount.orientation
        if mount.area is None:
            row.faces = BY_PARTS
            for part in mount.parts:
                row.parts.add().part = members.get(part)
        else:
            row.faces, row.group = BY_GROUP, name
            paint_area(list(members), name, mount.area.triangles)


def _slots(scene: bpy.types.Scene, name: str, mount: pe.SlotMount) -> bpy.types.Collection:
    """Return a collection of that name with an empty a slot, and nothing else."""
    made = bpy.data.collections.get(name) or bpy.data.collections.new(name)
    if made not in scene.collection.children_recursive:
        scene.collection.children.link(made)
    for obj in tuple(made.objects):
        made.objects.unlink(obj)
    for slot in mount.slots:
        obj = _empty(slot.name)
        made.objects.link(obj)
        stand_at(obj, slot.pose)
    return made


def _empty(name: str) -> bpy.types.Object:
    """Return an empty of that name: one that there is and that is no sensor, or a new one."""
    found = bpy.data.objects.get(name)
    usable = found is not None and found.type == "EMPTY" and not found.perception_entropy.is_sensor
    return found if usable else bpy.data.objects.new(name, None)


def _put_constraints(scene: bpy.types.Scene, own: pe.Constraints) -> None:
    settings = scene.perception_entropy
    settings.max_height, settings.max_width = own.max_height or 0.0, own.max_width or 0.0
    settings.min_distance, settings.clear_housings = own.min_distance, own.clear_housings
    for obj in scene.objects:
        if obj.perception_entropy.is_no_go:
            obj.perception_entropy.is_no_go = False
    for area in own.no_go:
        obj = _empty(area.name)
        obj.empty_display_type, obj.empty_display_size = "CUBE", 1.0
        sides = [getattr(area, axis) or (-FAR_M, FAR_M) for axis in "xyz"]
        sides = [(max(low, -FAR_M), min(high, FAR_M)) for low, high in sides]
        obj.location = [(low + high) / 2.0 for low, high in sides]
        obj.scale = [(high - low) / 2.0 for low, high in sides]
        if obj.name not in scene.objects:
            scene.collection.objects.link(obj)
        obj.perception_entropy.is_no_go = True
