"""glTF binaries: primitives, accessors, transforms, parts, scenes, and every error."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.engine.mesh_files import (
    BOX,
    INF,
    NAN,
    POINTS,
    TRIANGLE,
    changed,
    cut,
    glb_file,
    gltf,
    one_line_test,
    read,
)


@pytest.mark.parametrize(
    ("mode", "fans"),
    [
        (5, [(0, 1, 2), (1, 3, 2), (2, 3, 4), (3, 5, 4)]),
        (6, [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]),
    ],
    ids=["strip", "fan"],
)
def test_glb_strips_and_fans(tmp_path: Path, mode: int, fans: list[tuple[int, ...]]) -> None:
    """Triangles as the standard lists them: every other one of a strip is turned round."""
    data = glb_file(*gltf(indices=[7, 6, 5, 4, 3, 2], mode=mode))
    expected = POINTS[np.array([7, 6, 5, 4, 3, 2])[np.array(fans)]]
    assert read(tmp_path, "x.glb", data).triangles.tolist() == expected.tolist()


def test_glb_skips_points_lines_and_primitives_without_positions(tmp_path: Path) -> None:
    """Only the one primitive of triangles among five is read."""
    root, binary = gltf()
    primitives = root["meshes"][0]["primitives"]
    primitives += [{"attributes": {"POSITION": 0}, "mode": mode} for mode in (0, 1, 3)]
    primitives += [{"attributes": {}}]
    assert len(read(tmp_path, "x.glb", glb_file(root, binary)).triangles) == 12


def test_glb_byte_stride(tmp_path: Path) -> None:
    """Positions interleaved with other data, at an offset in their view."""
    root, binary = gltf()
    interleaved = b"".join(b"pad!" + binary[12 * i : 12 * i + 12] + b"more" for i in range(8))
    views = root["bufferViews"]
    views[0] = {"buffer": 0, "byteLength": len(interleaved), "byteStride": 20}
    views[1]["byteOffset"] = len(interleaved)
    root["accessors"][0]["byteOffset"] = 4
    mesh = read(tmp_path, "x.glb", glb_file(root, interleaved + binary[96:]))
    assert mesh.triangles.tolist() == BOX.tolist()


def test_glb_normalized_positions(tmp_path: Path) -> None:
    """KHR_mesh_quantization: normalised 16-bit positions, -32768 meaning -1 as well."""
    root, _ = gltf(points=TRIANGLE, indices=None)
    root["extensionsRequired"] = ["KHR_mesh_quantization"]
    root["accessors"][0].update(componentType=5122, normalized=True)
    binary = struct.pack("<9h", 32767, 0, 0, -32768, -32767, 0, 0, 0, 0)
    root["bufferViews"][0]["byteLength"] = len(binary)
    mesh = read(tmp_path, "x.glb", glb_file(root, binary), forward="+z")
    assert mesh.triangles.tolist() == [[[0, 1, 0], [0, -1, -1], [0, 0, 0]]]


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
    assert mesh.triangles.tolist() == (BOX[..., [2, 0, 1]] / 2).tolist()


def test_glb_mirror_keeps_the_outside_outside(tmp_path: Path) -> None:
    """A node that mirrors also reverses its triangles: the box's signed volume stays."""
    mesh = read(tmp_path, "x.glb", changed("nodes", 0, "scale", [-1, 1, 1]))
    volumes = [np.linalg.det(triangles).sum() / 6 for triangles in (BOX, mesh.triangles)]
    assert mesh.triangles[..., 1].max() == 1.0  # it was 1.5 before, and -1.0 the least
    assert volumes[0] != 0
    assert volumes[1] == pytest.approx(volumes[0])


@pytest.mark.parametrize(
    ("nodes", "names"),
    [
        ([{"name": "a", "mesh": 0}, {"name": "b", "mesh": 0}], ("a", "b")),
        ([{"name": "a", "mesh": 0}, {"name": "a", "mesh": 0}], ("a",)),
        ([{"mesh": 0}], ("the mesh",)),
        ([{"mesh": 1}], ("node 0",)),
        ([{"name": 7, "mesh": 0}], ("the mesh",)),
        ([{"name": "a", "children": [1, 2]}, {"name": "c", "mesh": 0}, {"mesh": 1}], None),
    ],
    ids=["two", "same name", "mesh name", "no name", "name no text", "children"],
)
@pytest.mark.parametrize("scenes", [True, False], ids=["scene", "no scene"])
def test_glb_parts(tmp_path: Path, nodes: list[Any], names: Any, scenes: bool) -> None:
    """Parts are called by node, else mesh, else number; without scenes every root counts."""
    root, binary = gltf()
    root["meshes"].append({"primitives": root["meshes"][0]["primitives"]})
    root["nodes"] = nodes
    root["scenes"][0]["nodes"] = [0] if "children" in nodes[0] else list(range(len(nodes)))
    if not scenes:
        del root["scenes"], root["scene"]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    assert mesh.part_names == (names or ("c", "node 2"))


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
    ("header", b""),
    ("header", b'{"asset": {}}'),
    ("version", struct.pack("<4sII", b"glTF", 1, 12)),
    ("length", cut(glb_file(*gltf()))),
    ("chunk JSON", struct.pack("<4sII", b"glTF", 2, 12)),
    ("chunk b'JSON'", struct.pack("<4sIII4s", b"glTF", 2, 20, 9, b"JSON")),
    ("JSON", glb_file(b"{no}", b"")),
    ("JSON", glb_file(b"[" * 200000, b"")),
    ("JSON", glb_file([], b"")),
    ("triangles", glb_file({}, b"")),
    ("JSON", changed("meshes", 0, {})),
    ("JSON", changed("nodes", None)),
    ("extensionsRequired", changed("extensionsRequired", ["KHR_draco_mesh_compression"])),
    ("extensionsRequired", changed("extensionsRequired", ["EXT_meshopt_compression"])),
    ("accessors[0]", changed("accessors", 0, "sparse", {})),
    ("accessors[0]", changed("accessors", 0, {})),
    ("accessors[0]", changed("accessors", 0, "type", "VEC2")),
    ("accessors[0]", changed("accessors", 0, "componentType", 5130)),
    ("accessors[0].count", changed("accessors", 0, "count", -1)),
    ("accessors[0]", changed("accessors", 0, "count", 0)),
    ("accessors[0]", changed("accessors", 0, "count", 9)),
    ("accessors[0]", changed("bufferViews", 0, "byteStride", 4)),
    ("bufferViews[1]", changed("bufferViews", 1, "byteLength", 999)),
    ("bufferViews", changed("accessors", 0, "bufferView", 2)),
    ("bufferViews[0]", changed("buffers", 0, "uri", "a.bin")),
    ("nodes", changed("nodes", 0, "children", [-1])),
    ("meshes", changed("nodes", 0, "mesh", 1)),
    ("scenes", changed("scene", True)),
    ("nodes[0]", changed("nodes", [7])),
    ("nodes[0]", changed("nodes", 0, "children", [0])),
    ("nodes[0].matrix", changed("nodes", 0, "matrix", [1])),
    ("nodes[0].scale", changed("nodes", 0, "scale", [2.0])),
    ("nodes[0].translation", changed("nodes", 0, "translation", ["a", 0, 0])),
    ("nodes[0].translation", changed("nodes", 0, "translation", [10**400, 0, 0])),
    ("triangles[0]", changed("nodes", 0, "scale", [1e308, 1e308, 1e308])),
    ("nodes[0].rotation", changed("nodes", 0, "rotation", [0, 0, 0, 0])),
    ("nodes[0]", changed("nodes", 0, "skin", 0)),
    ("nodes[0]", changed("nodes", 0, "weights", [0, 0.5])),
    ("accessors[1]", glb_file(*gltf(indices=[0, 1, 8]))),
    ("primitive", glb_file(*gltf(indices=[0, 1, 2, 3]))),
    ("triangles", glb_file(*gltf(indices=[0, 1], mode=5))),
    ("triangles[0]", glb_file(*gltf(points=NAN))),
    ("triangles[0]", glb_file(*gltf(points=INF))),
]


test_bad_input_is_refused_in_one_line = one_line_test(BAD, "a.glb")
