"""Edges of the vehicle that a scene names: objects whose vertices are points of an edge."""

from collections.abc import Iterator, Sequence

import bpy
import numpy as np
from bpy.types import Depsgraph, Object, Scene

from ..engine import pe, search
from .apply_variant import own_collection
from .vehicle import placed_points

NAMED_EDGES = "Named Edges"


def edge_objects(scene: Scene) -> list[Object]:
    """Return the objects that are edges, by name; of several with one name the first."""
    named: dict[str, Object] = {}
    for obj in sorted(scene.objects, key=lambda obj: obj.name):
        if name := obj.perception_entropy.edge_name:
            named.setdefault(name, obj)
    return [named[name] for name in sorted(named)]


def edges_of(scene: Scene, depsgraph: Depsgraph) -> tuple[pe.Edge, ...]:
    """Return the edges that a scene names. `InputError` when one has no extent, or the name of one
    that every vehicle has."""
    try:
        return tuple(_edge(obj, depsgraph) for obj in edge_objects(scene))
    except pe.InputError as error:
        raise error.within("scene") from None


def add_edge(scene: Scene, edge: pe.Edge) -> Object:
    """Add an edge to a scene: a line that is drawn in front of the vehicle and not rendered."""
    ordered = sorted(edge.points, key=lambda point: point[edge.along])
    mesh = bpy.data.meshes.new(edge.name)
    mesh.from_pydata(ordered, [(k, k + 1) for k in range(len(ordered) - 1)], [])
    obj = bpy.data.objects.new(edge.name, mesh)
    obj.display_type = "WIRE"
    obj.show_in_front = True
    obj.show_name = True
    obj.hide_render = True
    obj.perception_entropy.edge_name = edge.name
    own_collection(scene, NAMED_EDGES).objects.link(obj)
    return obj


def write_edges(scene: Scene, edges: Sequence[pe.Edge]) -> None:
    """Make a scene have exactly these edges."""
    for obj in list(scene.objects):
        if not obj.perception_entropy.edge_name:
            continue
        if any(each.name == NAMED_EDGES for each in obj.users_collection):
            bpy.data.objects.remove(obj)
        else:
            obj.perception_entropy.edge_name = ""
    for edge in edges:
        add_edge(scene, edge)


def _edge(obj: Object, depsgraph: Depsgraph) -> pe.Edge:
    points = np.concatenate(list(_points(obj, depsgraph)))
    return pe.Edge(obj.perception_entropy.edge_name, points.tolist())


def _points(obj: Object, depsgraph: Depsgraph) -> Iterator[np.ndarray]:
    """Yield the vertices (N, 3) of a mesh or a curve in the ground frame [m]."""
    evaluated = obj.evaluated_get(depsgraph)
    yield np.empty((0, 3))
    if obj.type in ("MESH", "CURVE"):
        mesh = evaluated.to_mesh()
        local = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", local)
        matrix = np.array(evaluated.matrix_world, dtype=float)
        placed = placed_points(local.reshape(-1, 3).astype(float), matrix)
        evaluated.to_mesh_clear()
        yield np.round(placed, search.POSITION_DECIMALS) + 0.0
