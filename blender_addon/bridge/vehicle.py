"""The vehicle: everything solid that can be seen in a collection, as triangles of named parts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import bpy
import numpy as np

from ..engine import geometry, pe
from .rig import mounted_on_sensor

RESIDUAL = "pe_residual"
"""Attribute of a mesh that came from a study: its points are in double precision there."""


class Part(NamedTuple):
    """Triangles (F, 3, 3) [m] of one object, and whether cameras see through them."""

    name: str
    triangles: np.ndarray
    glass: bool


def vehicle_from_collection(
    collection: bpy.types.Collection,
    depsgraph: bpy.types.Depsgraph,
    clearance_m: float = pe.Vehicle.clearance,
) -> pe.Vehicle:
    """Return a collection's objects as they are drawn: modifiers, parents, instances and all.

    What is hidden in the viewport or in renders does not count, nor what rides on a sensor. The
    clearance is how proud of the skin a flush-mounted sensor counts.

    Raises
    ------
    InputError
        When nothing solid is left, or a coordinate is no number.
    """
    parts = sorted(_parts(collection, depsgraph), key=lambda part: part.name)
    if not parts:
        layers = layers_of(depsgraph.view_layer.layer_collection, collection)
        how = hidden_how(layers[0]) if layers else ""
        found = f"none: it is {how}" if how else "none"
        field = f"vehicle collection {collection.name!r}"
        raise pe.InputError("scene", field, "visible meshes", found)
    names = list(dict.fromkeys(part.name for part in parts))
    labels = [np.full(len(part.triangles), names.index(part.name), np.int32) for part in parts]
    triangles = np.concatenate([part.triangles for part in parts])
    glass = list(dict.fromkeys(part.name for part in parts if part.glass))
    return pe.Vehicle(triangles, np.concatenate(labels), names, glass, clearance_m)


def visible_members(
    collection: bpy.types.Collection, layer: bpy.types.ViewLayer
) -> set[bpy.types.Object]:
    """Objects of a collection and those in it, without what is hidden in either way."""
    if collection.hide_render:
        return set()
    found = {
        obj
        for obj in collection.objects
        if obj.visible_get(view_layer=layer) and not obj.hide_render
    }
    return found.union(*(visible_members(child, layer) for child in collection.children))


def layers_of(
    layer: bpy.types.LayerCollection, collection: bpy.types.Collection
) -> list[bpy.types.LayerCollection]:
    """Return a collection in a view layer and those that it is in, from it upwards.

    Nothing where the view layer does not hold it.
    """
    if layer.collection == collection:
        return [layer]
    for child in layer.children:
        if found := layers_of(child, collection):
            return [*found, layer]
    return []


def hidden_how(layer: bpy.types.LayerCollection) -> str:
    """Say in which way a collection is out of the view; empty where it is in it."""
    if layer.exclude:
        return "excluded from the view layer"
    if layer.collection.hide_render:
        return "hidden in renders"
    return "" if layer.is_visible else "hidden in the viewport"


def drawn_meshes(
    collection: bpy.types.Collection, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, np.ndarray]]:
    """Yield every drawn mesh and instance that belongs to a vehicle, evaluated, and where it is.

    An object is only good until the next one: nothing of it may be kept. The places are (4, 4),
    ground from object.
    """
    visible = visible_members(collection, depsgraph.view_layer)
    members = {obj for obj in visible if not mounted_on_sensor(obj)}
    # Curves, texts and metaballs come twice, as what they are and as the mesh they make.
    for instance in depsgraph.object_instances:
        owner = instance.parent if instance.is_instance else instance.object
        obj = instance.object
        hidden = obj.original.hide_render
        if owner.original in members and obj.type == "MESH" and not hidden:
            yield obj, np.array(instance.matrix_world, dtype=float)


def _parts(collection: bpy.types.Collection, depsgraph: bpy.types.Depsgraph) -> Iterator[Part]:
    """Yield a part for every drawn object and instance that belongs to the collection."""
    local: dict[int, np.ndarray] = {}
    for obj, ground_from_object in drawn_meshes(collection, depsgraph):
        original, triangles = obj.original, _triangles_local(obj, local)
        if not len(triangles):
            continue
        if not (np.isfinite(triangles).all() and np.isfinite(ground_from_object).all()):
            field = f"vehicle object {original.name!r}"
            raise pe.InputError("scene", field, "finite coordinates", "NaN or infinity")
        placed = placed_triangles(triangles, ground_from_object)
        yield Part(original.name_full, placed, original.perception_entropy.see_through)


def _triangles_local(obj: bpy.types.Object, known: dict[int, np.ndarray]) -> np.ndarray:
    """(F, 3, 3) triangles of an evaluated object in its own frame, read once a mesh."""
    key = obj.data.as_pointer()
    if key in known:
        return known[key]
    mesh = obj.to_mesh()
    known[key] = triangles_of(mesh)
    obj.to_mesh_clear()
    return known[key]


def triangles_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Return (F, 3, 3) triangles of a mesh in its own frame."""
    mesh.calc_loop_triangles()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return (points.reshape(-1, 3).astype(float) + residual_of(mesh))[corners.reshape(-1, 3)]


def residual_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """Return what single precision leaves out of a mesh's points (P, 3), where that is kept."""
    kept = mesh.attributes.get(RESIDUAL)
    found = np.zeros(3 * len(mesh.vertices), np.float32)
    if kept is not None and kept.domain == "POINT" and kept.data_type == "FLOAT_VECTOR":
        kept.data.foreach_get("vector", found)
    return found.reshape(-1, 3).astype(float)


def placed_triangles(triangles: np.ndarray, ground_from_object: np.ndarray) -> np.ndarray:
    """Return triangles in the ground frame; a mirrored object keeps its faces looking outwards."""
    linear = ground_from_object[:3, :3]
    placed = placed_points(triangles, ground_from_object)
    return placed[:, ::-1] if np.linalg.det(linear) < 0.0 else placed


def placed_points(points: np.ndarray, ground_from_object: np.ndarray) -> np.ndarray:
    """Return points (..., 3) in the ground frame."""
    return geometry.rotate(ground_from_object[:3, :3], points) + ground_from_object[:3, 3]
