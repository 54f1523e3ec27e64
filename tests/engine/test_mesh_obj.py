"""OBJ files: parts, every form a face can have, shared vertices, and every error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pe_tools.formats.meshes import Mesh, obj, write_mesh
from tests.engine.mesh_files import BOX, HUGE, SQUARE, one_line_test, read


def test_obj_vertices_are_shared(tmp_path: Path) -> None:
    """The box is written with its 8 vertices, not with 36."""
    write_mesh(tmp_path / "box.obj", Mesh(BOX, np.zeros(12, np.int32), ("box",)))
    assert (tmp_path / "box.obj").read_text().count("\nv ") == 8


CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\n"
FACE = "f 1 2 3\n"
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


def both(data: bytes) -> tuple[Mesh | None, Mesh]:
    """What a file is in blocks, None if they do not have it, and what it is line by line."""
    return obj._read_blocks(Path("car.obj"), data), obj._read_lines(Path("car.obj"), data)


def same(a: Mesh, b: Mesh) -> bool:
    """Whether two meshes are alike to the bit."""
    names, parts = a.part_names == b.part_names, a.parts.tolist() == b.parts.tolist()
    return names and parts and a.triangles.tobytes() == b.triangles.tobytes()


@pytest.mark.parametrize("text", [*OBJ_FORMS.values(), *(CORNERS + t for t, _ in PARTS.values())])
def test_blocks_say_what_lines_say_or_nothing(text: str) -> None:
    """Whatever is not written as programs do is left to those who read lines."""
    fast, slow = both(text.encode())
    assert fast is None or same(fast, slow)


@pytest.mark.parametrize("seed", range(6))
def test_blocks_read_random_files_to_the_bit(seed: int) -> None:
    """Numbers of any length, names between faces, triangles alone or polygons, either ending."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(300, 3)) * 10.0 ** rng.integers(-12, 12, (300, 3))
    form = ("{!r}", "{:.6f}", "{:e}")[seed % 3]
    colours = " 0.5 1 .25" if seed % 2 else ""
    lines = ["# made", "mtllib a.mtl", "o first"]
    lines += ["v " + " ".join(form.format(x) for x in row) + colours for row in points.tolist()]
    for k in range(400):
        corners = rng.integers(1, 301, 3 if seed < 3 else rng.integers(2, 6)).tolist()
        tail = ("", "/7", "//12", "/3/4")[seed % 4]
        lines += [f"o Teil ä{k}"] * (k % 90 == 0) + ["vn 0 0 1", "s off"] * (k % 70 == 0)
        lines.append("f " + " ".join(f"{i}{tail}" for i in corners))
    fast, slow = both(("\r\n" if seed % 2 else "\n").join(lines).encode())
    assert fast is not None and same(fast, slow)
    assert len(fast.part_names) == 5


@pytest.mark.parametrize(
    "line",
    ["v 1 2 3v", "v 1_0 2 3", "v 1 2 -", "v 1 2", "f 1 2 /3", "f 1 f 3", "f 1 2 3 #", " v 1 2 3"],
)
def test_what_is_not_as_programs_write_it_is_not_read_in_blocks(line: str) -> None:
    """One line among good ones: it is an error, or read by who reads lines."""
    data = f"{V}{line}\nf 1 2 3\n".encode()
    assert obj._read_blocks(Path("car.obj"), data) is None


BAD = [
    ("triangles", b""),
    ("triangles", V.encode()),
    ("triangles", f"{V}f 1 2\n".encode()),
    ("file", b"\x89PNG\0\0\0"),
    ("line 6", f"{V}f 1 2 3\nf 1 2 5\n".encode()),
    ("line 5", f"{V}f 1 2 -5\n".encode()),
    ("line 5", f"{V}f 0 1 2\n".encode()),
    ("line 5", f"{V}f 0 1 2\n{V}".encode()),
    ("line 5", f"{V}f 1 2 {HUGE[:99]}\n".encode()),
    ("line 5", f"{V}f 1 2 {HUGE}\n".encode()),
    ("line 7", f"{V}f 1 2 \\\n3\nf 1 \\\n 2 7\n".encode()),
    ("line 6", f"{V}f 1 2\nf 1 2 5\n".encode()),
    ("line 5", f"{V}f 1 2 /3\n".encode()),
    ("line 1", b"v 0 0 zero\n"),
    ("line 3", b"\r\n\rv 0 0\n"),
    ("line 2", b"v 0 0 0\nv 0 nan 0\n"),
    ("line 5", f"{V}v 0 0 nan\n".encode()),
    ("line 2", b"# c\nv 0 0 1e999\n"),
]


test_bad_input_is_refused_in_one_line = one_line_test(BAD, "a.obj")
