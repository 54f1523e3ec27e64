"""OBJ files: parts, the forms that a face can have, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.engine.mesh_files import HUGE, SQUARE, one_line_test, read, turned_alike

CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\n"
FACE = "f 1 2 3\n"
PARTS = {
    "o wins over g": (f"g a\no b\n{FACE}g c\n{FACE}o d\n{FACE}", ["b", "b", "d"]),
    "g without any o": (f"g a\n{FACE}g b c\n{FACE}", ["a", "b c"]),
    "before the first name": (f"{FACE}o a\n{FACE}", ["car", "a"]),
    "a name twice": (f"o a\n{FACE}o b\n{FACE}o a\n{FACE}", ["a", "a", "b"]),
    "a part without triangles": (f"o a\no b\n{FACE}o c\n", ["b"]),
    "a name with spaces and #": (f"  o\t  front #1  left \n{FACE}", ["front #1  left"]),
    "Latin-1": (f"o Räder\n{FACE}", ["Räder"]),
}


@pytest.mark.parametrize(("text", "names"), PARTS.values(), ids=PARTS.keys())
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig"])
def test_obj_parts(tmp_path: Path, text: str, names: list[str], encoding: str) -> None:
    """Which part each face belongs to, by o or g, in any of the usual encodings."""
    mesh = read(tmp_path, "car.obj", (CORNERS + text).encode(encoding))
    assert [mesh.part_names[part] for part in mesh.parts] == names
    assert len(mesh.part_names) == len(set(names))


V = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
OBJ_FORMS = {
    "quad": f"{V}f 1 2 3 4\n",
    "faces first": f"f 1 2 3 4\n{V}",
    "v/vt/vn": f"{V}f 1/9/9 2/9/9 3/9/9 4/9/9\n",
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
    triangles = read(tmp_path, "s.obj", text.encode()).triangles
    assert turned_alike(triangles) == turned_alike(SQUARE)


BAD = [
    ("triangles", b""),
    ("triangles", V.encode()),
    ("triangles", f"{V}f 1 2\n".encode()),
    ("file", b"\x89PNG\0\0\0"),
    ("file", f"{V}f 1 2 3\nf 1 2 5\n".encode()),
    ("faces", f"{V}f 1 2 -5\n".encode()),
    ("faces", f"{V}f -4 -3 -2 -1\nv 9 9 9\n".encode()),
    ("faces", f"{V}f 0 1 2\n".encode()),
    ("file", f"{V}f 1 2 {HUGE}\n".encode()),
    ("file", b"v 0 0 zero\n"),
    ("triangles[0]", f"{V}v 0 0 nan\nf 1 2 5".encode()),
]


test_bad_input_is_refused_in_one_line = one_line_test(BAD, "a.obj")
