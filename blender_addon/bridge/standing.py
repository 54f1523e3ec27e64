"""A variant put into the scene: each sensor exactly where it stood, and none besides."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from .newcomers import SENSORS
from .own_curves import put_curve
from .parking import park, parked, unpark
from .records import Record
from .rig import place_poses, sensor_objects, view_layer_of


def stand(scene: bpy.types.Scene, records: Sequence[Record]) -> dict[str, str]:
    """Have the scene hold these sensors: lacking ones are made, others set aside.

    Returns
    -------
    dict
        The name of each sensor's object by its record's: another one where something else in the
        file has that name.

    Raises
    ------
    InputError
        When a constraint, a driver or an animation holds a sensor where it is.
    """
    wanted = {record.name: record for record in records}
    present = {obj.name: obj for obj in sensor_objects(scene)}
    for name in present.keys() - wanted.keys():
        park(scene, present[name])
    aside = parked(scene)
    objects = {}
    for name, record in wanted.items():
        if name in aside:
            unpark(scene, aside[name])
        obj = present.get(name) or aside.get(name) or _made(scene, record)
        _dress(obj, record)
        objects[name] = obj
    for name, record in wanted.items():
        other = objects.get(record.mirror_of)
        objects[name].perception_entropy.mirror_of = "" if other is None else other.name
    _place(scene, records, objects)
    return {name: obj.name for name, obj in objects.items()}


def sensors_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the scene's collection of sensors; make it if there is none."""
    for child in scene.collection.children_recursive:
        if child.name.partition(".")[0] == SENSORS:  # of a second scene: "Sensors.001"
            return child
    made = bpy.data.collections.new(SENSORS)
    scene.collection.children.link(made)
    return made


def shown_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the collection of sensors, or the scene's own where that one is out of the view."""
    wanted = sensors_collection(scene)
    waiting = [view_layer_of(scene).layer_collection]
    while waiting:
        layer = waiting.pop()
        if layer.collection == wanted and not layer.exclude:
            return wanted
        waiting += layer.children
    return scene.collection


def _made(scene: bpy.types.Scene, record: Record) -> bpy.types.Object:
    obj = bpy.data.objects.new(record.name, None)
    shown_collection(scene).objects.link(obj)
    obj.empty_display_type, obj.empty_display_size = record.display, record.size_m
    return obj


def _dress(obj: bpy.types.Object, record: Record) -> None:
    """Give an object all of a record but its place."""
    own = obj.perception_entropy
    if own.model != record.model:
        own.model = record.model
    if own.fusion != record.fusion:
        own.fusion = record.fusion
    put_curve(own, record.curve)
    own.free, own.bounded = record.free, record.bounded
    own.bounds_low, own.bounds_high = record.low, record.high
    own.rack = record.rack
    if own.mount != record.mount:
        own.mount = record.mount
    if not own.is_sensor:
        own.is_sensor = True


def _place(
    scene: bpy.types.Scene, records: Sequence[Record], objects: dict[str, bpy.types.Object]
) -> None:
    """Place all sensors, then hide those that are hidden: Blender does not work those out."""
    layer = view_layer_of(scene)
    for record in records:
        _show(layer, objects[record.name])
    place_poses(scene, {objects[record.name].name: record.pose for record in records})
    for record in records:
        if not record.visible:
            objects[record.name].hide_set(True, view_layer=layer)


def _show(layer: bpy.types.ViewLayer, obj: bpy.types.Object) -> None:
    """Have an object seen, whatever hid it of itself."""
    obj.hide_viewport = False
    if obj.name in layer.objects:
        obj.hide_set(False, view_layer=layer)
