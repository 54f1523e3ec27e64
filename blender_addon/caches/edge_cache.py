"""The edges of a scene's vehicle by name; what was measured on it is measured again only after a
change."""

import contextlib

import bpy

from .. import document
from ..engine import pe, studies, text
from . import vehicle_cache

_cached = text.RecentCache[studies.VehicleEdges]()


def edges(scene: bpy.types.Scene) -> studies.VehicleEdges:
    """Return the edges of a scene's vehicle, as it was read last: a window reads it after each
    change, without a window it is read here. An edge that the scene names wrongly is left out."""
    depsgraph = document.view_layer_of(scene).depsgraph
    if bpy.app.background:
        vehicle_cache.shared.read(scene, depsgraph)
    vehicle = vehicle_cache.shared.last_read(scene.name)
    named: tuple[pe.Edge, ...] = ()
    with contextlib.suppress(pe.InputError):  # a score reports what is wrong with it
        named = document.edges_of(scene, depsgraph)
    reference = None
    with contextlib.suppress(pe.InputError):
        reference = document.document_of(scene.perception_entropy, "reference").reference
    key = (vehicle, named, reference)
    return _cached.made(key, lambda: studies.VehicleEdges(vehicle, named, reference))
