"""The vehicle as the engine has it: read again only after a change.

Reading takes a tenth of a second for half a million triangles: too long for each move of the mouse.
Changes are found in Blender's own updates, moved vertices included.
"""

import contextlib
import hashlib
from collections.abc import Hashable
from typing import NamedTuple

import bpy

from .. import document
from ..engine import pe


class CachedVehicle(NamedTuple):
    """A vehicle, or None where there is none that can be scored; `key` identifies it."""

    vehicle: pe.Vehicle | None
    key: Hashable


NO_VEHICLE = CachedVehicle(None, None)


class VehicleCache:
    """Vehicles by plain values; it never holds a Blender object."""

    def __init__(self) -> None:
        self._version = 0
        self._vehicles: dict[str, CachedVehicle] = {}
        self._digests: dict[Hashable, str] = {}

    @property
    def version(self) -> int:
        """A count that rises whenever a vehicle may have changed."""
        return self._version

    def invalidate(self, *_: object) -> None:
        """Invalidate the vehicles: their objects may have changed."""
        self._version += 1

    def clear(self, *_: object) -> None:
        """Drop everything: another file is opened."""
        self._vehicles.clear()
        self._digests.clear()
        self._version += 1

    def read(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> CachedVehicle:
        """Return the scene's vehicle; read it again only where it may have changed."""
        collection = scene.perception_entropy.vehicle
        members = () if collection is None else counted_members(collection, depsgraph)
        of = "" if collection is None else collection.name_full
        clearance = document.as_typed(scene.perception_entropy.clearance)
        motions = document.shown_motions(scene)
        key = (scene.name, of, self._version, members, clearance, motions)
        cached = self._vehicles.get(scene.name, NO_VEHICLE)
        if key != cached.key:
            vehicle = None
            if members:
                # A score reports what is wrong with a vehicle; here it is as if there were none.
                with contextlib.suppress(pe.InputError):
                    shown = document.vehicle_from_collection(collection, depsgraph, clearance)
                    vehicle = document.with_drawn(scene, shown)
            self._vehicles = {
                name: b for name, b in self._vehicles.items() if name in bpy.data.scenes
            }
            cached = self._vehicles[scene.name] = CachedVehicle(vehicle, key)
        return cached

    def last_read(self, scene_name: str) -> pe.Vehicle | None:
        """Return a scene's vehicle as it was read last; None where it was not."""
        return self._vehicles.get(scene_name, NO_VEHICLE).vehicle

    def digest(self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> str:
        """Return a digest of the scene's vehicle: another text where any bit of it differs."""
        cached = self.read(scene, depsgraph)
        if cached.vehicle is None:
            return ""
        if cached.key not in self._digests:
            current = {each.key for each in self._vehicles.values()}
            self._digests = {key: text for key, text in self._digests.items() if key in current}
            self._digests[cached.key] = vehicle_digest(cached.vehicle)
        return self._digests[cached.key]


def vehicle_digest(vehicle: pe.Vehicle) -> str:
    """Return a digest of a vehicle: its triangles, its parts and their names."""
    digest = hashlib.blake2b(digest_size=16)
    digest.update(vehicle.triangles.data)
    digest.update(vehicle.parts.data)
    covers = (dict(vehicle.covers),) if vehicle.covers else ()
    digest.update(repr((vehicle.part_names, vehicle.glass, *covers)).encode())
    return digest.hexdigest()


shared = VehicleCache()  # The one cache of the add-on


def counted_members(
    collection: bpy.types.Collection, depsgraph: bpy.types.Depsgraph
) -> tuple[tuple[str, bool, float], ...]:
    """Return the names of the vehicle's counted objects, if cameras see through, covers' losses."""
    visible = document.visible_members(collection, depsgraph.view_layer)
    counted = {each for each in visible if not document.mounted_on_sensor(each)}
    for collection in document.instanced_collections(counted):
        counted |= document.instanced_members(collection)
    own = ((each.name_full, each.perception_entropy) for each in counted)
    return tuple(sorted((name, each.see_through, each.cover_loss_db) for name, each in own))


def vehicle_updated(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
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
    parts = {each for each in changed if not document.mounted_on_sensor(each)}
    return not parts.isdisjoint(_objects_with_instances(collection))


def _objects_with_instances(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Objects of a collection, and of those that it holds instances of."""
    objects: set[bpy.types.Object] = set()
    waiting = [collection]
    seen = {collection}
    while waiting:
        members = set(waiting.pop().all_objects)
        objects |= members
        inner = {each.instance_collection for each in members} - seen - {None}
        waiting += inner
        seen |= inner
    return objects


def invalidate_if_updated(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: invalidate the vehicles where it was one of theirs."""
    if vehicle_updated(scene, depsgraph):
        shared.invalidate()
