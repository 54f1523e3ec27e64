"""Mesh files made by hand: a box in every format, whole and spoiled."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pe_tools.formats.meshes import Mesh, MeshAxes, read_mesh
from tests.engine.refusals import wrongly_refused
from tests.engine.shapes import BOX_FACES

# A box with three different sides, so that no two axes can be mistaken for each other; its
# coordinates are exact in single precision.
POINTS = np.array([(x, y, z) for x in (-1.0, 4.0) for y in (-1.0, 1.5) for z in (0.25, 2.0)])
QUADS = np.array(BOX_FACES)
FACES = np.array([face for a, b, c, d in QUADS.tolist() for face in ((a, b, c), (a, c, d))])
BOX = POINTS[FACES]
SQUARE = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], float)
ZEROS = np.zeros(12, np.int32)  # the part of each triangle
NAN = POINTS.copy()
INF = POINTS.copy()
NAN[0, 1] = np.nan
INF[0, 1] = np.inf
HUGE = "9" * 5000


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
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(positions) // 12},
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


def read(folder: Path, name: str, data: bytes, **axes: Any) -> Mesh:
    path = folder / name
    path.write_bytes(data)
    return read_mesh(path, MeshAxes(**axes))


def cut(data: bytes) -> bytes:
    return data[:-1]


def one_line_test(rows: list[tuple[str, Any]], name: str = "") -> Callable[..., None]:
    """Return a test of wrong files: (field, data), or (field, (name, data)) without a `name`."""

    @pytest.mark.filterwarnings("error")
    def test(tmp_path: Path) -> None:
        """The error names the file and the field; NumPy does not warn."""

        def reading(given: Any) -> None:
            read(tmp_path, *((name, given) if name else given))

        assert wrongly_refused(reading, rows, tmp_path) == []

    return test


def turned_alike(triangles: np.ndarray) -> list:
    """Triangles in any order, each from its least corner on, with the same side outside."""
    corners = [[tuple(corner) for corner in triangle] for triangle in triangles.tolist()]
    firsts = [triangle.index(min(triangle)) for triangle in corners]
    return sorted(t[k:] + t[:k] for t, k in zip(corners, firsts, strict=True))
