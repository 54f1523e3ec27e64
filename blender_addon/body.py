"""The vehicle as the engine knows it: read when it changes, and kept until then.

Reading takes a tenth of a second for half a million triangles: too long for each move of the mouse.
What is told of a change comes from Blender's own updates, moved vertices included.
"""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Hashable
from typing import NamedTuple

import bpy
from bpy.app.handlers import persistent

from . import bridge, simple_bodies
from .engine import pe


class Body(NamedTuple):
    """A vehicle, or None where there is none that can be scored; `key` tells it from others."""

    vehicle: pe.Vehicle | None
    key: Hashable


NOTHING = Body(None, None)


class BodyCache:
    """Remembers vehicles by plain values; never a Blender object."""

    def __init__(self) -> None:
        self._version = 0
        self._bodies: dict[str, Body] = {}
        self._shapes: dict[Hashable, str] = {}

    @property
    def version(self) -> int:
        """Rises whenever a vehicle may have changed."""
        return self._version

    def changed(self) -> None:
        """Note that a vehicle's objects are not what they were."""
        self._version += 1

    def clear(self) -> None:
        """Forget everything, as another file is about to be shown."""
        self._bodies.clear()
        self._shapes.clear()
        self._version += 1

    def read(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Body:
        """Return the scene's vehicle; read it only when it may be another than before."""
        collection = scene.perception_entropy.vehicle
        members = () if collection is None else members_of(collection, depsgraph)
        of = "" if collection is None else collection.name_full
        clearance = bridge.clearance_of(scene)
        key = (scene.name, of, self._version, members, clearance)
        known = self._bodies.get(scene.name, NOTHING)
        if key != known.key:
            vehicle = None
            if members:
                # A score says what is wrong with a vehicle; here it is as if there were none.
                with contextlib.suppress(pe.InputError):
                    vehicle = bridge.vehicle_from_collection(collection, depsgraph, clearance)
            self._bodies = {name: b for name, b in self._bodies.items() if name in bpy.data.scenes}
            known = self._bodies[scene.name] = Body(vehicle, key)
        return known

    def shape(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> str:
        """Return a text that is another one for a vehicle that is not the same to the bit."""
        body = self.read(scene, depsgraph)
        if body.vehicle is None:
            return ""
        if body.key not in self._shapes:
            current = {each.key for each in self._bodies.values()}
            self._shapes = {key: text for key, text in self._shapes.items() if key in current}
            self._shapes[body.key] = shape_of(body.vehicle)
        return self._shapes[body.key]


def shape_of(vehicle: pe.Vehicle) -> str:
    """Return a digest of a vehicle: its triangles, its parts and their names."""
    digest = hashlib.blake2b(digest_size=16)
    digest.update(vehicle.triangles)
    digest.update(vehicle.parts)
    digest.update(repr((vehicle.part_names, vehicle.glass)).encode())
    return digest.hexdigest()


shared = BodyCache()
"""The vehicles of the scenes that are looked at."""


def members_of(
    collection: bpy.types.Collection, depsgraph: bpy.types.Depsgraph
) -> tuple[tuple[str, bool], ...]:
    """Names of the objects of the vehicle that count, and whether cameras see through them."""
    members = bridge.visible_members(collection, depsgraph.view_layer)
    counted = (each for each in members if not bridge.mounted_on_sensor(each))
    return tuple(sorted((each.name_full, each.perception_entropy.see_through) for each in counted))


def touched(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an update moved or reshaped an object of the vehicle."""
    changed = {
        update.id.original
        for update in depsgraph.updates
        if isinstance(update.id, bpy.types.Object)
        and (update.is_updated_geometry or update.is_updated_transform)
    }
    collection = scene.perception_entropy.vehicle
    if collection is None or not changed:
        return False
    parts = {each for each in changed if not bridge.mounted_on_sensor(each)}
    return not parts.isdisjoint(_with_instanced(collection))


def _with_instanced(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Objects of a collection, and of those that it holds instances of."""
    found: set[bpy.types.Object] = set()
    waiting, known = [collection], {collection}
    while waiting:
        members = set(waiting.pop().all_objects)
        found |= members
        inner = {each.instance_collection for each in members} - known - {None}
        waiting += inner
        known |= inner
    return found


@persistent
def note_changes(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: remember when it was the vehicle's."""
    if touched(scene, depsgraph):
        shared.changed()


@persistent
def note_undo(*_: object) -> None:
    """After a step back or forth: any object may be another one."""
    shared.changed()


@persistent
def forget(*_: object) -> None:
    """Before another file comes: nothing of this one may be kept."""
    shared.clear()
    simple_bodies.shared.clear()


def _handlers() -> tuple[tuple[list, object], ...]:
    lists = bpy.app.handlers
    return (
        (lists.depsgraph_update_post, note_changes),
        (lists.frame_change_post, note_changes),
        (lists.undo_post, note_undo),
        (lists.redo_post, note_undo),
        (lists.load_pre, forget),
        (lists.load_post, forget),
    )


def register() -> None:
    """Start listening."""
    for handlers, function in _handlers():
        handlers.append(function)


def unregister() -> None:
    """Stop listening, and forget the vehicle."""
    for handlers, function in reversed(_handlers()):
        handlers.remove(function)
    shared.clear()
