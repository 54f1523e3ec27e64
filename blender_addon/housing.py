"""Sensors with a body: a mesh of the housing's true size as the sensor object's own data.

The mesh is the sensor's, not an object beside it: it is selected, copied, hidden and deleted with
the sensor, and a sensor never occludes its own beams. Surfaces are made as plain arrays first.
Outer sizes are the housing's; what is inside them is a maker's usual proportion, not a drawing of
the maker's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import bpy
import numpy as np

from . import sensor_cache
from .engine import Floats, catalog, pe
from .sensor_kinds import row_of

BODY, TRIM, GLASS, MARK = range(4)
"""What a face is made of."""
CIRCLE_POINTS = 48
"""Points of a circle."""
CORNER_POINTS = 6
"""Points of a rounded corner."""
MARK_M = 0.001
"""How far the arrow that says where ahead is stands out."""


@dataclass(frozen=True)
class Surface:
    """Points (N, 3) in the sensor frame [m], faces that look outwards, and what each is made of."""

    points: Floats
    faces: tuple[tuple[int, ...], ...]
    made_of: tuple[int, ...]

    def __add__(self, other: Surface) -> Surface:
        """Both together."""
        moved = tuple(tuple(i + len(self.points) for i in face) for face in other.faces)
        points = np.concatenate([self.points, other.points])
        return Surface(points, self.faces + moved, self.made_of + other.made_of)

    def moved(self, by: Floats) -> Surface:
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
        surface = visor(housing.size)
    return surface.moved(-np.array(housing.optical_center))


def can(size: Sequence[float], center: float) -> Surface:
    """An upright can, its window round the optical centre; its base is in z = 0."""
    radius, height = size[0] / 2.0, size[2]
    top = height - MARK_M
    bevel, inset = 0.04 * size[0], 0.02 * size[0]
    half = min(0.26 * height, center - 0.12 * height, top - center - 0.1 * height)
    half = max(half, 0.08 * height)
    low, high = max(center - half, 2.0 * bevel), min(center + half, top - 2.0 * bevel)
    profile = [(radius - bevel, 0.0, BODY), (radius, bevel, BODY), (radius, low, TRIM)]
    profile += [(radius - inset, low, GLASS), (radius - inset, high, TRIM)]
    profile += [(radius, high, BODY), (radius, top - bevel, BODY), (radius - bevel, top, BODY)]
    rings = [Ring(_circle(r, z), made_of) for r, z, made_of in profile]
    return loft(rings) + arrow(-0.05 * radius, top, 0.55 * radius)


def visor(size: Sequence[float]) -> Surface:
    """A box with a window in its front; its base is in z = 0."""
    front, back = size[0] / 2.0, -size[0] / 2.0
    wide, high = size[1], size[2] - MARK_M
    bevel, frame = 0.06 * min(size), 0.1 * min(wide, high)
    section = _BoxSections(wide, high)
    rings = [Ring(section(back, bevel)), Ring(section(back + bevel, 0.0))]
    rings += [Ring(section(front - bevel, 0.0)), Ring(section(front, bevel), TRIM)]
    rings += [Ring(section(front, frame), TRIM), Ring(section(front - 0.5 * bevel, frame), GLASS)]
    return loft(rings) + arrow(0.0, high, 0.28 * size[0])


def camera(size: Sequence[float]) -> Surface:
    """A small box with a lens ahead; its base is in z = 0."""
    front, back = size[0] / 2.0, -size[0] / 2.0
    face = front - 0.35 * size[0]
    wide, high = size[1], size[2] - MARK_M
    bevel, radius = 0.08 * min(size), 0.36 * min(wide, high)
    section = _BoxSections(wide, high)
    rings = [Ring(section(back, bevel)), Ring(section(back + bevel, 0.0))]
    rings += [Ring(section(face - bevel, 0.0)), Ring(section(face, bevel))]
    return (
        loft(rings) + lens(radius, face, front, high / 2.0) + arrow(0.6 * back, high, 0.35 * wide)
    )


def lens(radius: float, start: float, end: float, height: float) -> Surface:
    """A barrel along x with its glass a little behind its rim."""
    deep = 0.25 * (end - start)
    profile = [(radius, start, TRIM), (radius, end, TRIM), (0.82 * radius, end, TRIM)]
    profile += [(0.74 * radius, end - deep, GLASS), (0.4 * radius, end - 0.7 * deep, GLASS)]
    rings = [Ring(_circle(r, x)[:, [2, 0, 1]], made_of) for r, x, made_of in profile]
    return loft(rings).moved(np.array([0.0, 0.0, height]))


def arrow(x: float, z: float, length: float) -> Surface:
    """A flat arrow on top that points ahead."""
    tip, wing = x + length, 0.45 * length
    corners = [(tip, 0.0), (x, wing), (x + 0.25 * length, 0.0), (x, -wing)]
    rings = [
        Ring(np.array([(*each, height) for each in corners]), MARK) for height in (z, z + MARK_M)
    ]
    return loft(rings)


def loft(rings: Sequence[Ring]) -> Surface:
    """Return the surface through rings of as many points each, closed at both ends.

    Rings run counter-clockwise, seen from where the next one is.
    """
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


class _BoxSections:
    """Sections of a box across x, with round corners: at a place, so much smaller on each side."""

    def __init__(self, wide: float, high: float) -> None:
        self.wide, self.high = wide, high
        self.round = 0.14 * min(wide, high)

    def __call__(self, x: float, smaller: float) -> Floats:
        """(N, 3) points, counter-clockwise from ahead."""
        radius = max(self.round - smaller, 0.2 * self.round)
        half = np.array([self.wide, self.high]) / 2.0 - smaller - radius
        rows = []
        for number, (right, up) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
            for angle in (number + np.arange(CORNER_POINTS) / (CORNER_POINTS - 1)) * (np.pi / 2.0):
                y = right * half[0] + radius * np.cos(angle)
                z = up * half[1] + radius * np.sin(angle)
                rows.append((x, y, z + self.high / 2.0))
        return np.array(rows)


KEY = "pe_housing"
"""A mesh's own property: the model whose housing it is."""
CREASE_RAD = math.radians(30.0)
MATERIALS = {
    "PE housing": ((0.50, 0.52, 0.55), 0.4, 0.45),
    "PE trim": ((0.035, 0.037, 0.04), 0.0, 0.5),
    "PE window": ((0.012, 0.016, 0.03), 0.0, 0.08),
    "PE ahead": ((0.02, 0.42, 0.46), 0.0, 0.5),
}
"""Colour (linear RGB), metallic and roughness, in the order of `shapes`."""


def measured_housing(model: str) -> bpy.types.Mesh | None:
    """Return the mesh of a model's housing, None where no size of it is known."""
    return None if catalog.housing(model) is None else housing_mesh(model)


def housing_mesh(model: str) -> bpy.types.Mesh:
    """Return the mesh of a model's housing, of a typical one where no size of it is known.

    `InputError` when there is no such model.
    """
    for mesh in bpy.data.meshes:
        if mesh.get(KEY) == model and mesh.library is None:
            return mesh
    mesh = surface_mesh(f"{model} housing", model_surface(model))
    mesh[KEY] = model
    return mesh


def model_surface(model: str) -> Surface:
    """Return the surface of a model's housing in the sensor frame.

    Where no size of the model is known, that of its kind's typical housing.
    """
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


def housing_material(name: str) -> bpy.types.Material:
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


def update_housings() -> None:
    """Give sensors that have another model's housing their own."""
    for scene in bpy.data.scenes:
        for obj in sensor_cache.sensors(scene):
            model = obj.perception_entropy.model
            worn = obj.data.get(KEY, model) if obj.type == "MESH" else model
            if worn != model and model in catalog.entries() and obj.is_editable:
                obj.data = housing_mesh(model)
