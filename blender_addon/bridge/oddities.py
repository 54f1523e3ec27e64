"""What is odd about a scene itself, before any engine looks: missing pieces, units, scales."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

import bpy

from ..engine import pe
from .rig import sensor_from_object, sensor_objects, view_layer_of
from .vehicle import hidden_how, layers_of

MISSING, DRIVER, UNITS, REFUSED = "missing", "driver", "units", "refused"
HIDDEN = "hidden_vehicle"
"""Codes of the advice, beside those of the engine."""


def scene_advice(scene: bpy.types.Scene) -> tuple[pe.Advice, ...]:
    """Tell what is odd: pieces that are missing, units, and sensors that are no possible ones."""
    sensors = sensor_objects(scene)
    own = (*missing_pieces(scene, sensors), *_units(scene), *_hidden_vehicle(scene))
    return (*own, *_refused(scene, sensors))


def missing_pieces(
    scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object] | None = None
) -> tuple[pe.Advice, ...]:
    """Name what a score of the scene lacks: data of lost libraries, drivers that did not run.

    `sensors` are the scene's when they have been looked for already.
    """
    mounted = sensor_objects(scene) if sensors is None else sensors
    blocks = list(_scored_data(scene, mounted))
    return (*_lost_data(blocks), *_failed_drivers(blocks, set(mounted)))


def _lost_data(blocks: Iterable[bpy.types.ID]) -> Iterator[pe.Advice]:
    """One piece of advice for each library: its name, and what the vehicle lacks of it."""
    lost: dict[str, list[str]] = {}
    for block in blocks:
        if block.is_missing:
            lost.setdefault(block.library.filepath, []).append(block.name)
    for path, names in lost.items():
        what = ", ".join(sorted(set(names)))
        yield pe.Advice(None, MISSING, f"{what} is missing: there is no {path}")


def _scored_data(
    scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object]
) -> Iterator[bpy.types.ID]:
    """Collections, objects and their data that the vehicle and the sensors are made of."""
    vehicle = scene.perception_entropy.vehicle
    waiting = [] if vehicle is None else [vehicle]
    objects = dict.fromkeys(sensors)
    known = set(waiting)
    while waiting:
        collection = waiting.pop()
        yield collection
        for obj in collection.objects:
            objects[obj] = None
            inner = obj.instance_collection
            if inner is not None and inner not in known:
                known.add(inner)
                waiting.append(inner)
        waiting += [child for child in collection.children if child not in known]
        known.update(collection.children)
    for obj in objects:
        yield obj
        if obj.data is not None:
            yield obj.data


def _failed_drivers(
    blocks: Iterable[bpy.types.ID], sensors: Collection[bpy.types.Object]
) -> Iterator[pe.Advice]:
    """Advice on each object that a driver should move, change or show, and does not."""
    for block in blocks:
        drivers = getattr(block.animation_data, "drivers", ()) if _animatable(block) else ()
        failed = sorted({d.data_path for d in drivers if not d.driver.is_valid})
        if failed:
            why = "Python in drivers is not allowed in this file" if bpy.app.autoexec_fail else ""
            text = f"the driver of its {', '.join(failed)} did not run{': ' * bool(why)}{why}"
            if block in sensors:
                yield pe.Advice(block.name, DRIVER, text)
            else:
                yield pe.Advice(None, DRIVER, f"{block.name}: {text}", part=block.name)


def _animatable(block: bpy.types.ID) -> bool:
    return getattr(block, "animation_data", None) is not None


def _units(scene: bpy.types.Scene) -> Iterator[pe.Advice]:
    units = scene.unit_settings
    if units.system == "IMPERIAL" or abs(units.scale_length - 1.0) > 1e-6:
        text = "one unit is not one metre in this scene: nothing can be scored"
        yield pe.Advice(None, UNITS, text, fix="metric_units")


def _hidden_vehicle(scene: bpy.types.Scene) -> Iterator[pe.Advice]:
    """Advice on collections of the vehicle that are excluded or hidden, and so do not count."""
    vehicle, layer = scene.perception_entropy.vehicle, view_layer_of(scene)
    if vehicle is None:
        return
    found = layers_of(layer.layer_collection, vehicle)
    if not found:
        text = (
            f"the vehicle collection {vehicle.name} is not in this scene: nothing of it is scored"
        )
        yield pe.Advice(None, HIDDEN, text)
    elif how := hidden_how(found[0]):
        text = f"the vehicle collection {vehicle.name} is {how}: nothing of it is scored"
        yield pe.Advice(None, HIDDEN, text, fix="show_vehicle")
    else:
        for child in _hidden_children(found[0]):
            text = f"the vehicle's collection {child.name} is {hidden_how(child)}: it is not scored"
            yield pe.Advice(None, HIDDEN, text)


def _hidden_children(layer: bpy.types.LayerCollection) -> Iterator[bpy.types.LayerCollection]:
    """Yield collections in one that are hidden, and hold something; not those in these."""
    for child in layer.children:
        if not hidden_how(child):
            yield from _hidden_children(child)
        elif any(obj.type == "MESH" for obj in child.collection.all_objects):
            yield child


def _refused(scene: bpy.types.Scene, sensors: Sequence[bpy.types.Object]) -> Iterator[pe.Advice]:
    """Advice on sensors that no score would take."""
    layer = view_layer_of(scene)
    for obj in sensors:
        if layer.depsgraph is None or not obj.visible_get(view_layer=layer):
            continue
        try:
            sensor_from_object(obj, layer.depsgraph)
        except pe.InputError as error:
            field = error.field.rpartition(": ")[2]
            text = f"its {field} is {error.found}; expected {error.expected}"
            fix = "apply_scale" if field == "scale" else None
            yield pe.Advice(obj.name, REFUSED, text, fix=fix)
