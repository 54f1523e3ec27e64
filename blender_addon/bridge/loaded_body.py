"""A study's vehicle as meshes of a scene, to the bit, and areas of it as painted groups."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..engine import pe
from .vehicle import RESIDUAL, placed_points, residual_of

VEHICLE = "Vehicle"


def same_body(one: pe.Vehicle | None, other: pe.Vehicle | None) -> bool:
    """Whether two vehicles are alike to the bit: triangles, parts, their names and the glass."""
    if one is None or other is None:
        return one is other
    same = one.part_names == other.part_names and set(one.glass) == set(other.glass)
    same = same and np.array_equal(one.triangles, other.triangles)
    return same and np.array_equal(one.parts, other.parts)


def make_body(scene: bpy.types.Scene, vehicle: pe.Vehicle) -> bpy.types.Collection:
    """Return a new collection of the scene with an object a part of a vehicle."""
    made = bpy.data.collections.new(VEHICLE)
    scene.collection.children.link(made)
    for number, name in enumerate(vehicle.part_names):
        triangles = vehicle.triangles[vehicle.parts == number]
        if len(triangles):
            obj = bpy.data.objects.new(name, mesh_of(name, triangles))
            made.objects.link(obj)
            obj.perception_entropy.see_through = name in vehicle.glass
    return made


def mesh_of(name: str, triangles: np.ndarray) -> bpy.types.Mesh:
    """Return a mesh of triangles (F, 3, 3) [m], its corners joined where they are the same.

    Blender's points are in single precision: what that leaves out is kept in an attribute.
    """
    points, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = corner.reshape(-1, 3)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.astype(np.float32).tolist(), [], faces.tolist())
    left = points - points.astype(np.float32)
    if left.any():
        kept = mesh.attributes.new(RESIDUAL, "FLOAT_VECTOR", "POINT")
        kept.data.foreach_set("vector", left.astype(np.float32).reshape(-1))
    return mesh


def paint_area(objects: Sequence[bpy.types.Object], name: str, area: np.ndarray) -> None:
    """Paint the faces (F, 3, 3) of an area in a vertex group of a name, on meshes of a vehicle."""
    wanted = {corner.tobytes() for corner in np.ascontiguousarray(area.reshape(-1, 3) + 0.0)}
    for obj in objects:
        if obj.type != "MESH":
            continue
        ground_from_object = np.array(obj.matrix_world, dtype=float)
        points = np.empty(3 * len(obj.data.vertices), np.float32)
        obj.data.vertices.foreach_get("co", points)
        local = points.reshape(-1, 3).astype(float) + residual_of(obj.data)
        placed = placed_points(local, ground_from_object) + 0.0
        chosen = [n for n, point in enumerate(placed) if point.tobytes() in wanted]
        if chosen:
            obj.vertex_groups.new(name=name).add(chosen, 1.0, "REPLACE")
