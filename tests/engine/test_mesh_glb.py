"""glTF binaries: primitives, accessors, transforms, parts, scenes, and every error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.engine.mesh_files import BOX, NAN, changed, cut, glb_file, gltf, one_line_test, read


def test_glb_surfaces_of_one_mesh_are_one_part(tmp_path: Path) -> None:
    """Blender writes a surface a material; points and lines are left out."""
    root, binary = gltf()
    primitives = root["meshes"][0]["primitives"]
    primitives += [primitives[0], *({"attributes": {"POSITION": 0}, "mode": m} for m in (0, 1))]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    assert len(mesh.triangles) == 24 and mesh.part_names == ("box",)


def test_glb_mirror_keeps_the_outside_outside(tmp_path: Path) -> None:
    """A node that mirrors also reverses its triangles: the box's signed volume stays."""
    mesh = read(tmp_path, "x.glb", changed("nodes", 0, "scale", [-1, 1, 1]))
    volumes = [np.linalg.det(triangles).sum() / 6 for triangles in (BOX, mesh.triangles)]
    assert mesh.triangles[..., 1].max() == 1.0  # it was 1.5 before, and -1.0 the least
    assert volumes[0] != 0
    assert volumes[1] == pytest.approx(volumes[0])


BAD = [
    ("JSON", b""),
    ("JSON", b'{"asset": {}}'),
    ("file", cut(glb_file(*gltf()))),
    ("JSON", glb_file(b"{no}", b"")),
    ("JSON", glb_file([], b"")),
    ("triangles", glb_file({}, b"")),
    ("JSON", changed("meshes", 0, {})),
    ("scene", changed("extensionsRequired", ["KHR_draco_mesh_compression"])),
    ("scene", changed("accessors", 0, "sparse", {})),
    ("scene", changed("accessors", 0, "normalized", True)),
    ("scene", changed("nodes", 0, "skin", 0)),
    ("scene", changed("nodes", 0, "weights", [0, 0.5])),
    ("scene", glb_file(*gltf(mode=6))),
    ("file", changed("accessors", 0, "count", 9)),
    ("file", changed("buffers", 0, "uri", "a.bin")),
    ("JSON", changed("nodes", 0, "mesh", 1)),
    ("triangles[0]", changed("nodes", 0, "scale", [1e308, 1e308, 1e308])),
    ("file", glb_file(*gltf(indices=[0, 1, 8]))),
    ("triangles[0]", glb_file(*gltf(points=NAN))),
]


test_bad_input_is_refused_in_one_line = one_line_test(BAD, "a.glb")
