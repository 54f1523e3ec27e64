"""USD files: references are followed, a bad file is one line."""

import pytest

import pe_core as pe
import pe_tools as pt

pytest.importorskip("pxr", reason="of the extra meshes")

MESH = """def Mesh "m" {
point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
}
"""


def layer(folder, name, inside):
    """Write a text layer whose default prim holds this."""
    path = folder / f"{name}.usda"
    path.write_text(f'#usda 1.0\n(defaultPrim = "a")\ndef Xform "a" {{\n{inside}}}\n')
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
