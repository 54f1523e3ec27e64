"""The vehicle: the visible solid objects of a collection as triangles of named parts, and back."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import bpy
import numpy as np
from bpy.types import Collection, Depsgraph, LayerCollection, Mesh, Object, Scene, ViewLayer

from ..engine import geometry, pe
from .rig import mounted_on_sensor
from .study_table import as_typed

RESIDUAL = "pe_residual"
"""Mesh attribute with what single precision leaves out of the points of an imported vehicle."""
VEHICLE = "Vehicle"
IN_RENDERS = "hidden in renders"
SURROUNDINGS = "pe_surroundings"
"""Own property of the collection with what stands round the vehicle: never part of it."""


class VehiclePart(NamedTuple):
    """Triangles (F, 3, 3) [m] of one object, whether cameras see through, a cover's loss [dB]."""

    name: str
    triangles: np.ndarray
    glass: bool
    cover_db: float = 0.0


def vehicle_from_collection(
    collection: Collection, depsgraph: Depsgraph, clearance_m: float = pe.Vehicle.clearance
) -> pe.Vehicle:
    """Return the vehicle of a collection, with modifiers, parents and instances applied.

    Objects that are hidden in the viewport or in renders, or mounted on a sensor, are left out.
    `clearance_m` is how far a flush-mounted sensor counts as protruding from the surface [m].

    `InputError` when no solid object remains, or a coordinate is not finite.
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
    covers = {part.name: part.cover_db for part in parts if part.cover_db > 0.0}
    return pe.Vehicle(
        triangles, np.concatenate(labels), names, glass, clearance=clearance_m, covers=covers
    )


def visible_members(collection: Collection, layer: ViewLayer) -> set[Object]:
    """Return the visible objects of a collection and of its children, without surroundings."""
    if collection.hide_render or collection.get(SURROUNDINGS):
        return set()
    members = {
        obj
        for obj in collection.objects
        if obj.visible_get(view_layer=layer) and not obj.hide_render
    }
    return members.union(*(visible_members(child, layer) for child in collection.children))


def instanced_members(
    collection: Collection, *, rendered: bool = True, within: tuple[Collection, ...] = ()
) -> set[Object]:
    """Return the objects of an instanced collection, of its children, and of the collections that
    they instance in turn. `rendered`: only those that renders show, without surroundings. `within`:
    the collections that it is in, outermost first."""
    is_hidden = collection.hide_render or collection.get(SURROUNDINGS)
    if collection in within or (rendered and is_hidden):
        return set()
    members = {obj for obj in collection.objects if not (rendered and obj.hide_render)}
    inner = [*collection.children, *instanced_collections(members)]
    path = (*within, collection)
    return members.union(*(instanced_members(c, rendered=rendered, within=path) for c in inner))


def instanced_by(obj: Object) -> Collection | None:
    """Return the collection that an object is an instance of; None for other objects."""
    return obj.instance_collection if obj.instance_type == "COLLECTION" else None


def instanced_collections(objects: Iterable[Object]) -> list[Collection]:
    """Return the collections that objects are instances of, each once."""
    instanced = dict.fromkeys(map(instanced_by, objects))
    return [collection for collection in instanced if collection is not None]


def hidden_in_instance(obj: Object) -> set[Object]:
    """Return the objects of the collection that an object instances which renders do not show."""
    collection = instanced_by(obj)
    if collection is None:
        return set()
    return instanced_members(collection, rendered=False) - instanced_members(collection)


def in_surroundings(obj: Object) -> bool:
    """Whether an object belongs to the surroundings of the vehicle."""
    return any(each.get(SURROUNDINGS) for each in obj.users_collection)


def layers_of(layer: LayerCollection, collection: Collection) -> list[LayerCollection]:
    """Return a collection in a view layer and the collections it is in, innermost first. Empty
    where the view layer does not have the collection."""
    if layer.collection == collection:
        return [layer]
    for child in layer.children:
        if found := layers_of(child, collection):
            return [*found, layer]
    return []


def hidden_how(layer: LayerCollection) -> str:
    """Return a text that says how a collection is hidden; "" for a visible one."""
    if layer.exclude:
        return "excluded from the view layer"
    if layer.collection.hide_render:
        return IN_RENDERS
    return "" if layer.is_visible else "hidden in the viewport"


def drawn_meshes(
    collection: Collection, depsgraph: Depsgraph
) -> Iterator[tuple[Object, np.ndarray]]:
    """Yield every visible mesh and instance of a vehicle, evaluated, and its (4, 4) pose. An object
    is valid only until the next one is yielded: do not store references to it. The pose is ground
    from object."""
    visible = visible_members(collection, depsgraph.view_layer)
    members = {obj for obj in visible if not mounted_on_sensor(obj)}
    hidden_by_owner = {obj: hidden_in_instance(obj) for obj in members}
    # The iterator yields curves, texts and metaballs twice: as themselves and as a mesh.
    for instance in depsgraph.object_instances:
        owner = instance.parent if instance.is_instance else instance.object
        obj = instance.object
        if owner.original not in members or obj.type != "MESH" or obj.original.hide_render:
            continue
        if not (instance.is_instance and obj.original in hidden_by_owner[owner.original]):
            yield obj, np.array(instance.matrix_world, dtype=float)


def _parts(collection: Collection, depsgraph: Depsgraph) -> Iterator[VehiclePart]:
    """Yield a part for every drawn object and instance that belongs to the collection."""
    local: dict[int, np.ndarray] = {}
    for obj, ground_from_object in drawn_meshes(collection, depsgraph):
        original = obj.original
        triangles = _triangles_local(obj, local)
        if not len(triangles):
            continue
        if not (np.isfinite(triangles).all() and np.isfinite(ground_from_object).all()):
            field = f"vehicle object {original.name!r}"
            raise pe.InputError("scene", field, "finite coordinates", "NaN or infinity")
        placed = placed_triangles(triangles, ground_from_object)
        own = original.perception_entropy
        yield VehiclePart(original.name_full, placed, own.see_through, as_typed(own.cover_loss_db))


def _triangles_local(obj: Object, cache: dict[int, np.ndarray]) -> np.ndarray:
    """Return triangles (F, 3, 3) of an evaluated object in its own frame, cached by mesh."""
    key = obj.data.as_pointer()
    if key in cache:
        return cache[key]
    mesh = obj.to_mesh()
    cache[key] = triangles_of(mesh)
    obj.to_mesh_clear()
    return cache[key]


def triangles_of(mesh: Mesh) -> np.ndarray:
    """Return (F, 3, 3) triangles of a mesh in its own frame."""
    mesh.calc_loop_triangles()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return (points.reshape(-1, 3).astype(float) + residual_of(mesh))[corners.reshape(-1, 3)]


def residual_of(mesh: Mesh) -> np.ndarray:
    """Return the rounding errors (P, 3) of a mesh's single-precision points; else zeros."""
    attribute = mesh.attributes.get(RESIDUAL)
    residual = np.zeros(3 * len(mesh.vertices), np.float32)
    if (
        attribute is not None
        and attribute.domain == "POINT"
        and attribute.data_type == "FLOAT_VECTOR"
    ):
        attribute.data.foreach_get("vector", residual)
    return residual.reshape(-1, 3).astype(float)


def placed_triangles(triangles: np.ndarray, ground_from_object: np.ndarray) -> np.ndarray:
    """Return triangles in the ground frame; faces of a mirrored object still point outwards."""
    linear = ground_from_object[:3, :3]
    placed = placed_points(triangles, ground_from_object)
    return placed[:, ::-1] if np.linalg.det(linear) < 0.0 else placed


def placed_points(points: np.ndarray, ground_from_object: np.ndarray) -> np.ndarray:
    """Return points (..., 3) in the ground frame."""
    return geometry.rotate(ground_from_object[:3, :3], points) + ground_from_object[:3, 3]


def same_body(one: pe.Vehicle | None, other: pe.Vehicle | None) -> bool:
    """Return whether two vehicles are equal to the bit: triangles, parts, their names, glass."""
    if one is None or other is None:
        return one is other
    same = one.part_names == other.part_names and set(one.glass) == set(other.glass)
    same = same and dict(one.covers) == dict(other.covers)
    same = same and np.array_equal(one.triangles, other.triangles)
    return same and np.array_equal(one.parts, other.parts)


def make_body(scene: Scene, vehicle: pe.Vehicle) -> Collection:
    """Return a new collection of the scene with one object for each part of a vehicle."""
    made = bpy.data.collections.new(VEHICLE)
    scene.collection.children.link(made)
    for number, name in enumerate(vehicle.part_names):
        triangles = vehicle.triangles[vehicle.parts == number]
        if len(triangles):
            obj = bpy.data.objects.new(name, mesh_of(name, triangles))
            made.objects.link(obj)
            obj.perception_entropy.see_through = name in vehicle.glass
            obj.perception_entropy.cover_loss_db = vehicle.covers.get(name, 0.0)
    return made


def mesh_of(name: str, triangles: np.ndarray) -> Mesh:
    """Return a mesh of triangles (F, 3, 3) [m]; equal corners are merged. Blender's points have
    single precision: the rounding errors are stored in an attribute."""
    points, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = corner.reshape(-1, 3)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.astype(np.float32).tolist(), [], faces.tolist())
    left = points - points.astype(np.float32)
    if left.any():
        attribute = mesh.attributes.new(RESIDUAL, "FLOAT_VECTOR", "POINT")
        attribute.data.foreach_set("vector", left.astype(np.float32).reshape(-1))
    return mesh


def paint_area(objects: Sequence[Object], name: str, area: np.ndarray) -> bool:
    """Paint the faces (F, 3, 3) of an area in a vertex group on the meshes of a vehicle. Return
    False, with nothing painted, where a corner of it is no vertex of theirs."""
    found: dict[Object, list[int]] = {}
    seen = set[bytes]()
    wanted = {corner.tobytes() for corner in np.ascontiguousarray(area.reshape(-1, 3) + 0.0)}
    for obj in objects:
        if obj.type != "MESH":
            continue
        ground_from_object = np.array(obj.matrix_world, dtype=float)
        points = np.empty(3 * len(obj.data.vertices), np.float32)
        obj.data.vertices.foreach_get("co", points)
        local = points.reshape(-1, 3).astype(float) + residual_of(obj.data)
        placed = placed_points(local, ground_from_object) + 0.0
        found[obj] = [n for n, point in enumerate(placed) if point.tobytes() in wanted]
        seen |= {placed[n].tobytes() for n in found[obj]}
    if seen != wanted:
        return False
    for obj, vertices in found.items():
        if vertices:
            obj.vertex_groups.new(name=name).add(vertices, 1.0, "REPLACE")
    return True
