"""Named places of the vehicle as empties, which can be moved before a rig is put on them."""

import math
from collections.abc import Mapping

import bpy
import numpy as np
from mathutils import Matrix

from ..caches import vehicle_cache
from ..engine import geometry, pe
from .declared import Refused, operator

PLACES = "Named Places"
KEY = "pe_place"
"""The collection of the empties, and the property of an empty that is the place's name."""
SIZE_M = 0.12


def places_of(scene: bpy.types.Scene, vehicle: pe.Vehicle) -> Mapping[str, geometry.NamedPlace]:
    """Return the named places found on the vehicle, those with an empty where the empty is.

    An empty looks along its x axis. The way out of the body is z for a place on the roof, else x.
    """
    places = dict(geometry.named_places(vehicle))
    for obj in scene.objects:
        if (name := obj.get(KEY)) in places:
            matrix = obj.matrix_world
            ahead, up = (matrix.col[k].to_3d().normalized() for k in (0, 2))
            out = up if places[name].outward[2] > 0.0 else ahead
            x, y, z = np.round(matrix.translation, 4)
            a, b, c = np.round(out, 6)
            yaw_deg = round(math.degrees(math.atan2(ahead.y, ahead.x)), 3)
            places[name] = geometry.NamedPlace((x, y, z), (a, b, c), yaw_deg)
    return places


@operator("Named Places", mode="Places are shown in Object Mode")
def show_places(context: bpy.types.Context) -> str:
    """Show roof, mirrors, grille, bumpers and other named places as empties, or remove them.

    A rig that is added goes to where they were moved"""
    scene = context.scene
    shown = [obj for obj in scene.objects if obj.get(KEY)]
    for obj in shown:
        bpy.data.objects.remove(obj)
    collection = scene.collection.children.get(PLACES)
    if shown:
        if collection is not None and not collection.all_objects:
            bpy.data.collections.remove(collection)
        return f"Removed {len(shown)} named places"
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    if vehicle is None:
        raise Refused("There is no vehicle yet")
    if collection is None:
        collection = bpy.data.collections.new(PLACES)
        scene.collection.children.link(collection)
    places = geometry.named_places(vehicle)
    for name, place in places.items():
        obj = bpy.data.objects.new(name, None)
        obj[KEY] = name
        obj.empty_display_type = "ARROWS"
        obj.empty_display_size = SIZE_M
        turn = Matrix.Rotation(math.radians(place.yaw_deg), 4, "Z")
        obj.matrix_world = Matrix.Translation(place.point) @ turn
        collection.objects.link(obj)
    return f"{len(places)} named places"
