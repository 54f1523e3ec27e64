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

BAD = {
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
}


test_bad_input_is_reported_in_one_line = one_line_test(BAD)
