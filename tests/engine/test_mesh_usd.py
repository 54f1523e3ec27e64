"""USD files: references are followed, a bad file is one line."""

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scene.mesh import AS_SAID

pytest.importorskip("pxr", reason="of the extra meshes")

MESH = """def Mesh "m" {
point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
}
"""
POSTS = """def PointInstancer "posts" (%s) {
int[] protoIndices = [0, 1, 0]
point3f[] positions = [(-1, 0, 1.4), (1, 0, 1.4), (5, 0, 0)]
int64[] invisibleIds = [2]
rel prototypes = [</a/posts/post>, </a/posts/twin>]
def Mesh "post" {
double3 xformOp:translate = (0, 0, 0.5)
uniform token[] xformOpOrder = ["xformOp:translate"]
int[] faceVertexCounts = [4]
int[] faceVertexIndices = [0, 1, 2, 3]
point3f[] points = [(0, -0.5, 0), (0, 0.5, 0), (0, 0.5, 1), (0, -0.5, 1)]
}
def Xform "twin" {
def Cube "cube" {
double size = 0.2
}
}
}
"""
SOLIDS = [
    ("Cube", "double size = 2", 24.0),
    ("Sphere", "double radius = 1", 4 * np.pi),
    ("Cylinder", "double radius = 1\ndouble height = 2", 6 * np.pi),
    ("Cone", "double radius = 1\ndouble height = 2", np.pi * (1 + 5**0.5)),
    ("Capsule", "double radius = 0.5\ndouble height = 1", 2 * np.pi),
    ("Plane", "double width = 2\ndouble length = 3", 6.0),
]


def layer(folder, name, inside):
    """Write a text layer whose default prim holds this."""
    path = folder / f"{name}.usda"
    head = '(defaultPrim = "a"\nmetersPerUnit = 1\nupAxis = "Z")'
    path.write_text(f'#usda 1.0\n{head}\ndef Xform "a" {{\n{inside}}}\n')
    return path


def reference(to, number=0, more=""):
    return f'def Xform "r{number}" ({more} references = @./{to}@) {{\n}}\n'


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        (MESH + reference("none.usda"), "main.usda: composition: expected layers that fit"),
        (MESH + reference("main.usda"), "main.usda: composition: expected layers that fit"),
        ("def ?", "main.usda: file: expected USD, found "),
        (MESH.replace("[3]", "[-3, 6]"), "main.usda: /a/m: expected as many indices as it counts"),
    ],
)
def test_bad_usd_is_one_line(tmp_path, capfd, inside, words):
    path = layer(tmp_path, "main", inside)
    with pytest.raises(pe.InputError) as caught:
        pt.read_mesh(path)
    assert words in str(caught.value) and "\n" not in str(caught.value)
    assert capfd.readouterr() == ("", ""), "USD itself prints nothing"


def test_references_to_what_is_there_are_read(tmp_path, capfd):
    (tmp_path / "inner").mkdir()
    layer(tmp_path / "inner", "leaf", MESH)
    inside = "".join(reference("inner/leaf.usda", n, "instanceable = true\n") for n in range(3))
    mesh = pt.read_mesh(layer(tmp_path, "main", MESH + inside), pe.MeshAxes(forward="+x"))
    assert len(mesh.triangles) == 4
    assert capfd.readouterr() == ("", "")


def area(mesh):
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0


def test_instances_are_where_the_instancer_places_them(tmp_path):
    """A post 0.5 m above its own place, a cube, and a third that is not visible."""
    mesh = pt.read_mesh(layer(tmp_path, "main", POSTS % ""), AS_SAID)
    corners = mesh.triangles[mesh.parts == mesh.part_names.index("post")].reshape(-1, 3)
    np.testing.assert_allclose(corners.min(axis=0), (-1.0, -0.5, 1.9), atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=0), (-1.0, 0.5, 2.9), atol=1e-6)
    corners = mesh.triangles[mesh.parts == mesh.part_names.index("twin")].reshape(-1, 3)
    np.testing.assert_allclose(corners.min(axis=0), (0.9, -0.1, 1.3), atol=1e-6)
    assert area(mesh) == pytest.approx(1.0 + 6 * 0.2**2) and mesh.notes == ()


def test_an_index_of_no_prototype_is_one_line(tmp_path):
    wrong = (POSTS % "").replace("[0, 1, 0]", "[0, 7, 0]")
    with pytest.raises(pe.InputError, match="within its 2 prototypes"):
        pt.read_mesh(layer(tmp_path, "main", wrong))


def test_a_solid_along_no_axis_is_refused(tmp_path):
    wrong = 'def Cone "m" {\nuniform token axis = "Q"\n}\n'
    with pytest.raises(pe.InputError, match="/m, axis"):
        pt.read_mesh(layer(tmp_path, "main", wrong))


@pytest.mark.parametrize(("kind", "measures", "right"), SOLIDS)
def test_solids_have_their_area_and_look_outwards(tmp_path, kind, measures, right):
    """A round one as 32 flats round its axis: 1 % less than the formula at most."""
    mesh = pt.read_mesh(layer(tmp_path, "main", f'def {kind} "m" {{\n{measures}\n}}\n'), AS_SAID)
    assert right * 0.99 < area(mesh) <= right * (1 + 1e-12)
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    volume = (a * np.cross(b, c)).sum() / 6.0
    assert volume > 0.2 or kind == "Plane"
    along_x = f'def {kind} "m" {{\n{measures}\nuniform token axis = "X"\n}}\n'
    if kind in ("Cylinder", "Cone", "Capsule"):
        turned = pt.read_mesh(layer(tmp_path, "x", along_x), AS_SAID).triangles
        assert np.ptp(turned.reshape(-1, 3), axis=0)[0] == pytest.approx(2.0)


def test_holes_and_what_is_no_surface_are_left_out_and_counted(tmp_path):
    """A square of 1 m2 beside a face of the same mesh that is a hole, a curve and points."""
    square = """def Mesh "m" {
int[] faceVertexCounts = [4, 4]
int[] faceVertexIndices = [0, 1, 2, 3, 0, 1, 2, 4]
int[] holeIndices = [1]
point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 3, 0)]
}
def BasisCurves "c" {
}
def Points "p" {
}
"""
    mesh = pt.read_mesh(layer(tmp_path, "main", square))
    assert area(mesh) == pytest.approx(1.0)
    assert all(word in mesh.notes[0] for word in ("1 face that is a hole", "BasisCurves", "Points"))


def test_a_concave_face_has_the_shoelace_area(tmp_path):
    """A dart of 0.5 m2, 3.5 as a fan."""
    dart = """def Mesh "m" {
int[] faceVertexCounts = [4]
int[] faceVertexIndices = [0, 1, 2, 3]
point3f[] points = [(1, 2, 0), (0, 0.5, 0), (-1, 2, 0), (0, 0, 0)]
}
"""
    assert area(pt.read_mesh(layer(tmp_path, "main", dart))) == pytest.approx(0.5)
