"""Faces of the vehicle that a mount is made of: what was painted, or has a material."""

from __future__ import annotations

import bpy
import numpy as np

from ..choices import BY_GROUP, BY_MATERIAL
from ..engine import pe
from .vehicle import drawn_meshes, placed_triangles, triangles_of

PAINTED = 0.5
"""A corner counts as painted when it weighs more than this."""


def painted_area(
    vehicle: bpy.types.Collection,
    depsgraph: bpy.types.Depsgraph,
    mount: bpy.types.PropertyGroup,
) -> np.ndarray:
    """Return a mount's faces (F, 3, 3) [m], as they are drawn: modifiers, parents and instances.

    They are triangles of the vehicle as the engine knows it, to the bit; none where none is
    painted, or has the material.
    """
    found = []
    for obj, ground_from_object in drawn_meshes(vehicle, depsgraph):
        if not _may_have(obj, mount):
            continue
        mesh = obj.to_mesh()
        chosen = _chosen(obj, mesh, mount)
        triangles = placed_triangles(triangles_of(mesh)[chosen], ground_from_object)
        found.append((obj.original.name_full, triangles))
        obj.to_mesh_clear()
    found.sort(key=lambda pair: pair[0])
    return np.concatenate([each for _, each in found]) if found else np.empty((0, 3, 3))


def _may_have(obj: bpy.types.Object, mount: bpy.types.PropertyGroup) -> bool:
    """Whether an evaluated object knows the group or the material at all."""
    if mount.faces == BY_GROUP:
        return mount.group in obj.vertex_groups
    return mount.faces == BY_MATERIAL and bool(_slots_of(obj, mount.material))


def _chosen(
    obj: bpy.types.Object, mesh: bpy.types.Mesh, mount: bpy.types.PropertyGroup
) -> np.ndarray:
    """(F,) which triangles of a mesh belong to the mount."""
    count = len(mesh.loop_triangles) if mesh.loop_triangles else _triangulated(mesh)
    if mount.faces == BY_MATERIAL:
        index = np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("material_index", index)
        return np.isin(index, _slots_of(obj, mount.material))
    corners = np.empty(3 * count, np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return _painted(mesh, obj.vertex_groups[mount.group].index)[corners.reshape(-1, 3)].all(axis=1)


def _painted(mesh: bpy.types.Mesh, group: int) -> np.ndarray:
    """(P,) which vertices weigh more than a half in a group."""
    weights = (
        any(each.group == group and each.weight > PAINTED for each in vertex.groups)
        for vertex in mesh.vertices
    )
    return np.fromiter(weights, bool, len(mesh.vertices))


def _triangulated(mesh: bpy.types.Mesh) -> int:
    mesh.calc_loop_triangles()
    return len(mesh.loop_triangles)


def _slots_of(obj: bpy.types.Object, material: bpy.types.Material | None) -> list[int]:
    """Places of a material among an object's slots."""
    slots = (slot.material for slot in obj.material_slots)
    return [n for n, each in enumerate(slots) if each is not None and each.original == material]


def area_problem(mount: bpy.types.PropertyGroup) -> pe.InputError:
    """Return the error of a surface that has no faces."""
    if mount.faces == BY_GROUP:
        expected = "faces of the vehicle that are painted in it, with weights above 0.5"
        return _of_mount(mount, f"vertex group {mount.group!r}", expected)
    if mount.material is None:
        return _of_mount(mount, "material", "a material of the vehicle", found="none chosen")
    return _of_mount(mount, f"material {mount.material.name!r}", "faces of the vehicle with it")


def _of_mount(
    mount: bpy.types.PropertyGroup, field: str, expected: str, found: str = "none"
) -> pe.InputError:
    return pe.InputError("scene", f"mount {mount.name!r}: {field}", expected, found)
