"""Parts of a vehicle as a .blend file: materials, meshes, a collection, saving."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
import skin as skinning
from curves import Array
from parts import Part
from surface import Solid, gradient

Place = tuple[float, float, float]
Loose = tuple[str, ...]

# Material: colour (linear RGB), metallic, roughness.
MATERIALS = {
    "paint": ((0.50, 0.57, 0.65), 0.10, 0.35),
    "accent": ((0.075, 0.125, 0.175), 0.10, 0.40),
    "glass": ((0.018, 0.022, 0.028), 0.0, 0.08),
    "trim": ((0.020, 0.021, 0.023), 0.0, 0.55),
    "tyre": ((0.012, 0.012, 0.013), 0.0, 0.85),
    "rim": ((0.50, 0.52, 0.54), 0.25, 0.40),
    "headlight": ((0.78, 0.86, 0.92), 0.0, 0.10),
    "taillight": ((0.45, 0.012, 0.016), 0.0, 0.20),
    "plate": ((0.80, 0.80, 0.78), 0.0, 0.50),
}
SHARP = np.radians(32)  # edges that fold more are drawn as creases


def make_materials() -> dict[str, bpy.types.Material]:
    """One Principled material per name, with the same colour in the viewport."""
    made = {}
    for name, (colour, metallic, roughness) in MATERIALS.items():
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        material.diffuse_color = (*colour, 1.0)
        material.metallic = metallic
        material.roughness = roughness
        shader = material.node_tree.nodes["Principled BSDF"].inputs
        shader["Base Color"].default_value = (*colour, 1.0)
        shader["Metallic"].default_value = metallic
        shader["Roughness"].default_value = roughness
        made[name] = material
    return made


def sizes(points: Array, triangles: Array) -> Array:
    """Twice the area vectors of triangles."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def make_mesh(name: str, part: Part, materials: dict[str, bpy.types.Material]) -> bpy.types.Mesh:
    """A clean Blender mesh with smooth faces and creases."""
    full = np.linalg.norm(sizes(part.points, part.triangles), axis=1) > 2e-8
    _, where = np.unique(np.round(part.points, 5) + 0.0, axis=0, return_inverse=True)
    corners = where.reshape(-1)[part.triangles]
    distinct = np.array([len(set(corner)) == 3 for corner in corners.tolist()])
    keep = full & distinct
    points, triangles = skinning.weld(part.points, part.triangles[keep])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    used = [part.materials[i] for i in np.flatnonzero(keep)]
    slots = list(dict.fromkeys(used))
    for slot in slots:
        mesh.materials.append(materials[slot])
    mesh.polygons.foreach_set("material_index", [slots.index(material) for material in used])
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=SHARP)
    return mesh


def fair_normals(mesh: bpy.types.Mesh, solid: Solid) -> None:
    """Shade skin with the true normals of the surface, seen from inside each face at its corner."""
    corner = np.array([loop.vertex_index for loop in mesh.loops])
    points = np.array([vertex.co for vertex in mesh.vertices])[corner].reshape(-1, 3, 3)
    inward = points.mean(axis=1, keepdims=True) - points
    inward *= 0.003 / np.linalg.norm(inward, axis=2, keepdims=True)  # 3 mm
    points = (points + inward).reshape(-1, 3)
    mirror = np.where(points[:, 1:2] < 0, [[1, -1, 1]], [[1, 1, 1]])
    fair = gradient(points * mirror, solid) * mirror
    fair /= np.linalg.norm(fair, axis=1)[:, None]
    normals = np.array([normal.vector for normal in mesh.corner_normals])
    facing = np.repeat([face.vector for face in mesh.polygon_normals], 3, axis=0)
    skin = (np.sum(fair * facing, axis=1) > 0.35) & (np.abs(solid(points)) < 5e-3)
    normals[skin] = fair[skin]
    mesh.normals_split_custom_set(normals.tolist())


def build(
    name: str, vehicle: dict[str, Part], wheels: dict[str, Place], solid: Solid, loose: Loose
) -> None:
    """A collection of that name in an empty scene with metric units.

    `wheels` says where the parts go that are made about their own centre; parts whose name
    starts with one of `loose` are no skin of the solid.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    units = bpy.context.scene.unit_settings
    units.system = "METRIC"
    units.scale_length = 1.0
    units.length_unit = "METERS"
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    materials = make_materials()
    for title, part in vehicle.items():
        mesh = make_mesh(title, part, materials)
        if not title.startswith(loose):
            fair_normals(mesh, solid)
        thing = bpy.data.objects.new(title, mesh)
        thing.location = wheels.get(title, (0.0, 0.0, 0.0))
        collection.objects.link(thing)


def main(description: str, default: Path, make: Callable[[], None]) -> None:
    """Read the arguments, build and save."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if bpy.app.binary_path and "--" not in sys.argv:
        arguments = []
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=Path, default=default, help="file to write")
    out = parser.parse_args(arguments).out.resolve()
    make()
    save(out)


def save(path: Path) -> None:
    """Write what is open to a file, without a backup beside it."""
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)
