"""STL files: solids are parts, and every error."""

from __future__ import annotations

from pathlib import Path

from tests.engine.mesh_files import (
    BOX,
    FACES,
    NAN,
    TRIANGLE,
    cut,
    one_line_test,
    read,
    stl_ascii,
    stl_binary,
)

SOLID = stl_ascii("{}", TRIANGLE).decode()


def test_stl_solids_are_parts(tmp_path: Path) -> None:
    """Each solid is a part, one of a repeated name is the same part, a nameless is the stem."""
    text = "".join("  " + SOLID.format(name, name) for name in ("a b", "", "c", "a b"))
    mesh = read(tmp_path, "car.stl", text.encode())
    assert mesh.part_names == ("a b", "car", "c")
    assert mesh.parts.tolist() == [0, 1, 2, 0]


BAD = {
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
}


test_bad_input_is_reported_in_one_line = one_line_test(BAD)
