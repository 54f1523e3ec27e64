"""Housings as Blender's meshes, one a model, shared by all sensors of it."""

from __future__ import annotations

import math

import bpy

from ..engine import catalog, kinds, pe
from .shapes import Surface, surface_of

KEY = "pe_housing"
"""A mesh's own property: the model whose housing it is."""
TURNED_AWAY = math.radians(200.0)
"""What looks around less than this has its back to something: no can with a window all round."""
CREASE = math.radians(30.0)
MATERIALS = {
    "PE housing": ((0.50, 0.52, 0.55), 0.4, 0.45),
    "PE trim": ((0.035, 0.037, 0.04), 0.0, 0.5),
    "PE window": ((0.012, 0.016, 0.03), 0.0, 0.08),
    "PE ahead": ((0.02, 0.42, 0.46), 0.0, 0.5),
}
"""Colour (linear RGB), metallic and roughness, in the order of `shapes`."""
TYPICAL = {
    "lidar": pe.Housing("cylinder", (0.1, 0.1, 0.09), (0.0, 0.0, 0.045), "typical size"),
    "visor": pe.Housing("box", (0.1, 0.13, 0.05), (0.05, 0.0, 0.025), "typical size"),
    "camera": pe.Housing("box", (0.045, 0.03, 0.03), (0.0225, 0.0, 0.0145), "typical size"),
}
"""For the library, where no size is known: to take hold of, never to be measured by."""


def known_housing(model: str) -> bpy.types.Mesh | None:
    """Return the mesh of a model's housing, None where no size of it is known."""
    return None if catalog.housing(model) is None else housing_mesh(model)


def housing_mesh(model: str) -> bpy.types.Mesh:
    """Return the mesh of a model's housing, of a typical one where no size of it is known.

    Raises
    ------
    InputError
        When there is no such model.
    """
    for mesh in bpy.data.meshes:
        if mesh.get(KEY) == model and mesh.library is None:
            return mesh
    mesh = mesh_of(f"{model} housing", surface_for(model))
    mesh[KEY] = model
    return mesh


def surface_for(model: str) -> Surface:
    """Return the surface of a model's housing in the sensor frame."""
    sensor = catalog.load(model)
    has_lens = kinds.kind_of(sensor).name == "camera"
    low, high = getattr(sensor, "horizontal_fov", (-math.pi, math.pi))
    typical = "camera" if has_lens else "lidar" if high - low > TURNED_AWAY else "visor"
    return surface_of(catalog.housing(model) or TYPICAL[typical], has_lens)


def mesh_of(name: str, surface: Surface) -> bpy.types.Mesh:
    """Return a surface as a mesh, smooth but for its creases."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(surface.points.tolist(), [], surface.faces)
    for material in MATERIALS:
        mesh.materials.append(material_named(material))
    mesh.polygons.foreach_set("material_index", surface.made_of)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=CREASE)
    return mesh


def material_named(name: str) -> bpy.types.Material:
    """Return one of the housings' materials, with the same colour in the solid view."""
    material = bpy.data.materials.get(name)
    if material is not None:
        return material
    colour, metallic, roughness = MATERIALS[name]
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    material.diffuse_color = (*colour, 1.0)
    material.metallic, material.roughness = metallic, roughness
    shader = material.node_tree.nodes["Principled BSDF"].inputs
    shader["Base Color"].default_value = (*colour, 1.0)
    shader["Metallic"].default_value, shader["Roughness"].default_value = metallic, roughness
    return material
