"""Mesh files: a box made by hand comes out the same of every format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.engine.mesh_files import (
    BOX,
    QUADS,
    glb_file,
    gltf,
    npz_bytes,
    obj_bytes,
    ply_ascii,
    ply_binary,
    read,
    stl_ascii,
    stl_binary,
)

BOXES = {
    "npz": ("box.npz", npz_bytes(triangles=BOX)),
    "npz, single precision": ("box.npz", npz_bytes(triangles=BOX.astype(np.float32))),
    "obj": ("box.obj", obj_bytes()),
    "suffix in capitals": ("box.OBJ", obj_bytes()),
    "stl, binary": ("box.stl", stl_binary()),
    "stl, binary beginning with solid": ("box.stl", stl_binary(b"solid as a rock")),
    "stl, ascii": ("box.stl", stl_ascii()),
    "stl, ascii without a name": ("box.stl", stl_ascii("")),
    "stl, ascii in capitals": ("box.stl", stl_ascii().upper().replace(b"BOX", b"box")),
    "ply, ascii": ("box.ply", ply_ascii()),
    "ply, ascii with quads": ("box.ply", ply_ascii(faces=QUADS)),
    "ply, ascii with CRLF": ("box.ply", ply_ascii().replace(b"\n", b"\r\n")),
    "ply, little endian": ("box.ply", ply_binary("<")),
    "ply, big endian": ("box.ply", ply_binary(">")),
    "ply, big endian quads": ("box.ply", ply_binary(">", faces=QUADS)),
    "glb, 8-bit indices": ("x.glb", glb_file(*gltf(code="B"))),
    "glb, 16-bit indices": ("x.glb", glb_file(*gltf(code="H"))),
    "glb, 32-bit indices": ("x.glb", glb_file(*gltf(code="I"))),
    "glb, no indices": ("x.glb", glb_file(*gltf(points=BOX, indices=None))),
}


@pytest.mark.parametrize(("name", "data"), BOXES.values(), ids=BOXES.keys())
def test_the_same_box_comes_out_of_every_format(tmp_path: Path, name: str, data: bytes) -> None:
    """Corners, their order, the axes, the types and the one part agree in all formats."""
    mesh = read(tmp_path, name, data)
    assert mesh.triangles.dtype == np.float64
    assert mesh.parts.dtype == np.int32
    assert mesh.triangles.tolist() == BOX.tolist()
    assert mesh.parts.tolist() == [0] * 12
    assert mesh.part_names == ("box",)


@pytest.mark.parametrize("name", ["box.npz", "box.obj", "box.stl", "box.ply", "x.glb"])
def test_triangles_without_area_are_kept(tmp_path: Path, name: str) -> None:
    """A triangle with three equal corners is somebody else's business."""
    flat = np.array([[[1.0, 2.0, 3.0]] * 3])
    data = {
        "box.npz": npz_bytes(triangles=flat),
        "box.obj": obj_bytes(flat[0], [(0, 0, 0)]),
        "box.stl": stl_binary(triangles=flat),
        "box.ply": ply_binary("<", flat[0], [(0, 1, 2)]),
        "x.glb": glb_file(*gltf(points=flat[0, :1], indices=[0, 0, 0])),
    }[name]
    assert read(tmp_path, name, data).triangles.tolist() == flat.tolist()
