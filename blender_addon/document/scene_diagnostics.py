"""Diagnostics of a scene: missing data, units, hidden collections, sensors that cannot be scored.

`scene_advice` returns them as warnings; `check_placeable` refuses a search that could not place
its sensors.
"""

from collections.abc import Container, Iterable, Iterator, Sequence
from typing import Any

import bpy
from bpy.types import ID, Collection, LayerCollection, Object, Scene

from ..engine import advice, pe
from .mounting import followers_of
from .rig import sensor_objects, view_layer_of
from .sensor_records import sensor_from_object
from .transform_constraints import AXIS_LABELS, free_axes, holders, locked_axes
from .vehicle import (
    IN_RENDERS,
    hidden_how,
    instanced_by,
    instanced_collections,
    instanced_members,
    layers_of,
    visible_members,
)

MISSING = "missing"
DRIVER = "driver"
UNITS = "units"
REFUSED = "refused"
HIDDEN = "hidden_vehicle"
INSTANCED = "instanced_sensors"
"""Codes of warnings, beside those of the engine."""


def scene_advice(scene: Scene) -> tuple[advice.Advice, ...]:
    """Return warnings about a scene: missing data, units, and sensors that cannot be scored."""
    sensors = sensor_objects(scene)
    warnings = (*missing_data(scene, sensors), *_units(scene), *_hidden_vehicle(scene))
    return (*warnings, *_instanced(scene), *_refused(scene, sensors))


def missing_data(
    scene: Scene, sensors: Sequence[Object] | None = None
) -> tuple[advice.Advice, ...]:
    """Return warnings about data of lost libraries and about drivers that did not run. `sensors`
    are the scene's sensors, if the caller has already read them."""
    mounted = sensor_objects(scene) if sensors is None else sensors
    blocks = list(_scored_data(scene, mounted))
    return (*_lost_data(blocks), *_failed_drivers(blocks, set(mounted)))


def _lost_data(blocks: Iterable[ID]) -> Iterator[advice.Advice]:
    """Yield a warning for each lost library: its path, and the data that is missing."""
    lost: dict[str, list[str]] = {}
    for block in blocks:
        if block.is_missing:
            lost.setdefault(block.library.filepath, []).append(block.name)
    for path, names in lost.items():
        yield advice.Advice(None, MISSING, {"names": sorted(set(names)), "path": path})


def _scored_data(scene: Scene, sensors: Sequence[Object]) -> Iterator[ID]:
    """Yield the collections, objects and data blocks of the vehicle and of the sensors."""
    vehicle = scene.perception_entropy.vehicle
    waiting = [] if vehicle is None else [vehicle]
    objects = dict.fromkeys(sensors)
    visited = set(waiting)
    while waiting:
        collection = waiting.pop()
        yield collection
        for obj in collection.objects:
            objects[obj] = None
            inner = obj.instance_collection
            if inner is not None and inner not in visited:
                visited.add(inner)
                waiting.append(inner)
        waiting += [child for child in collection.children if child not in visited]
        visited.update(collection.children)
    for obj in objects:
        yield obj
        if obj.data is not None:
            yield obj.data


def _failed_drivers(blocks: Iterable[Any], sensors: Container[Object]) -> Iterator[advice.Advice]:
    """Yield a warning for each object with a driver that did not run."""
    for block in blocks:
        drivers = getattr(block.animation_data, "drivers", ()) if _animatable(block) else ()
        failed = sorted({d.data_path for d in drivers if not d.driver.is_valid})
        if failed:
            values = {"paths": failed, "is_allowed": not bpy.app.autoexec_fail}
            subject, part = (block.name, None) if block in sensors else (None, block.name)
            yield advice.Advice(subject, DRIVER, values, part)


def _animatable(block: ID) -> bool:
    return getattr(block, "animation_data", None) is not None


def _units(scene: Scene) -> Iterator[advice.Advice]:
    units = scene.unit_settings
    if units.system == "IMPERIAL" or abs(units.scale_length - 1.0) > 1e-6:
        yield advice.Advice(None, UNITS, fix="metric_units")


def _hidden_vehicle(scene: Scene) -> Iterator[advice.Advice]:
    """Yield warnings about collections of the vehicle that are excluded or hidden."""
    vehicle = scene.perception_entropy.vehicle
    layer = view_layer_of(scene)
    if vehicle is None:
        return
    layers = layers_of(layer.layer_collection, vehicle)
    if not layers:
        values = {"collection": vehicle.name, "how": "not in this scene", "is_whole": True}
        yield advice.Advice(None, HIDDEN, values)
    elif how := hidden_how(layers[0]):
        values = {"collection": vehicle.name, "how": how, "is_whole": True}
        yield advice.Advice(None, HIDDEN, values, fix="show_vehicle")
    else:
        hidden = {child.collection: hidden_how(child) for child in _hidden_children(layers[0])}
        for collection in instanced_collections(visible_members(vehicle, layer)):
            hidden |= dict.fromkeys(_hidden_inside(collection), IN_RENDERS)
        for child, how in hidden.items():
            values = {"collection": child.name, "how": how, "is_whole": False}
            yield advice.Advice(None, HIDDEN, values)


def _hidden_children(layer: LayerCollection) -> Iterator[LayerCollection]:
    """Yield the outermost hidden collections inside a collection that hold a mesh."""
    for child in layer.children:
        if not hidden_how(child):
            yield from _hidden_children(child)
        elif any(obj.type == "MESH" for obj in child.collection.all_objects):
            yield child


def _hidden_inside(collection: Collection) -> Iterator[Collection]:
    """Yield the outermost collections of an instanced one that renders do not show, with a mesh."""
    if not collection.hide_render:
        for child in collection.children:
            yield from _hidden_inside(child)
    elif any(obj.type == "MESH" for obj in collection.all_objects):
        yield collection


def _instanced(scene: Scene) -> Iterator[advice.Advice]:
    """Yield a warning for each instanced collection with sensors: an instance cannot be placed."""
    layer = view_layer_of(scene)
    names: dict[Collection, set[str]] = {}
    for obj in scene.objects:
        collection = instanced_by(obj)
        if collection is not None and obj.visible_get(view_layer=layer):
            members = instanced_members(collection, rendered=False)
            names[collection] = {o.name for o in members if o.perception_entropy.is_sensor}
    for collection, found in names.items():
        if found:
            values = {"names": sorted(found), "collection": collection.name}
            yield advice.Advice(None, INSTANCED, values)


def _refused(scene: Scene, sensors: Sequence[Object]) -> Iterator[advice.Advice]:
    """Yield a warning for each sensor that cannot be scored."""
    layer = view_layer_of(scene)
    for obj in sensors:
        if layer.depsgraph is None or not obj.visible_get(view_layer=layer):
            continue
        try:
            sensor_from_object(obj, layer.depsgraph)
        except pe.InputError as error:
            field = error.field.rpartition(": ")[2]
            values = {"field": field, "found": error.found, "expected": error.expected}
            fix = "apply_scale" if field == "scale" else None
            yield advice.Advice(obj.name, REFUSED, values, fix=fix)


def check_placeable(scene: Scene, study: pe.Study) -> None:
    """Check that a search can place the sensors. `InputError` when no axis of the study's sensors
    is free, or an animation, a driver or a constraint holds one that is moved: the placement would
    be lost at the next frame. When one that is to move on a mount is locked."""
    mounting = study.search.mounting
    sensors = [scene.objects[sensor.name] for sensor in study.rig]
    followers = followers_of(mounting.pairs, mounting.groups)
    leading = [obj for obj in sensors if obj.name not in followers]
    free = [obj for obj in leading if free_axes(obj) or obj.name in mounting.on]
    if not free:
        expected = "X, Y, Z, Roll, Pitch or Yaw ticked of at least one sensor (panel Sensor)"
        raise pe.InputError("scene", "what the search may change", expected, "nothing")
    for obj in leading:
        _check_locks(obj, mounting)
    for obj in (*free, *(scene.objects[name] for name in sorted(followers))):
        for holder in holders(obj):
            expected = "an object that can be placed"
            raise pe.InputError("scene", f"sensor {obj.name!r}: placement", expected, holder)


def _check_locks(obj: Object, mounting: pe.Mounting) -> None:
    """Raise `InputError` for a lock that a mount would ignore; angles on a surface are exempt."""
    mount = mounting.mount_of(obj.name)
    locked = locked_axes(obj)
    if isinstance(mount, pe.SurfaceMount):
        locked = tuple(axis for axis in locked if axis in "xyz")
    if mount is not None and locked:
        expected = "no lock of what its mount moves (bounds are kept to)"
        found = f"a lock of {', '.join(AXIS_LABELS[axis] for axis in locked)}"
        raise pe.InputError("scene", f"sensor {obj.name!r}", expected, found)
