"""glTF binaries: primitives, accessors, transforms, parts, scenes, and every error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.engine.mesh_files import (
    BOX,
    NAN,
    TRIANGLE,
    changed,
    cut,
    glb_file,
    gltf,
    one_line_test,
    read,
)


def test_glb_surfaces_of_one_mesh_are_one_part(tmp_path: Path) -> None:
    """Blender writes a surface a material; points and lines are left out."""
    root, binary = gltf()
    primitives = root["meshes"][0]["primitives"]
    primitives += [primitives[0], *({"attributes": {"POSITION": 0}, "mode": m} for m in (0, 1))]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    assert len(mesh.triangles) == 24 and mesh.part_names == ("box",)


def test_glb_transforms_go_down_the_hierarchy(tmp_path: Path) -> None:
    """Scale, then rotation, then translation, then the parent's matrix, column by column."""
    root, binary = gltf(points=TRIANGLE, indices=None)
    # The parent turns +X into +Y, and moves along glTF's +Z.
    matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 100, 1]
    half = np.sqrt(0.5)
    root["nodes"] = [
        {"name": "parent", "matrix": matrix, "children": [1]},
        # A quarter turn about +Y: +Z becomes +X.
        {
            "name": "wheel",
            "mesh": 0,
            "translation": [10, 0, 0],
            "rotation": [0, half, 0, half],
            "scale": [1, 1, 2],
        },
    ]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    # By hand, for the corner (1, 1, 0) forward, left: glTF (1, 0, 1), scaled (1, 0, 2),
    # turned (2, 0, -1), moved (12, 0, -1), by the parent (0, 12, 99): forward 99, up 12.
    expected = [[[100, 0, 10], [100, 0, 12], [99, 0, 12]]]
    np.testing.assert_allclose(mesh.triangles, expected, atol=1e-12)
    assert mesh.part_names == ("wheel",)


def test_glb_rotation_is_a_quaternion(tmp_path: Path) -> None:
    """A third of a turn about (1, 1, 1): glTF's X goes to Y, Y to Z, Z to X; halved, not unit."""
    root, binary = gltf()
    root["nodes"][0].update(rotation=[1, 1, 1, 1], scale=[0.5, 0.5, 0.5])
    mesh = read(tmp_path, "x.glb", glb_file(root, binary), forward="+z")
    # Ours: left goes to up, up to forward, forward to left.
    np.testing.assert_allclose(mesh.triangles, BOX[..., [2, 0, 1]] / 2, atol=1e-12)


def test_glb_mirror_keeps_the_outside_outside(tmp_path: Path) -> None:
    """A node that mirrors also reverses its triangles: the box's signed volume stays."""
    mesh = read(tmp_path, "x.glb", changed("nodes", 0, "scale", [-1, 1, 1]))
    volumes = [np.linalg.det(triangles).sum() / 6 for triangles in (BOX, mesh.triangles)]
    assert mesh.triangles[..., 1].max() == 1.0  # it was 1.5 before, and -1.0 the least
    assert volumes[0] != 0
    assert volumes[1] == pytest.approx(volumes[0])


def test_glb_parts_are_nodes_in_their_order(tmp_path: Path) -> None:
    """Two nodes may have one mesh; a node inside another is a part of its own."""
    root, binary = gltf()
    inner = {"name": "inner", "mesh": 0}
    root["nodes"] = [{"name": "a", "mesh": 0, "children": [2]}, {"name": "b", "mesh": 0}, inner]
    root["scenes"][0]["nodes"] = [0, 1]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    assert set(mesh.part_names) == {"a", "b", "inner"} and len(mesh.triangles) == 36


@pytest.mark.parametrize(("scene", "name"), [(0, "box"), (1, "other"), (None, "box")])
def test_glb_reads_the_default_scene_only(tmp_path: Path, scene: int | None, name: str) -> None:
    """Of two scenes the one called `scene` counts, or else the first."""
    root, binary = gltf()
    root["nodes"].append({"name": "other", "mesh": 0})
    root["scenes"].append({"nodes": [1]})
    root["scene"] = scene
    if scene is None:
        del root["scene"]
    assert read(tmp_path, "x.glb", glb_file(root, binary)).part_names == (name,)


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
