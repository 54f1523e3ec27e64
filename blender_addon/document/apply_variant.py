"""Apply a variant to the scene: exactly the variant's sensors, at the variant's poses.

Sensors that only other variants have become inactive: they are moved to a collection that is
excluded from the view layers, so Blender neither draws nor evaluates them, and no score includes
them. Their settings, housings and animations stay unchanged.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import bpy
from bpy.types import Collection, Object, Scene, ViewLayer

from ..engine import graphics
from .mirroring import SENSORS
from .rig import color_of, place_poses, sensor_objects, view_layer_of
from .sensor_records import SensorRecord, object_table
from .study_table import write_table

PARKED = "Sensors of Other Variants"
BETWEEN = "\n"
"""Separates names of collections in a stored text: no name contains it."""


def apply_records(scene: Scene, records: Sequence[SensorRecord]) -> dict[str, str]:
    """Make the scene hold exactly the sensors of the records.

    Missing sensors are created; the scene's other sensors become inactive.

    Returns
    -------
    dict
        Name of each sensor's object, by the name of its record. The names differ where another
        object in the file already has the record's name.

    `InputError` when a constraint, a driver or an animation holds a sensor where it is.
    """
    wanted = {record.name: record for record in records}
    present = {obj.name: obj for obj in sensor_objects(scene)}
    for name in present.keys() - wanted.keys():
        deactivate(scene, present[name])
    aside = inactive_sensors(scene)
    objects = {}
    for name, record in wanted.items():
        if name in aside:
            reactivate(scene, aside[name])
        obj = present.get(name) or aside.get(name) or _new_sensor(scene, record)
        _write_settings(obj, record)
        objects[name] = obj
    for name, record in wanted.items():
        other = objects.get(record.mirror_of)
        objects[name].perception_entropy.mirror_of = "" if other is None else other.name
    _place(scene, records, objects)
    return {name: obj.name for name, obj in objects.items()}


def own_collection(scene: Scene, name: str) -> Collection:
    """Return the scene's collection of a name; create it if it does not exist."""
    for child in scene.collection.children_recursive:
        if child.name.partition(".")[0] == name:  # of a second scene: "Sensors.001"
            return child
    made = bpy.data.collections.new(name)
    scene.collection.children.link(made)
    return made


def shown_collection(scene: Scene) -> Collection:
    """Return the collection of sensors, or the scene's root collection if it is excluded."""
    wanted = own_collection(scene, SENSORS)
    waiting = [view_layer_of(scene).layer_collection]
    while waiting:
        layer = waiting.pop()
        if layer.collection == wanted and not layer.exclude:
            return wanted
        waiting += layer.children
    return scene.collection


def _new_sensor(scene: Scene, record: SensorRecord) -> Object:
    obj = bpy.data.objects.new(record.name, None)
    shown_collection(scene).objects.link(obj)
    obj.empty_display_type = record.display
    obj.empty_display_size = record.size_m
    return obj


def _write_settings(obj: Object, record: SensorRecord) -> None:
    """Write a record to a sensor's object, without the pose."""
    settings = obj.perception_entropy
    color = color_of(obj)
    write_table(settings, object_table(replace(record, color=color)))
    if record.color not in (None, color):
        settings.color = graphics.rgb_of(record.color)
    if not settings.is_sensor:
        settings.is_sensor = True


def _place(scene: Scene, records: Sequence[SensorRecord], objects: dict[str, Object]) -> None:
    """Place all sensors, then hide the hidden ones: Blender does not evaluate hidden objects."""
    layer = view_layer_of(scene)
    for record in records:
        _show(layer, objects[record.name])
    place_poses(scene, {objects[record.name].name: record.pose for record in records})
    for record in records:
        if not record.visible:
            objects[record.name].hide_set(True, view_layer=layer)


def _show(layer: ViewLayer, obj: Object) -> None:
    """Make an object visible: clear all of its visibility switches."""
    obj.hide_viewport = False
    if obj.name in layer.objects:
        obj.hide_set(False, view_layer=layer)


def deactivate(scene: Scene, obj: Object) -> None:
    """Make a sensor and its child objects inactive; child sensors stay active."""
    aside = _aside(scene)
    for member in (obj, *_children(obj)):
        collections = [c for c in _collections(scene) if member.name in c.objects and c != aside]
        member.perception_entropy.parked_from = BETWEEN.join(c.name for c in collections)
        aside.objects.link(member)
        for collection in collections:
            collection.objects.unlink(member)
    obj.perception_entropy.is_sensor = False
    obj.perception_entropy.is_parked = True


def reactivate(scene: Scene, obj: Object) -> None:
    """Make an inactive sensor and its child objects active again."""
    aside = _aside(scene)
    for member in (obj, *_children(obj)):
        names = member.perception_entropy.parked_from.split(BETWEEN)
        collections = [c for c in _collections(scene) if c.name in names] or [scene.collection]
        for collection in collections:
            collection.objects.link(member)
        aside.objects.unlink(member)
        member.perception_entropy.parked_from = ""
    obj.perception_entropy.is_sensor = True
    obj.perception_entropy.is_parked = False


def inactive_sensors(scene: Scene) -> dict[str, Object]:
    """Return the inactive sensors of a scene, by name."""
    aside = _find(scene)
    objects = () if aside is None else aside.objects
    return {obj.name: obj for obj in objects if obj.perception_entropy.is_parked}


def _children(obj: Object) -> Iterator[Object]:
    """Yield all descendants of an object, without sensors and their descendants."""
    for child in obj.children:
        if not child.perception_entropy.is_sensor:
            yield child
            yield from _children(child)


def _collections(scene: Scene) -> list[Collection]:
    return [scene.collection, *scene.collection.children_recursive]


def _find(scene: Scene) -> Collection | None:
    """Return the scene's collection of inactive sensors; numbered in a second scene."""
    children = scene.collection.children
    return next((c for c in children if c.name.partition(".")[0] == PARKED), None)


def _aside(scene: Scene) -> Collection:
    """Return (or create) the collection of inactive sensors, excluded from every view layer."""
    collection = _find(scene)
    if collection is None:
        collection = bpy.data.collections.new(PARKED)
        scene.collection.children.link(collection)
    for layer in scene.view_layers:
        layer.layer_collection.children[collection.name].exclude = True
    return collection
