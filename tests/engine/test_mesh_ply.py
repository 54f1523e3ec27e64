"""PLY files: vertices and faces among other data, and every error."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from tests.engine.mesh_files import (
    FACES,
    HUGE,
    INF,
    NAN,
    POINTS,
    cut,
    one_line_test,
    ply_ascii,
    ply_binary,
    read,
)


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


def ply_with(old: str, new: str) -> bytes:
    text = ply_ascii().decode()
    assert old in text
    return text.replace(old, new, 1).encode()


NO_FACES = np.zeros((0, 3), int)

BAD = [
    ("header", b""),
    ("header", b"plywood"),
    ("header", b"ply\nformat ascii 1.0\n"),
    ("header", b"ply\nend_header\n"),
    ("line 2", ply_with("ascii", "utf8")),
    ("line 6", ply_with("float y", "real y")),
    ("line 9", ply_with("list uchar", "list u")),
    ("line 4", ply_with("element vertex 8\n", "")),
    ("line 4", ply_with("format ascii 1.0\n", "")),
    ("line 3", ply_with("comment", "comet")),
    ("line 4", ply_with("vertex 8", "vertex -8")),
    ("line 4", ply_with("vertex 8", f"vertex {HUGE}")),
    ("line 6", ply_with("float y", "float x")),
    ("element vertex", ply_with("float y", "float u")),
    ("element vertex", ply_with("vertex 8", "v 8")),
    ("element face", ply_with("face 12", "facet 12")),
    ("element face", ply_with("vertex_indices", "indices")),
    ("data", ply_ascii() + b" zero"),
    ("element vertex", ply_with("vertex 8", "vertex 9999")),
    ("element face", ply_with("face 12", "face 13")),
    ("face[11]", ply_ascii() + b".5"),
    ("face[0]", ply_with("3 0 1 3", "2.5 0 1 3")),
    ("face[0]", ply_with("3 0 1 3", "-3 0 1 3")),
    ("element face", cut(ply_binary(">"))),
    ("triangles", ply_binary("<", faces=NO_FACES)),
    ("triangles", ply_binary("<", faces=FACES[:, :2])),
    ("face[1]", ply_binary("<", faces=[(0, 1, 2), (0, 1, 2, 8)])),
    ("face[0]", ply_binary(">", faces=[(0, 1, -1)])),
    ("face[0]", ply_ascii(faces=[(0, 1, 1e300)])),
    ("face[0]", ply_ascii(faces=[(0, 1, np.nan)])),
    ("triangles[0]", ply_ascii(NAN)),
    ("triangles[0]", ply_binary("<", INF)),
]


test_bad_input_is_refused_in_one_line = one_line_test(BAD, "a.ply")
