"""Sensors that another variant has: set aside with all that hangs on them, not thrown away.

They lie in a collection that is left out of the view: not drawn, not worked out, not scored. Their
own settings, housings and animations stay as they are.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

PARKED = "Sensors of Other Variants"
BETWEEN = "\n"
"""Between names of collections: no name holds it."""


def park(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    """Set a sensor aside, and what hangs on it; a sensor mounted on it stays."""
    aside = _aside(scene)
    for each in (obj, *_hanging_on(obj)):
        own = [c for c in _collections(scene) if each.name in c.objects and c != aside]
        each.perception_entropy.parked_from = BETWEEN.join(c.name for c in own)
        aside.objects.link(each)
        for collection in own:
            collection.objects.unlink(each)
    obj.perception_entropy.is_sensor, obj.perception_entropy.is_parked = False, True


def unpark(scene: bpy.types.Scene, obj: bpy.types.Object) -> None:
    """Bring a sensor back that was set aside, with what hangs on it."""
    aside = _aside(scene)
    for each in (obj, *_hanging_on(obj)):
        names = each.perception_entropy.parked_from.split(BETWEEN)
        own = [c for c in _collections(scene) if c.name in names] or [scene.collection]
        for collection in own:
            collection.objects.link(each)
        aside.objects.unlink(each)
        each.perception_entropy.parked_from = ""
    obj.perception_entropy.is_sensor, obj.perception_entropy.is_parked = True, False


def parked(scene: bpy.types.Scene) -> dict[str, bpy.types.Object]:
    """Sensors of the scene that were set aside, by name."""
    aside = _find(scene)
    objects = () if aside is None else aside.objects
    return {each.name: each for each in objects if each.perception_entropy.is_parked}


def _hanging_on(obj: bpy.types.Object) -> Iterator[bpy.types.Object]:
    """All below an object in its tree, but sensors and what hangs on those."""
    for child in obj.children:
        if not child.perception_entropy.is_sensor:
            yield child
            yield from _hanging_on(child)


def _collections(scene: bpy.types.Scene) -> list[bpy.types.Collection]:
    return [scene.collection, *scene.collection.children_recursive]


def _find(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The collection of this scene: another scene's has a number behind its name."""
    children = scene.collection.children
    return next((c for c in children if c.name.partition(".")[0] == PARKED), None)


def _aside(scene: bpy.types.Scene) -> bpy.types.Collection:
    """The collection, made when there is none, and left out of every view."""
    found = _find(scene)
    if found is None:
        found = bpy.data.collections.new(PARKED)
        scene.collection.children.link(found)
    for layer in scene.view_layers:
        layer.layer_collection.children[found.name].exclude = True
    return found
