"""Mesh files: a box made by hand in every format, each format's own forms, and every error."""

from __future__ import annotations

import io
import json
import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pe_core.errors import InputError
from pe_core.mesh_io import Mesh, read_mesh, write_mesh

# A box with three different sides, so that no two axes can be mistaken for each other; its
# coordinates are exact in single precision.
POINTS = np.array([(x, y, z) for x in (-1.0, 4.0) for y in (-1.0, 1.5) for z in (0.25, 2.0)])
QUADS = np.array(
    [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
)
FACES = np.array([face for a, b, c, d in QUADS.tolist() for face in ((a, b, c), (a, c, d))])
BOX = POINTS[FACES]
SQUARE = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], float)
TRIANGLE = SQUARE[:1]


# The box in every format -------------------------------------------------------------------


def npz_bytes(**arrays: Any) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def obj_bytes(points: Any = POINTS, faces: Any = QUADS) -> bytes:
    lines = ["v {} {} {}".format(*point) for point in points]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return "\n".join(lines).encode()


def stl_binary(header: bytes = b"made by hand", triangles: Any = BOX) -> bytes:
    data = header.ljust(80, b" ") + struct.pack("<I", len(triangles))
    for triangle in triangles:
        data += struct.pack("<12fH", 0, 0, 0, *np.ravel(triangle), 7)
    return data


def stl_ascii(name: str = "box", triangles: Any = BOX) -> bytes:
    lines = [f"solid {name}"]
    for triangle in triangles:
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += ["  vertex {} {} {:e}".format(*point) for point in triangle]
        lines += [" endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""]).encode()


def ply_header(kind: str, vertices: int, faces: int) -> str:
    return (
        f"ply\nformat {kind} 1.0\ncomment by hand\nelement vertex {vertices}\nproperty float x\n"
        f"property float y\nproperty float z\nelement face {faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )


def ply_ascii(points: Any = POINTS, faces: Any = FACES) -> bytes:
    rows = [*points, *((len(face), *face) for face in faces)]
    body = "\n".join(" ".join(str(value) for value in row) for row in rows)
    return (ply_header("ascii", len(points), len(faces)) + body).encode()


def ply_binary(order: str, points: Any = POINTS, faces: Any = FACES) -> bytes:
    kind = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    data = ply_header(kind, len(points), len(faces)).encode()
    for point in points:
        data += struct.pack(f"{order}3f", *point)
    for face in faces:
        data += struct.pack(f"{order}B{len(face)}i", len(face), *face)
    return data


def to_gltf(points: Any) -> np.ndarray:
    """(forward, left, up) as glTF's (X left, Y up, Z forward)."""
    return np.stack([points[..., 1], points[..., 2], points[..., 0]], axis=-1)


def glb_file(root: Any, binary: bytes) -> bytes:
    text = root if isinstance(root, bytes) else json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    data = struct.pack("<I4s", len(text), b"JSON") + text
    data += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(data)) + data


def gltf(
    points: Any = POINTS, indices: Any = FACES, code: str = "H", mode: int | None = None
) -> tuple[dict[str, Any], bytes]:
    """A document of one node `box` with one primitive, for a test to change, and its data."""
    positions = np.asarray(to_gltf(np.reshape(points, (-1, 3))), "<f4").tobytes()
    flat = np.ravel(indices).tolist() if indices is not None else []
    order = struct.pack(f"<{len(flat)}{code}", *flat)
    component = {"B": 5121, "H": 5123, "I": 5125}[code]
    primitive: dict[str, Any] = {"attributes": {"POSITION": 0}}
    if indices is not None:
        primitive["indices"] = 1
    if mode is not None:
        primitive["mode"] = mode
    root = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "box", "mesh": 0}],
        "meshes": [{"name": "the mesh", "primitives": [primitive]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "type": "VEC3",
                "count": len(positions) // 12,
            },
            {"bufferView": 1, "componentType": component, "type": "SCALAR", "count": len(flat)},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(order)},
        ],
        "buffers": [{"byteLength": len(positions) + len(order)}],
    }
    return root, positions + order


def changed(*steps: Any, **keywords: Any) -> bytes:
    """The glb of `gltf(**keywords)` with the value at a path (all steps but the last) replaced."""
    root, binary = gltf(**keywords)
    *path, key, value = steps
    place: Any = root
    for step in path:
        place = place[step]
    place[key] = value
    return glb_file(root, binary)


def read(folder: Path, name: str, data: bytes) -> Mesh:
    path = folder / name
    path.write_bytes(data)
    return read_mesh(path)


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


# Writing -----------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".npz", ".obj"])
@pytest.mark.parametrize("labels", [[0, 0, 1, 2], [2, 0, 1, 0]], ids=["in order", "mixed"])
def test_written_meshes_read_back_exactly(tmp_path: Path, suffix: str, labels: list[int]) -> None:
    """Every bit of every coordinate (-0.0 and tiny ones too), every part and its place."""
    triangles = (
        np.random.default_rng(1).normal(size=(4, 3, 3))
        * 10.0 ** np.arange(-150, 150, 75)[:, None, None]
    )
    triangles[0, 0] = (0.0, -0.0, 5e-324)
    triangles[1, 0] = (-0.0, 0.0, 5e-324)
    mesh = Mesh(triangles, np.array(labels, np.int32), ("Rad #1 – links", "g", "o"))
    path = tmp_path / f"mesh{suffix}"
    write_mesh(str(path), mesh)
    back = read_mesh(str(path))
    assert back.triangles.tobytes() == triangles.tobytes()
    assert back.parts.tolist() == labels
    assert back.part_names == mesh.part_names


def test_obj_vertices_are_shared(tmp_path: Path) -> None:
    """The box is written with its 8 vertices, not with 36."""
    write_mesh(tmp_path / "box.obj", Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert (tmp_path / "box.obj").read_text().count("\nv ") == 8


def test_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: Any) -> None:
    """When the last step fails, the old file is whole and nothing else is left behind."""
    path = tmp_path / "box.npz"
    path.write_text("old")

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError, match="no space left"):
        write_mesh(path, Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert [item.name for item in tmp_path.iterdir()] == ["box.npz"]
    assert path.read_text() == "old"


def test_written_file_replaces_the_old_one(tmp_path: Path) -> None:
    """The new file takes the old one's place with the mode any new file gets, alone."""
    path, other = tmp_path / "box.obj", tmp_path / "other"
    path.write_text("old")
    other.touch()
    write_mesh(path, Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert read_mesh(path).triangles.tolist() == BOX.tolist()
    assert path.stat().st_mode == other.stat().st_mode
    assert {item.name for item in tmp_path.iterdir()} == {"box.obj", "other"}


ZEROS = np.zeros(12, np.int32)
UNWRITABLE = {
    "suffix": ("box.stl", Mesh(BOX, ZEROS, ("box",)), "suffix"),
    "folder": ("none/box.npz", Mesh(BOX, ZEROS, ("box",)), "file"),
    "nan": ("box.obj", Mesh(BOX * np.nan, ZEROS, ("box",)), "triangles[0]"),
    "empty": ("box.obj", Mesh(BOX[:0], ZEROS[:0], ("box",)), "triangles"),
    "flat": ("box.obj", Mesh(BOX[0], ZEROS[:3], ("box",)), "triangles"),
    "parts too few": ("box.npz", Mesh(BOX, ZEROS[1:], ("box",)), "parts"),
    "part without a name": ("box.npz", Mesh(BOX, ZEROS + 1, ("box",)), "parts[0]"),
    "two lines": ("box.obj", Mesh(BOX, ZEROS, ("a\nb",)), "part_names"),
    "no name": ("box.obj", Mesh(BOX, ZEROS, ("",)), "part_names"),
    "space in front": ("box.obj", Mesh(BOX, ZEROS, (" a",)), "part_names"),
    "continued": ("box.obj", Mesh(BOX, ZEROS, ("a\\",)), "part_names"),
    "no unicode": ("box.obj", Mesh(BOX, ZEROS, ("\udc80",)), "part_names"),
}


@pytest.mark.parametrize(("name", "mesh", "field"), UNWRITABLE.values(), ids=UNWRITABLE.keys())
def test_what_could_not_be_read_back_is_not_written(
    tmp_path: Path, name: str, mesh: Mesh, field: str
) -> None:
    """The error names file and field, and no file appears."""
    with pytest.raises(InputError) as caught:
        write_mesh(tmp_path / name, mesh)
    assert str(caught.value).startswith(f"{tmp_path / name}: {field}: expected ")
    assert not list(tmp_path.iterdir())


# Parts -------------------------------------------------------------------------------------

CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\n"
FACE = "f 1 2 3\n"
SOLID = stl_ascii("{}", TRIANGLE).decode()
PARTS = {
    "o wins over g": (f"g a\no b\n{FACE}g c\n{FACE}o d\n{FACE}", ["b", "b", "d"]),
    "g without any o": (f"g a\n{FACE}g b c\n{FACE}", ["a", "b c"]),
    "before the first name": (f"{FACE}o a\n{FACE}", ["car", "a"]),
    "a name twice": (f"o a\n{FACE}o b\n{FACE}o a\n{FACE}", ["a", "b", "a"]),
    "a part without triangles": (f"o a\no b\n{FACE}o c\n", ["b"]),
    "a name with spaces and #": (f"  o\t  front #1  left \n{FACE}", ["front #1  left"]),
    "a nameless o": (f"o a\n{FACE}o\n{FACE}", ["a", "car"]),
    "Latin-1": (f"o Räder\n{FACE}", ["Räder"]),
}


@pytest.mark.parametrize(("text", "names"), PARTS.values(), ids=PARTS.keys())
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig"])
def test_obj_parts(tmp_path: Path, text: str, names: list[str], encoding: str) -> None:
    """Which part each face belongs to, by o or g, in any of the usual encodings."""
    mesh = read(tmp_path, "car.obj", (CORNERS + text).encode(encoding))
    assert [mesh.part_names[part] for part in mesh.parts] == names
    assert len(mesh.part_names) == len(set(names))


def test_stl_solids_are_parts(tmp_path: Path) -> None:
    """Each solid is a part, one of a repeated name is the same part, a nameless is the stem."""
    text = "".join("  " + SOLID.format(name, name) for name in ("a b", "", "c", "a b"))
    mesh = read(tmp_path, "car.stl", text.encode())
    assert mesh.part_names == ("a b", "car", "c")
    assert mesh.parts.tolist() == [0, 1, 2, 0]


def test_npz_parts_are_merged_and_dropped(tmp_path: Path) -> None:
    """Of four names one is repeated and one has no triangles: two are left."""
    names = np.array(["a", "unused", "b", "a"])
    data = npz_bytes(triangles=BOX[:3], parts=np.array([3, 2, 0]), part_names=names)
    mesh = read(tmp_path, "car.npz", data)
    assert mesh.part_names == ("a", "b")
    assert mesh.parts.tolist() == [0, 1, 0]


def test_npz_without_parts_may_have_a_name(tmp_path: Path) -> None:
    """A lone part name is used for all triangles."""
    data = npz_bytes(triangles=BOX, part_names=np.array(["body"]))
    assert read(tmp_path, "car.npz", data).part_names == ("body",)


# Forms of each format ----------------------------------------------------------------------

V = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
OBJ_FORMS = {
    "quad": f"{V}f 1 2 3 4\n",
    "triangles": f"{V}f 1 2 3\nf 1 3 4\n",
    "negative": f"{V}f -4 -3 -2 -1\n",
    "negative before more vertices": f"{V}f -4 -3 -2 -1\nv 9 9 9\n",
    "faces first": f"f 1 2 3 4\n{V}",
    "v/vt": f"{V}vt 0 0\nf 1/1 2/1 3/1 4/1\n",
    "v/vt/vn": f"{V}f 1/9/9 2/9/9 3/9/9 4/9/9\n",
    "v//vn": f"{V}vn 0 0 1\nf 1//1 2//1 3//1 -1//-1\n",
    "continued": f"{V}f 1 2 \\\n3\\\n 4\n",
    "continued with CRLF": f"{V}f 1 2 \\\r\n3 4\r\n",
    "mixed line endings": "v 0 0 0\rv 1 0 0\r\nv 1 1 0\nv 0 1 0\rf 1 2 3 4",
    "faces of two and fewer": f"{V}f 1 2\nf\nf 3\nf 1 2 3 4\nf 3 4\n",
    "colours and comments": V.replace("0\n", "0 .5 .5 1 # c\n") + "f 1 2 3 4 # 5\n",
    "a comment ending in a backslash": f"# C:\\cars\\\n{V}# \\\nf 1 2 3 4\n",
    "other keywords": f"mtllib a.mtl\n{V}usemtl a\ns off\nl 1 2\n p 1\n  f\t1 2 3 4",
}


@pytest.mark.parametrize("text", OBJ_FORMS.values(), ids=OBJ_FORMS.keys())
def test_obj_forms(tmp_path: Path, text: str) -> None:
    """Every way OBJ has of writing a unit square gives the same two triangles."""
    assert read(tmp_path, "s.obj", text.encode()).triangles.tolist() == SQUARE.tolist()


@pytest.mark.parametrize("order", ["", "<", ">"], ids=["ascii", "little", "big"])
@pytest.mark.parametrize("sizes", [(3, 4, 5), (0, 4, 4)], ids=["mixed", "empty first"])
def test_ply_finds_its_way_among_other_data(
    tmp_path: Path, order: str, sizes: tuple[int, ...]
) -> None:
    """Lists of several lengths, other properties of every type and other elements around."""
    kind = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = f"""ply
format {kind} 1.0
obj_info element face 9
element camera 2
property list ushort double view
property uint8 id
element nothing 3
element vertex 8
property short material
property double z
property float64 x
property int8 flag
property double y
element face 3
property uint32 colour
property list int uint16 vertex_index
property list uchar float texcoord
element edge 1
property int v
end_header
"""
    rows: list[tuple[str, list[float]]] = [("Hd", [1, 0.5]), ("B", [7]), ("HB", [0, 9])]
    rows += [("hddbd", [3, z, x, -1, y]) for x, y, z in POINTS.tolist()]
    polygons = [[(row + k) % 8 for k in range(size)] for row, size in enumerate(sizes)]
    for polygon in polygons:
        rows.append((f"Ii{len(polygon)}HB2f", [255, len(polygon), *polygon, 2, 0.5, 0.25]))
    rows.append(("i", [5]))
    if order:
        body = b"".join(struct.pack(order + codes, *values) for codes, values in rows)
    else:
        body = "\n".join(" ".join(map(str, values)) for _, values in rows).encode()
    mesh = read(tmp_path, "s.ply", header.encode() + body)
    fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
    assert mesh.triangles.tolist() == POINTS[np.array(fans)].tolist()


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
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
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
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
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


# Errors ------------------------------------------------------------------------------------


def ply_with(old: str, new: str) -> bytes:
    text = ply_ascii().decode()
    assert old in text
    return text.replace(old, new, 1).encode()


def cut(data: bytes) -> bytes:
    return data[:-1]


NAN, INF = POINTS.copy(), POINTS.copy()
NAN[0, 1], INF[0, 1] = np.nan, np.inf
NO_FACES = np.zeros((0, 3), int)
HUGE = "9" * 5000

BAD = {
    "unknown suffix": ("a.fbx", b"", "suffix", ".obj"),
    "no suffix": ("a", b"", "suffix", "none"),
    # npz
    "npz of text": ("a.npz", b"hello", "file", ".npz"),
    "npz that is npy": ("a.npz", b"\x93NUMPY\x01\x00", "file", ".npz"),
    "npz cut": ("a.npz", cut(npz_bytes(triangles=BOX)), "file", "complete"),
    "npz of objects": ("a.npz", npz_bytes(triangles=np.array([{}])), "file", "pickle"),
    "npz without triangles": ("a.npz", npz_bytes(parts=[0]), "triangles", "parts"),
    "npz of empty": ("a.npz", npz_bytes(triangles=BOX[:0]), "triangles", "at least one"),
    "npz of two axes": ("a.npz", npz_bytes(triangles=BOX[0]), "triangles", "(3, 3)"),
    "npz of words": ("a.npz", npz_bytes(triangles=BOX.astype(str)), "triangles", "real"),
    "npz of NaN": ("a.npz", npz_bytes(triangles=NAN[FACES]), "triangles[0]", "nan"),
    "npz parts too short": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=[0], part_names=["a"]),
        "parts",
        "(12,)",
    ),
    "npz parts not whole": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=np.zeros(12), part_names=["a"]),
        "parts",
        "float64",
    ),
    "npz part out of range": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=[0] * 11 + [-1], part_names=["a"]),
        "parts[11]",
        "-1",
    ),
    "npz parts without names": ("a.npz", npz_bytes(triangles=BOX, parts=ZEROS), "part_names", "no"),
    "npz names without parts": (
        "a.npz",
        npz_bytes(triangles=BOX, part_names=["a", "b"]),
        "parts",
        "2 part names",
    ),
    "npz names of numbers": (
        "a.npz",
        npz_bytes(triangles=BOX, parts=ZEROS, part_names=[1]),
        "part_names",
        "unicode",
    ),
    # obj
    "obj empty": ("a.obj", b"", "triangles", "none"),
    "obj without faces": ("a.obj", V.encode(), "triangles", "none"),
    "obj with faces of two only": ("a.obj", f"{V}f 1 2\n".encode(), "triangles", "none"),
    "obj binary": ("a.obj", b"\x89PNG\0\0\0", "file", "binary"),
    "obj index too high": ("a.obj", f"{V}f 1 2 3\nf 1 2 5\n".encode(), "line 6", "f 1 2 5"),
    "obj index too low": ("a.obj", f"{V}f 1 2 -5\n".encode(), "line 5", "f 1 2 -5"),
    "obj index 0": ("a.obj", f"{V}f 0 1 2\n".encode(), "line 5", "f 0 1 2"),
    "obj index 0 before more": ("a.obj", f"{V}f 0 1 2\n{V}".encode(), "line 5", "f 0 1 2"),
    "obj index too long": ("a.obj", f"{V}f 1 2 {HUGE[:99]}\n".encode(), "line 5", "f 1 2 999"),
    "obj index beyond int": ("a.obj", f"{V}f 1 2 {HUGE}\n".encode(), "line 5", "f 1 2 999"),
    "obj index after continuation": (
        "a.obj",
        f"{V}f 1 2 \\\n3\nf 1 \\\n 2 7\n".encode(),
        "line 7",
        "f 1 2 7",
    ),
    "obj index after two vertices": ("a.obj", f"{V}f 1 2\nf 1 2 5\n".encode(), "line 6", "2 5"),
    "obj without an index": (
        "a.obj",
        f"{V}f 1 2 /3\n".encode(),
        "line 5",
        "indices, found 'f 1 2 /3'",
    ),
    "obj with a word": ("a.obj", b"v 0 0 zero\n", "line 1", "three numbers, found 'v 0 0 zero'"),
    "obj with two numbers": ("a.obj", b"\r\n\rv 0 0\n", "line 3", "v 0 0"),
    "obj of NaN": ("a.obj", b"v 0 0 0\nv 0 nan 0\n", "line 2", "nan"),
    "obj of NaN, third": ("a.obj", f"{V}v 0 0 nan\n".encode(), "line 5", "nan"),
    "obj of inf": ("a.obj", b"# c\nv 0 0 1e999\n", "line 2", "1e999"),
    # stl
    "stl empty": ("a.stl", b"", "header", "0 bytes"),
    "stl of text": ("a.stl", b"hello" * 99, "length", "495"),
    "stl cut": ("a.stl", cut(stl_binary()), "length", "12 triangles"),
    "stl cut, solid": ("a.stl", cut(stl_binary(b"solid")), "length", "12 triangles"),
    "stl with a tail": ("a.stl", stl_binary() + b"\0", "length", "12 triangles"),
    "stl of no triangles": ("a.stl", stl_binary(triangles=BOX[:0]), "triangles", "none"),
    "stl of NaN": ("a.stl", stl_binary(triangles=NAN[FACES]), "triangles[0]", "nan"),
    "stl of signalling NaN": (
        "a.stl",
        stl_binary()[:96] + b"\x01\0\x80\x7f" + stl_binary()[100:],
        "triangles[0]",
        "nan",
    ),
    "stl ascii, empty": ("a.stl", b"solid a\nendsolid a", "triangles", "none"),
    "stl ascii, cut": ("a.stl", stl_ascii()[:-14], "line 85", "endsolid"),
    "stl ascii, NaN": ("a.stl", stl_ascii(triangles=NAN[FACES]), "triangles[0]", "nan"),
    "stl ascii, a word": ("a.stl", b"solid\nvertex 0 0 zero", "line 2", "zero"),
    "stl ascii, two numbers": ("a.stl", b"solid\nvertex 0 0", "line 2", "vertex 0 0"),
    "stl ascii, two corners": (
        "a.stl",
        b"solid\n" + b"vertex 0 0 0\n" * 2 + b"endfacet\nendsolid",
        "line 4",
        "found 2",
    ),
    "stl ascii, facet open": (
        "a.stl",
        b"solid\n" + b"vertex 0 0 0\n" * 3 + b"endsolid",
        "line 5",
        "found 6",
    ),
    "stl ascii, outside": ("a.stl", b"solid\nendsolid\nvertex 0 0 0", "line 3", "inside"),
    "stl ascii, nested": ("a.stl", b"solid a\nsolid b\n", "line 2", "endsolid"),
    "stl ascii, other text": ("a.stl", b"solid ground\nis good", "line 2", "'is'"),
    # ply
    "ply empty": ("a.ply", b"", "header", "'ply'"),
    "ply of text": ("a.ply", b"plywood", "header", "plywood"),
    "ply without an end": ("a.ply", b"ply\nformat ascii 1.0\n", "header", "end_header"),
    "ply without a format": ("a.ply", b"ply\nend_header\n", "header", "format"),
    "ply of no known format": ("a.ply", ply_with("ascii", "utf8"), "line 2", "utf8"),
    "ply of no known type": ("a.ply", ply_with("float y", "real y"), "line 6", "real y"),
    "ply of no known length": ("a.ply", ply_with("list uchar", "list u"), "line 9", "list u int"),
    "ply property first": ("a.ply", ply_with("element vertex 8\n", ""), "line 4", "property"),
    "ply format last": ("a.ply", ply_with("format ascii 1.0\n", ""), "line 4", "property"),
    "ply of no known keyword": ("a.ply", ply_with("comment", "comet"), "line 3", "comet"),
    "ply with a wrong count": ("a.ply", ply_with("vertex 8", "vertex -8"), "line 4", "-8"),
    "ply with a huge count": ("a.ply", ply_with("vertex 8", f"vertex {HUGE}"), "line 4", "999"),
    "ply with a property twice": ("a.ply", ply_with("float y", "float x"), "line 6", "'x'"),
    "ply without y": ("a.ply", ply_with("float y", "float u"), "element vertex", "x, u, z"),
    "ply without vertices": ("a.ply", ply_with("vertex 8", "v 8"), "element vertex", "none"),
    "ply without faces": ("a.ply", ply_with("face 12", "facet 12"), "element face", "none"),
    "ply without lists": (
        "a.ply",
        ply_with("vertex_indices", "indices"),
        "element face",
        "found indices",
    ),
    "ply of words": ("a.ply", ply_ascii() + b" zero", "data", "zero"),
    "ply, more vertices": ("a.ply", ply_with("vertex 8", "vertex 9999"), "element vertex", "9999"),
    "ply, more faces": ("a.ply", ply_with("face 12", "face 13"), "element face", "in row 12"),
    "ply of half a corner": ("a.ply", ply_ascii() + b".5", "face[11]", "found"),
    "ply of half a length": (
        "a.ply",
        ply_with("3 0 1 3", "2.5 0 1 3"),
        "face[0]",
        "2.5",
    ),
    "ply of a length below 0": ("a.ply", ply_with("3 0 1 3", "-3 0 1 3"), "face[0]", "-3"),
    "ply cut": ("a.ply", cut(ply_binary(">")), "element face", "in row 11"),
    "ply of no triangles": ("a.ply", ply_binary("<", faces=NO_FACES), "triangles", "none"),
    "ply of pairs": ("a.ply", ply_binary("<", faces=FACES[:, :2]), "triangles", "none"),
    "ply index too high": (
        "a.ply",
        ply_binary("<", faces=[(0, 1, 2), (0, 1, 2, 8)]),
        "face[1]",
        "found 8",
    ),
    "ply index too low": ("a.ply", ply_binary(">", faces=[(0, 1, -1)]), "face[0]", "found -1"),
    "ply ascii, index": ("a.ply", ply_ascii(faces=[(0, 1, 1e300)]), "face[0]", "1e+300"),
    "ply ascii, NaN index": ("a.ply", ply_ascii(faces=[(0, 1, np.nan)]), "face[0]", "nan"),
    "ply of NaN": ("a.ply", ply_ascii(NAN), "triangles[0]", "nan"),
    "ply of inf": ("a.ply", ply_binary("<", INF), "triangles[0]", "inf"),
    # glb
    "glb empty": ("a.glb", b"", "header", "glTF"),
    "glb of JSON": ("a.glb", b'{"asset": {}}', "header", "asset"),
    "glb version 1": ("a.glb", struct.pack("<4sII", b"glTF", 1, 12), "version", "1"),
    "glb cut": ("a.glb", cut(glb_file(*gltf())), "length", "bytes"),
    "glb without JSON": ("a.glb", struct.pack("<4sII", b"glTF", 2, 12), "chunk JSON", "none"),
    "glb with a long chunk": (
        "a.glb",
        struct.pack("<4sIII4s", b"glTF", 2, 20, 9, b"JSON"),
        "chunk b'JSON'",
        "9 bytes",
    ),
    "glb of no JSON": ("a.glb", glb_file(b"{no}", b""), "JSON", "valid"),
    "glb of deep JSON": ("a.glb", glb_file(b"[" * 200000, b""), "JSON", "valid"),
    "glb of a list": ("a.glb", glb_file([], b""), "JSON", "list"),
    "glb of nothing": ("a.glb", glb_file({}, b""), "triangles", "none"),
    "glb of other JSON": ("a.glb", changed("meshes", 0, {}), "JSON", "primitives"),
    "glb with null": ("a.glb", changed("nodes", None), "JSON", "NoneType"),
    "glb with Draco": (
        "a.glb",
        changed("extensionsRequired", ["KHR_draco_mesh_compression"]),
        "extensionsRequired",
        "KHR_draco_mesh_compression",
    ),
    "glb with meshopt": (
        "a.glb",
        changed("extensionsRequired", ["EXT_meshopt_compression"]),
        "extensionsRequired",
        "EXT_meshopt_compression",
    ),
    "glb sparse": ("a.glb", changed("accessors", 0, "sparse", {}), "accessors[0]", "sparse"),
    "glb without data": ("a.glb", changed("accessors", 0, {}), "accessors[0]", "no bufferView"),
    "glb of pairs": ("a.glb", changed("accessors", 0, "type", "VEC2"), "accessors[0]", "VEC2"),
    "glb of no known type": (
        "a.glb",
        changed("accessors", 0, "componentType", 5130),
        "accessors[0]",
        "5130",
    ),
    "glb, count below 0": (
        "a.glb",
        changed("accessors", 0, "count", -1),
        "accessors[0].count",
        "-1",
    ),
    "glb, count 0": ("a.glb", changed("accessors", 0, "count", 0), "accessors[0]", "found 0"),
    "glb, too many": ("a.glb", changed("accessors", 0, "count", 9), "accessors[0]", "found 9"),
    "glb, stride": ("a.glb", changed("bufferViews", 0, "byteStride", 4), "accessors[0]", "4 apart"),
    "glb, view too long": (
        "a.glb",
        changed("bufferViews", 1, "byteLength", 999),
        "bufferViews[1]",
        "999",
    ),
    "glb, no such view": (
        "a.glb",
        changed("accessors", 0, "bufferView", 2),
        "bufferViews",
        "found 2",
    ),
    "glb, other file": (
        "a.glb",
        changed("buffers", 0, "uri", "a.bin"),
        "bufferViews[0]",
        "another buffer",
    ),
    "glb, no such node": ("a.glb", changed("nodes", 0, "children", [-1]), "nodes", "-1"),
    "glb, no such mesh": ("a.glb", changed("nodes", 0, "mesh", 1), "meshes", "found 1"),
    "glb, no such scene": ("a.glb", changed("scene", True), "scenes", "True"),
    "glb, a node no object": ("a.glb", changed("nodes", [7]), "nodes[0]", "int"),
    "glb, loop": ("a.glb", changed("nodes", 0, "children", [0]), "nodes[0]", "loop"),
    "glb, matrix": ("a.glb", changed("nodes", 0, "matrix", [1]), "nodes[0].matrix", "16"),
    "glb, scale": ("a.glb", changed("nodes", 0, "scale", [2.0]), "nodes[0].scale", "[2.0]"),
    "glb, translation": (
        "a.glb",
        changed("nodes", 0, "translation", ["a", 0, 0]),
        "nodes[0].translation",
        "'a'",
    ),
    "glb, huge translation": (
        "a.glb",
        changed("nodes", 0, "translation", [10**400, 0, 0]),
        "nodes[0].translation",
        "3 finite",
    ),
    "glb, beyond any number": (
        "a.glb",
        changed("nodes", 0, "scale", [1e308, 1e308, 1e308]),
        "triangles[0]",
        "inf",
    ),
    "glb, rotation": (
        "a.glb",
        changed("nodes", 0, "rotation", [0, 0, 0, 0]),
        "nodes[0].rotation",
        "quaternion",
    ),
    "glb, skin": ("a.glb", changed("nodes", 0, "skin", 0), "nodes[0]", "skin"),
    "glb, morphed": ("a.glb", changed("nodes", 0, "weights", [0, 0.5]), "nodes[0]", "morph"),
    "glb, index": ("a.glb", glb_file(*gltf(indices=[0, 1, 8])), "accessors[1]", "up to 8"),
    "glb, four corners": ("a.glb", glb_file(*gltf(indices=[0, 1, 2, 3])), "primitive", "4"),
    "glb, strip of two": ("a.glb", glb_file(*gltf(indices=[0, 1], mode=5)), "triangles", "none"),
    "glb of NaN": ("a.glb", glb_file(*gltf(points=NAN)), "triangles[0]", "nan"),
    "glb of inf": ("a.glb", glb_file(*gltf(points=INF)), "triangles[0]", "expected finite"),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("name", "data", "field", "words"), BAD.values(), ids=BAD.keys())
def test_bad_input_is_told_in_one_line(
    tmp_path: Path, name: str, data: bytes, field: str, words: str
) -> None:
    """The error names the file and the field and says what was there; NumPy does not warn."""
    with pytest.raises(InputError) as caught:
        read(tmp_path, name, data)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path / name}: {field}: expected ")
    assert words in message.removeprefix(f"{tmp_path / name}: {field}: ")
    assert "\n" not in message


@pytest.mark.parametrize("name", ["a.npz", "a.obj", "a.stl", "a.ply", "a.glb"])
@pytest.mark.parametrize("folder", [False, True], ids=["missing", "a folder"])
def test_files_that_cannot_be_read(tmp_path: Path, name: str, folder: bool) -> None:
    """A missing file and a folder in its place are told of like any other bad input."""
    if folder:
        (tmp_path / name).mkdir()
    with pytest.raises(InputError) as caught:
        read_mesh(tmp_path / name)
    expected = "a readable file" if folder else "an existing file"
    assert str(caught.value).startswith(f"{tmp_path / name}: file: expected {expected}")


def test_a_path_no_file_can_have() -> None:
    """A NUL in the path is told of like a missing file."""
    with pytest.raises(InputError, match="file: expected a readable file, found embedded null"):
        read_mesh("a\0.obj")


BINARY: dict[str, Callable[[], bytes]] = {
    "box.npz": lambda: npz_bytes(triangles=BOX),
    "box.stl": stl_binary,
    "box.ply": lambda: ply_binary("<"),
    "x.glb": lambda: glb_file(*gltf()),
}


@pytest.mark.parametrize(("name", "make"), BINARY.items(), ids=BINARY.keys())
def test_a_binary_file_cut_anywhere_is_an_error(
    tmp_path: Path, name: str, make: Callable[[], bytes]
) -> None:
    """No cut, wherever it falls, gives a mesh or any other exception."""
    data = make()
    for end in range(len(data)):
        with pytest.raises(InputError):
            read(tmp_path, name, data[:end])
