"""The same mesh file by Blender's importer and by ours: the triangles have the same area."""

import numpy as np
import pytest

import pe_tools as pt
from blender_addon.document.vehicle import drawn_meshes, placed_triangles, triangles_of
from tests.engine.mesh_files import glb_file, gltf, obj_bytes, ply_ascii, stl_binary
from tests.engine.test_mesh_elsewhere import AREAS, dae
from tests.engine.test_mesh_polygons import DART, arches, area

bpy = pytest.importorskip("bpy")

RNG = np.random.default_rng(6)
HOLED = [(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (1, 1, 0), (1, 2, 0), (2, 2, 0), (2, 1, 0)]
QUADS = RNG.normal(size=(50, 4, 3)).round(3)
"""Quads that are not flat: how they are cut decides their area."""
IMPORTERS = {
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
    "usda": lambda path: bpy.ops.wm.usd_import(filepath=path),
    "dae": lambda path: bpy.ops.wm.collada_import(filepath=path),
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
}
NEEDS = {"usda": "pxr", "dae": "collada"}
"""Libraries of the extra meshes."""


def usd(ring):
    points = ", ".join(str(tuple(point)) for point in np.asarray(ring).tolist())
    order = list(range(len(ring)))
    return (
        '#usda 1.0\n(\nupAxis = "Z"\nmetersPerUnit = 1\n)\ndef Mesh "m" {\n'
        f"int[] faceVertexCounts = [{len(ring)}]\nint[] faceVertexIndices = {order}\n"
        f'uniform token subdivisionScheme = "none"\npoint3f[] points = [{points}]\n}}\n'
    ).encode()


def one(ring):
    return [list(range(len(ring)))]


FILES = {
    "arches.obj": lambda: obj_bytes(arches(), one(arches())),
    "dart.obj": lambda: obj_bytes(DART, one(DART)),
    "hole.obj": lambda: obj_bytes(HOLED, [(0, 1, 2, 3, 0, 4, 5, 6, 7, 4)]),
    "quads.obj": lambda: obj_bytes(QUADS.reshape(-1, 3), np.arange(200).reshape(-1, 4)),
    "arches.ply": lambda: ply_ascii(arches(), one(arches())),
    "dart.ply": lambda: ply_ascii(DART, one(DART)),
    "arches.usda": lambda: usd(arches()),
    "dart.usda": lambda: usd(DART),
    "box.stl": stl_binary,
    "box.glb": lambda: glb_file(*gltf()),
    "dart.dae": lambda: dae(*AREAS["a dart"][:2]).encode(),
}


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize("name", FILES)
def test_blender_and_our_reader_cut_polygons_to_the_same_area(tmp_path, name):
    suffix = name.partition(".")[2]
    if suffix in NEEDS:
        pytest.importorskip(NEEDS[suffix], reason="of the extra meshes")
    if suffix == "dae" and "collada_import" not in dir(bpy.ops.wm):
        pytest.skip("this Blender reads no Collada")
    path = tmp_path / name
    path.write_bytes(FILES[name]())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    IMPORTERS[suffix](str(path))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    drawn = drawn_meshes(bpy.context.scene.collection, depsgraph)
    triangles = [placed_triangles(triangles_of(obj.to_mesh()), pose) for obj, pose in drawn]
    assert area(pt.read_mesh(path).triangles) == pytest.approx(
        area(np.concatenate(triangles)), rel=1e-6
    )
