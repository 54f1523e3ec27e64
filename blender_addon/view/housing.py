"""Sensors with a body: a mesh of the housing's true size as the sensor object's own data.

The mesh is the sensor's, not an object beside it: it is selected, copied, hidden and deleted with
the sensor, and a sensor never occludes its own beams. Surfaces are made as plain arrays first.
Outer sizes are the housing's; windows and lenses are where they usually are.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import bpy
import numpy as np

from ..caches import sensor_cache
from ..engine import Floats, catalog, pe
from ..sensor_kinds import row_of

BODY, TRIM, GLASS, MARK = range(4)
"""What a face is made of."""
CIRCLE_POINTS = 48  # Points of a circle
MARK_M = 0.001  # How far the arrow that says where ahead is stands out
KEY = "pe_housing"  # A mesh's own property: the model whose housing it is
CREASE_RAD = math.radians(30.0)
Look = tuple[tuple[float, float, float], float, float]
"""Colour (linear RGB), metallic and roughness."""
MATERIALS: dict[str, Look] = {
    "PE housing": ((0.50, 0.52, 0.55), 0.4, 0.45),
    "PE trim": ((0.035, 0.037, 0.04), 0.0, 0.5),
    "PE window": ((0.012, 0.016, 0.03), 0.0, 0.08),
    "PE ahead": ((0.02, 0.42, 0.46), 0.0, 0.5),
}
"""In the order of `shapes`."""


@dataclass(frozen=True)
class Surface:
    """Points (N, 3) in the sensor frame [m], faces that look outwards, and what each is made of."""

    points: Floats
    faces: tuple[tuple[int, ...], ...]
    made_of: tuple[int, ...]

    def __add__(self, other: "Surface") -> "Surface":
        """Both together."""
        moved = tuple(tuple(i + len(self.points) for i in face) for face in other.faces)
        points = np.concatenate([self.points, other.points])
        return Surface(points, self.faces + moved, self.made_of + other.made_of)

    def moved(self, by: Floats) -> "Surface":
        """The same somewhere else."""
        return Surface(self.points + by, self.faces, self.made_of)


class Ring(NamedTuple):
    """Points (N, 3) round an axis, and what the surface is made of from here to the next."""

    points: Floats
    made_of: int = BODY


def surface_of(housing: pe.Housing, has_lens: bool) -> Surface:
    """Return the surface of a housing, the sensor frame's origin its optical centre."""
    if has_lens:
        surface = camera(housing.size)
    elif housing.shape == "cylinder":
        surface = can(housing.size, housing.optical_center[2])
    else:
        surface = box(housing.size, housing.size[0] / 2.0)
    return surface.moved(-np.array(housing.optical_center))


def can(size: Sequence[float], center: float) -> Surface:
    """An upright can, its window round the optical centre; its base is in z = 0."""
    radius = size[0] / 2.0
    top = size[2] - MARK_M
    half = min(0.26 * size[2], 0.9 * center, 0.9 * (top - center))
    bands = ((0.0, BODY), (center - half, GLASS), (center + half, BODY), (top, BODY))
    rings = [Ring(_circle(radius, z), made_of) for z, made_of in bands]
    return loft(rings) + arrow(-0.05 * radius, top, 0.55 * radius)


def box(size: Sequence[float], face: float, front: int = GLASS) -> Surface:
    """A box to the place x of its front, which is made of that; its base is in z = 0."""
    half = size[1] / 2.0
    high = size[2] - MARK_M
    corners = np.array([(half, high), (-half, high), (-half, 0.0), (half, 0.0)])
    rings = [(-size[0] / 2.0, BODY), (face, front)]
    made = [Ring(np.column_stack([np.full(4, x), corners]), made_of) for x, made_of in rings]
    return loft(made) + arrow(-0.3 * size[0], high, 0.35 * min(size[0], size[1]))


def camera(size: Sequence[float]) -> Surface:
    """A small box with a lens ahead; its base is in z = 0."""
    front = size[0] / 2.0
    face = 0.15 * size[0]
    radius = 0.36 * min(size[1], size[2])
    high = size[2] - MARK_M
    profile = [(radius, face, TRIM), (radius, front, TRIM), (0.8 * radius, front, GLASS)]
    rings = [Ring(_circle(r, x)[:, [2, 0, 1]], made_of) for r, x, made_of in profile]
    return box(size, face, BODY) + loft(rings).moved(np.array([0.0, 0.0, high / 2.0]))


def arrow(x: float, z: float, length: float) -> Surface:
    """A flat arrow on top that points ahead."""
    tip = x + length
    wing = 0.45 * length
    corners = [(tip, 0.0), (x, wing), (x + 0.25 * length, 0.0), (x, -wing)]
    rings = [
        Ring(np.array([(*each, height) for each in corners]), MARK) for height in (z, z + MARK_M)
    ]
    return loft(rings)


def loft(rings: Sequence[Ring]) -> Surface:
    """Return the surface through rings of as many points each, closed at both ends. Rings run
    counter-clockwise, seen from where the next one is."""
    count = len(rings[0].points)
    points = np.concatenate([ring.points for ring in rings])
    faces: list[tuple[int, ...]] = [tuple(range(count))[::-1]]
    made_of = [rings[0].made_of]
    for number, ring in enumerate(rings[:-1]):
        start = number * count
        for k in range(count):
            after = (k + 1) % count
            faces.append((start + k, start + after, start + count + after, start + count + k))
            made_of.append(ring.made_of)
    faces.append(tuple(range(len(points) - count, len(points))))
    return Surface(points, tuple(faces), (*made_of, rings[-1].made_of))


def _circle(radius: float, height: float) -> Floats:
    """(N, 3) points round the z axis, counter-clockwise from above."""
    angle = np.arange(CIRCLE_POINTS) * (2.0 * np.pi / CIRCLE_POINTS)
    flat = radius * np.cos(angle), radius * np.sin(angle)
    return np.stack([*flat, np.full(CIRCLE_POINTS, height)], axis=1)


def measured_housing(model: str) -> bpy.types.Mesh | None:
    """Return the mesh of a model's housing, None where no size of it is known."""
    return None if catalog.housing(model) is None else housing_mesh(model)


def housing_mesh(model: str) -> bpy.types.Mesh:
    """Return the mesh of a model's housing, of a typical one where no size of it is known.
    `InputError` when there is no such model."""
    for mesh in bpy.data.meshes:
        if mesh.get(KEY) == model and mesh.library is None:
            return mesh
    mesh = surface_mesh(f"{model} housing", model_surface(model))
    mesh[KEY] = model
    return mesh


def model_surface(model: str) -> Surface:
    """Return the surface of a model's housing in the sensor frame. Where no size of the model is
    known, that of its kind's typical housing."""
    sensor = catalog.load(model)
    row = row_of(sensor.kind)
    housing = catalog.housing(model) or row.typical_housing(sensor)
    return surface_of(housing, row.has_lens)


def surface_mesh(name: str, surface: Surface) -> bpy.types.Mesh:
    """Return a surface as a mesh, smooth but for its creases."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(surface.points.tolist(), [], surface.faces)
    for material in MATERIALS:
        mesh.materials.append(housing_material(material))
    mesh.polygons.foreach_set("material_index", surface.made_of)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=CREASE_RAD)
    return mesh


def housing_material(name: str, look: Look | None = None) -> bpy.types.Material:
    """Return a material, with the same colour in the solid view; by default one of housings."""
    material = bpy.data.materials.get(name)
    if material is not None:
        return material
    colour, metallic, roughness = look or MATERIALS[name]
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
    return material


def update_housings() -> None:
    """Give sensors that have another model's housing their own."""
    for scene in bpy.data.scenes:
        for obj in sensor_cache.sensors(scene):
            model = obj.perception_entropy.model
            worn = obj.data.get(KEY, model) if obj.type == "MESH" else model
            if worn != model and model in catalog.entries() and obj.is_editable:
                obj.data = housing_mesh(model)
