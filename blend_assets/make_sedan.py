"""Build sedan.blend, the example vehicle: `python make_sedan.py` with the bpy module, or
`blender -b --python make_sedan.py`; `-- --out PATH` writes elsewhere. Deterministic."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

import sedan_lines as lines
import sedan_panels as panels
import sedan_parts as parts
import sedan_profile as profile
import sedan_skin as skinning
from sedan_parts import Part
from sedan_profile import Array

# Material: colour (linear RGB), metallic, roughness.
MATERIALS = {
    "paint": ((0.50, 0.57, 0.65), 0.10, 0.35),
    "glass": ((0.018, 0.022, 0.028), 0.0, 0.08),
    "trim": ((0.020, 0.021, 0.023), 0.0, 0.55),
    "tyre": ((0.012, 0.012, 0.013), 0.0, 0.85),
    "rim": ((0.50, 0.52, 0.54), 0.25, 0.40),
    "headlight": ((0.78, 0.86, 0.92), 0.0, 0.10),
    "taillight": ((0.45, 0.012, 0.016), 0.0, 0.20),
    "plate": ((0.80, 0.80, 0.78), 0.0, 0.50),
}
SHARP = np.radians(32)  # edges that fold more are drawn as creases


def housings(skin: skinning.Skin) -> Part:
    """Inner walls of the wheel openings, and in place the openings themselves."""
    skin.keep(lines.arch(skin.centres()) > 0)
    edges = skinning.boundary(skin.triangles)
    off = np.abs(lines.arch(skin.points[edges].reshape(-1, 3)).reshape(-1, 2))
    on_arch = off.max(axis=1) < 2e-3
    found = []
    for path in parts.chains(edges[on_arch]):
        outer = skin.points[path]
        inner = outer * [1, 0, 1] + [0, profile.WELL_Y, 0]
        points = np.vstack([outer, inner])
        faces = skinning.split_quads(points, skinning.quads(2, len(outer)))
        cap = parts.fill(inner, np.array([0.0, 1.0, 0.0])) + len(outer)
        triangles = np.vstack([faces, cap])
        found.append(Part(points, triangles, ["trim"] * len(triangles)))
    return parts.join(*found)


def floor(body: Part) -> Part:
    """A panel over the open lower edge of the left half, to the centre plane."""
    points, triangles = skinning.weld(body.points, body.triangles)
    edges = skinning.boundary(triangles)
    edges = edges[np.abs(points[edges][:, :, 1]).max(axis=1) > 1e-6]
    path = max(parts.chains(edges), key=len)
    loop = points[path]
    flat = parts.fill(loop * [1, 1, 0], np.array([0.0, 0.0, -1.0]))
    return Part(loop, flat, ["trim"] * len(flat))


def half_body() -> dict[str, Part]:
    """The left half of the skin as named parts."""
    skin = skinning.sample()
    panels.cut_panels(skin)
    wells = housings(skin)
    found = panels.classify(skin.centres())
    result = {}
    for name in dict.fromkeys(panel.name for panel in panels.PANELS):
        mine = [i for i, panel in enumerate(panels.PANELS) if panel.name == name]
        chosen = np.isin(found, mine)
        materials = [panels.PANELS[i].material for i in found[chosen]]
        result[name] = Part(skin.points, skin.triangles[chosen], materials)
    shell = Part(skin.points, skin.triangles, ["paint"] * len(skin.triangles))
    result["body"] = parts.join(result["body"], wells, floor(parts.join(shell, wells)))
    return result


def vehicle() -> dict[str, Part]:
    """Every object of the car in car coordinates, wheels about their own centre."""
    result = {}
    for name, part in half_body().items():
        if name == "windows":
            result |= {"windows_left": part, "windows_right": parts.flipped(part)}
        else:
            result[name] = parts.join(part, parts.flipped(part))
    mirror, wheel = parts.mirror(), parts.wheel()
    result |= {"mirror_left": mirror, "mirror_right": parts.flipped(mirror)}
    for axle in profile.AXLES:
        result |= {f"wheel_{axle}_left": wheel, f"wheel_{axle}_right": parts.flipped(wheel)}
    result["plate_front"], result["plate_rear"] = parts.plate(0.48, 1.0), parts.plate(0.66, -1.0)
    return result


def make_materials() -> dict[str, bpy.types.Material]:
    """One Principled material per name, with the same colour in the viewport."""
    made = {}
    for name, (colour, metallic, roughness) in MATERIALS.items():
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        material.diffuse_color = (*colour, 1.0)
        material.metallic, material.roughness = metallic, roughness
        shader = material.node_tree.nodes["Principled BSDF"].inputs
        shader["Base Color"].default_value = (*colour, 1.0)
        shader["Metallic"].default_value, shader["Roughness"].default_value = metallic, roughness
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


def fair_normals(mesh: bpy.types.Mesh) -> None:
    """Shade skin with the true normals of the surface, seen from inside each face at its corner."""
    corner = np.array([loop.vertex_index for loop in mesh.loops])
    points = np.array([vertex.co for vertex in mesh.vertices])[corner].reshape(-1, 3, 3)
    inward = points.mean(axis=1, keepdims=True) - points
    inward *= 0.003 / np.linalg.norm(inward, axis=2, keepdims=True)  # 3 mm
    points = (points + inward).reshape(-1, 3)
    mirror = np.where(points[:, 1:2] < 0, [[1, -1, 1]], [[1, 1, 1]])
    fair = profile.gradient(points * mirror) * mirror
    fair /= np.linalg.norm(fair, axis=1)[:, None]
    normals = np.array([normal.vector for normal in mesh.corner_normals])
    facing = np.repeat([face.vector for face in mesh.polygon_normals], 3, axis=0)
    skin = (np.sum(fair * facing, axis=1) > 0.35) & (np.abs(profile.solid(points)) < 5e-3)
    normals[skin] = fair[skin]
    mesh.normals_split_custom_set(normals.tolist())


def build() -> None:
    """The Sedan collection in an empty scene with metric units."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length, units.length_unit = "METRIC", 1.0, "METERS"
    collection = bpy.data.collections.new("Sedan")
    bpy.context.scene.collection.children.link(collection)
    materials = make_materials()
    for name, part in vehicle().items():
        mesh = make_mesh(name, part, materials)
        if not name.startswith(("wheel", "mirror", "plate")):
            fair_normals(mesh)
        thing = bpy.data.objects.new(name, mesh)
        if name.startswith("wheel"):
            _, axle, side = name.split("_")
            y = profile.TRACK / 2 * (1 if side == "left" else -1)
            thing.location = (profile.AXLES[axle], y, profile.WHEEL_RADIUS)
        collection.objects.link(thing)


def main() -> None:
    """Read the arguments, build and save."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    if bpy.app.binary_path and "--" not in sys.argv:
        arguments = []
    parser = argparse.ArgumentParser(description=__doc__)
    default = Path(__file__).resolve().parent / "sedan.blend"
    parser.add_argument("--out", type=Path, default=default, help="file to write")
    out = parser.parse_args(arguments).out.resolve()
    build()
    bpy.context.preferences.filepaths.save_version = 0  # no backup beside it
    bpy.ops.wm.save_as_mainfile(filepath=str(out), compress=True)


if __name__ == "__main__":
    main()
