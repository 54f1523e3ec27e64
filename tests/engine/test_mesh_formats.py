"""Mesh files: every format reads the same box; names, sizes, and what is refused."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.errors import InputError
from pe_core.base.values import MAX_NAME
from pe_tools.formats.meshes import Mesh, obj, read_mesh, write_mesh
from pe_tools.formats.meshes.mesh import fit_names
from tests.engine import shapes
from tests.engine.mesh_files import (
    BOX,
    FACES,
    NAN,
    POINTS,
    QUADS,
    ZEROS,
    changed,
    cut,
    glb_file,
    gltf,
    npz_bytes,
    obj_bytes,
    one_line_test,
    ply_ascii,
    ply_binary,
    read,
    stl_ascii,
    stl_binary,
    turned_alike,
)

BOXES = {
    "npz": ("box.npz", npz_bytes(triangles=BOX)),
    "obj": ("box.obj", obj_bytes()),
    "suffix in capitals": ("box.OBJ", obj_bytes()),
    "stl, binary": ("box.stl", stl_binary()),
    "stl, binary beginning with solid": ("box.stl", stl_binary(b"solid as a rock")),
    "stl, ascii": ("box.stl", stl_ascii()),
    "stl, ascii without a name": ("box.stl", stl_ascii("")),
    "ply, ascii": ("box.ply", ply_ascii()),
    "ply, big endian quads": ("box.ply", ply_binary(">", faces=QUADS)),
    "glb, 32-bit indices": ("x.glb", glb_file(*gltf(code="I"))),
    "glb, no indices": ("x.glb", glb_file(*gltf(points=BOX, indices=None))),
}
UNWRITABLE = {
    "suffix": ("box.ply", Mesh(BOX, ZEROS, ("box",)), "suffix"),
    "folder": ("none/box.npz", Mesh(BOX, ZEROS, ("box",)), "file"),
    "nan": ("box.obj", Mesh(BOX * np.nan, ZEROS, ("box",)), "triangles[0]"),
    "empty": ("box.obj", Mesh(BOX[:0], ZEROS[:0], ("box",)), "triangles"),
    "flat": ("box.obj", Mesh(BOX[0], ZEROS[:3], ("box",)), "triangles"),
    "parts too few": ("box.npz", Mesh(BOX, ZEROS[1:], ("box",)), "parts"),
    "part without a name": ("box.npz", Mesh(BOX, ZEROS + 1, ("box",)), "parts[0]"),
    "two lines": ("box.obj", Mesh(BOX, ZEROS, ("a\nb",)), "part_names"),
    "no name": ("box.obj", Mesh(BOX, ZEROS, ("",)), "part_names"),
    "no unicode": ("box.obj", Mesh(BOX, ZEROS, ("\udc80",)), "part_names"),
}
LONG = "x" * 300
CAR = np.array([4.5, 1.8, 1.5])
CORNERS = "v 0 0 0\nv 1 0 0\nv 1 1 0\n"
FACE = "f 1 2 3\n"
PARTS = {
    "o wins over g": (f"g a\no b\n{FACE}g c\n{FACE}o d\n{FACE}", ["b", "b", "d"]),
    "before the first name": (f"{FACE}o\ta\nf 1 2 \\\n3\n", ["car", "a"]),
    "a name with spaces and #": (f"  o\t  front #1  left \n{FACE}", ["front #1  left"]),
    "Latin-1": (f"o Räder\n{FACE}", ["Räder"]),
}


@pytest.mark.parametrize(("name", "data"), BOXES.values(), ids=BOXES.keys())
def test_the_same_box_comes_out_of_every_format(tmp_path: Path, name: str, data: bytes) -> None:
    """Corners, their order, the axes, the types and the one part agree in all formats."""
    mesh = read(tmp_path, name, data)
    assert mesh.triangles.dtype == np.float64
    assert mesh.parts.dtype == np.int32
    assert turned_alike(mesh.triangles) == turned_alike(BOX)
    assert mesh.parts.tolist() == [0] * 12
    assert mesh.part_names == ("box",)


def test_npz_parts_are_merged_and_dropped(tmp_path: Path) -> None:
    """Of four names one is repeated and one has no triangles: two are left."""
    names = np.array(["a", "unused", "b", "a"])
    data = npz_bytes(triangles=BOX[:3], parts=np.array([3, 2, 0]), part_names=names)
    mesh = read(tmp_path, "car.npz", data)
    assert mesh.part_names == ("a", "b")
    assert mesh.parts.tolist() == [0, 1, 0]


@pytest.mark.parametrize("labels", [[0, 0, 1, 2], [2, 0, 1, 0]], ids=["in order", "mixed"])
def test_written_archives_read_back_exactly(tmp_path: Path, labels: list[int]) -> None:
    """Every bit of every coordinate (-0.0 and tiny ones too), every part and its place."""
    scales = 10.0 ** np.arange(-150, 150, 75)[:, None, None]
    triangles = np.random.default_rng(1).normal(size=(4, 3, 3)) * scales
    triangles[0, 0] = (0.0, -0.0, 5e-324)
    mesh = Mesh(triangles, np.array(labels, np.int32), ("Rad #1 – links", "g", "o"))
    write_mesh(tmp_path / "mesh.npz", mesh)
    back = read_mesh(tmp_path / "mesh.npz")
    assert back.triangles.tobytes() == triangles.tobytes()
    assert back.parts.tolist() == labels
    assert back.part_names == mesh.part_names


@pytest.mark.parametrize(("name", "mesh", "field"), UNWRITABLE.values(), ids=UNWRITABLE.keys())
def test_what_could_not_be_read_back_is_not_written(
    tmp_path: Path, name: str, mesh: Mesh, field: str
) -> None:
    """The error names file and field, and no file appears."""
    with pytest.raises(InputError) as caught:
        write_mesh(tmp_path / name, mesh)
    assert str(caught.value).startswith(f"{tmp_path / name}: {field}: expected ")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("names", "fit"),
    [
        (["Räder #1", " a", "車"], ["Räder #1", " a", "車"]),
        (["a\nb", "c\x1b[2Jd", "e\u202ef", "g\ud800"], ["a?b", "c?[2Jd", "e?f", "g?"]),
        (["", "  ", "\n"], ["?", "? (2)", "? (3)"]),
        (["a\x01", "a\x02", "a\x03"], ["a?", "a? (2)", "a? (3)"]),
        (["a\x01", "a?", "a? (2)", "a\x02"], ["a? (3)", "a?", "a? (2)", "a? (4)"]),
        ([f"{LONG}a", f"{LONG}b"], ["x" * 243, f"{'x' * 243} (2)"]),
    ],
    ids=["fit", "unprintable", "empty", "alike", "taken", "long"],
)
def test_names_are_made_fit_and_stay_different(names: list[str], fit: list[str]) -> None:
    """Names that are fit stay, even where another name becomes like one of them."""
    assert list(fit_names(names)) == fit
    assert all(name.isprintable() and len(name) <= MAX_NAME for name in fit)


def body(size, floor=None):
    """A study of a box of this size on the ground, perhaps on a floor so long."""
    low = np.array([-0.5, -0.5, 0.0]) * size
    high = np.array([0.5, 0.5, 1.0]) * size
    triangles = shapes.box(low, high)
    parts = np.zeros(len(triangles), np.int32)
    names = ["body"]
    if floor is not None:
        ground = shapes.box((-floor / 2, -floor / 2, -0.1), (floor / 2, floor / 2, 0.0))
        triangles = np.concatenate([triangles, ground])
        parts = np.append(parts, np.ones(len(ground), np.int32))
        names = ["body", "floor"]
    rig = pe.Rig([shapes.lidar_on_roof()])
    return pe.Study(rig, pe.Vehicle(triangles, parts, names), mesh="body.npz")


def test_too_small_too_large_and_too_wide():
    """The car of a unit cube, the suv of a hangar's size, and a body as wide as it is long."""
    with pytest.raises(pe.InputError, match=r"0\.045 x .*scale = 100 if units of 100 m \(4\.5"):
        body(CAR / 100)
    with pytest.raises(pe.InputError, match=r"found 44\.00 x 84\.00 x 36\.00 m"):
        body(np.array([44.0, 84.0, 36.0]))
    with pytest.raises(pe.InputError, match="and up to 25 m wide"):
        body(np.array([50.0, 40.0, 10.0]))
    with pytest.raises(pe.InputError, match="all of it is one point"):
        body(np.zeros(3))


def test_no_weight_outside_the_vehicle_names_the_mesh():
    space = pe.PerceptionSpace((-1.0, 1.0), (-0.5, 0.5), (0.0, 1.0), 0.5)
    study = body(CAR)
    study = pe.Study(study.rig, study.vehicle, space, mesh="body.npz")
    with pytest.raises(pe.InputError, match=r"none; body\.npz: 4\.50 x 1\.80 x 1\.50 m"):
        study.evaluator()


def test_glb_surfaces_of_one_mesh_are_one_part(tmp_path: Path) -> None:
    """Blender writes a surface a material; points and lines are left out."""
    root, binary = gltf()
    primitives = root["meshes"][0]["primitives"]
    primitives += [primitives[0], *({"attributes": {"POSITION": 0}, "mode": m} for m in (0, 1))]
    mesh = read(tmp_path, "x.glb", glb_file(root, binary))
    assert len(mesh.triangles) == 24 and mesh.part_names == ("box",)


@pytest.mark.parametrize(("text", "names"), PARTS.values(), ids=PARTS.keys())
@pytest.mark.parametrize("encoding", ["latin-1", "utf-8-sig"])
def test_parts_of_an_obj(tmp_path: Path, text: str, names: list[str], encoding: str) -> None:
    mesh = read(tmp_path, "car.obj", (CORNERS + text).encode(encoding))
    assert [mesh.part_names[part] for part in mesh.parts] == names


def no_array(name: str, **arrays: Any) -> bytes:
    """An archive in which one member is no array, but text."""
    buffer = io.BytesIO(npz_bytes(**arrays))
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr(f"{name}.npy", b"no array at all")
    return buffer.getvalue()


def test_indices_of_an_obj_may_count_backwards(tmp_path: Path) -> None:
    """-1 is the last vertex so far, not the last of the file."""
    backwards = f"{CORNERS}f -3 -2 -1\nv 9 9 9\nf 1 -1 2\n".encode()
    forwards = f"{CORNERS}v 9 9 9\nf 1 2 3\nf 1 4 2\n".encode()
    meshes = [read(tmp_path, "a.obj", data) for data in (backwards, forwards)]
    assert meshes[0].triangles.tolist() == meshes[1].triangles.tolist()


@pytest.mark.parametrize("at_once", [1, 2, 100])
def test_what_follows_a_slash_of_an_obj_is_no_vertex(tmp_path: Path, at_once: int) -> None:
    """Words with and without slashes, in blocks of lines of any size."""
    plain = f"{CORNERS}f 1 2 3\nf 3 2 1\nf 1 3 2\n".encode()
    slashed = f"{CORNERS}f 1/7 2//8 3\nf 3/1/2  2 1/ # f 9/9\nf 1 3 2/5\n".encode()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(obj, "LINES_AT_ONCE", at_once)
        meshes = [read(tmp_path, "a.obj", data) for data in (plain, slashed)]
    assert meshes[0].triangles.tolist() == meshes[1].triangles.tolist()


def ply_text_face(*rows):
    """A text file with rows of faces as they are given."""
    head = ply_ascii(POINTS, []).decode().replace("element face 0", f"element face {len(rows)}")
    return "\n".join([head, *rows]).encode()


BAD = [
    ("suffix", ("a.fbx", b"")),
    ("file", ("a.npz", cut(npz_bytes(triangles=BOX)))),
    ("triangles", ("a.npz", npz_bytes(triangles=BOX[0]))),
    ("triangles[0]", ("a.npz", npz_bytes(triangles=NAN[FACES]))),
    ("parts[11]", ("a.npz", npz_bytes(triangles=BOX, parts=[0] * 11 + [-1], part_names=["a"]))),
    ("parts, part_names", ("a.npz", npz_bytes(triangles=BOX, parts=ZEROS))),
    ("file", ("a.stl", stl_ascii()[:-14])),
    ("faces", ("a.ply", ply_binary(">", faces=[(0, 1, -1)]))),
    ("faces", ("a.obj", f"{CORNERS}f -4 -2 -1\nv 9 9 9\n".encode())),
    ("faces", ("a.obj", f"{CORNERS}f 1 2 5\n".encode())),
    ("faces", ("a.obj", f"{CORNERS}f 0 1 2\n".encode())),
    ("file", ("a.obj", f"{CORNERS}f 1 2 3.5\n".encode())),
    ("file", ("a.obj", f"{CORNERS}f 1 /2 3\n".encode())),
    ("file", ("a.obj", f"v 1 2\n{CORNERS}{FACE}".encode())),
    ("file", ("a.ply", ply_ascii() + b" one")),
    ("file", ("a.ply", cut(ply_binary(">")))),
    ("file", ("a.ply", ply_text_face("-4 0 1 2 3"))),
    ("file", ("a.ply", ply_text_face("nan 0 1 2 3"))),
    ("file", ("a.ply", ply_text_face("2.5 0 1 2 3"))),
    ("file", ("a.ply", ply_text_face("4 0 1 2 3", "-1"))),
    ("format", ("a.ply", ply_ascii().replace(b"ascii", b"text"))),
    ("header", ("a.ply", ply_ascii().replace(b"uchar int", b"uchar word"))),
    ("header", ("a.ply", b"ply\nformat ascii 1.0\n")),
    ("triangles", ("a.ply", ply_ascii(POINTS, []))),
    ("triangles", ("a.ply", ply_binary("<", POINTS, []))),
    ("triangles", ("a.npz", npz_bytes(triangles=np.float64(1.0)))),
    ("part_names", ("a.npz", no_array("part_names", triangles=BOX))),
    ("triangles", ("a.npz", no_array("triangles"))),
    ("JSON", ("a.glb", glb_file(b"{no}", b""))),
    ("scene", ("a.glb", changed("extensionsRequired", ["KHR_draco_mesh_compression"]))),
    ("scene", ("a.glb", changed("accessors", 0, "normalized", True))),
    ("scene", ("a.glb", changed("nodes", 0, "skin", 0))),
    ("scene", ("a.glb", changed("nodes", 0, "children", [0]))),
    ("scene", ("a.glb", changed("nodes", [{"mesh": 0, "children": [1]}, {"children": [0]}]))),
    ("scene", ("a.glb", changed("nodes", 0, "children", [-1]))),
    ("scene", ("a.glb", glb_file(*gltf(mode=6)))),
]
"""Of each format what a reader could read as another shape, and what is no such file."""
test_bad_input_is_refused_in_one_line = one_line_test(BAD)
