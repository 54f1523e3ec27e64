"""USD files that hang, explode or lie: one line each, found before USD composes them."""

import os

import pytest

import pe_core as pe
import pe_tools as pt

pytest.importorskip("pxr", reason="of the extra meshes")
from pxr import UsdUtils  # where it is installed

if os.name == "nt":
    pytest.skip("POSIX files", allow_module_level=True)

MESH = """def Mesh "m" {
point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
}
"""
FAN = 12
"""References of each layer to the next: after six layers they are three million prims."""


def layer(folder, name, inside):
    """Write a text layer whose default prim holds this."""
    path = folder / f"{name}.usda"
    path.write_text(f'#usda 1.0\n(defaultPrim = "a")\ndef Xform "a" {{\n{inside}}}\n')
    return path


def reference(to, number=0, more=""):
    return f'def Xform "r{number}" ({more} references = @./{to}@) {{\n}}\n'


def nested(folder, more=""):
    layer(folder, "layer0", MESH)
    for depth in range(1, 7):
        to = f"layer{depth - 1}.usda"
        layer(folder, f"layer{depth}", "".join(reference(to, n, more) for n in range(FAN)))
    return folder / "layer6.usda"


def pipe(folder):
    os.mkfifo(folder / "pipe.usda")
    return layer(folder, "main", MESH + reference("pipe.usda"))


def cut_short(folder, lost):
    """A package that lacks its last bytes: its first layer would still be read."""
    UsdUtils.CreateNewUsdzPackage(str(layer(folder, "inner", MESH)), str(folder / "car.usdz"))
    data = (folder / "car.usdz").read_bytes()
    (folder / "car.usdz").write_bytes(data[: len(data) - lost])
    return folder / "car.usdz"


BAD = {
    "cut by a byte": (lambda f: cut_short(f, 1), "car.usdz: file: expected a whole package"),
    "cut by a list": (lambda f: cut_short(f, 100), "car.usdz: file: expected a whole package"),
    "a pipe": (pipe, "pipe.usda: file: expected a regular file"),
    "missing": (
        lambda folder: layer(folder, "main", MESH + reference("none.usda")),
        "main.usda: references: expected existing files, found no file at ",
    ),
    "a circle": (
        lambda folder: layer(folder, "main", MESH + reference("main.usda")),
        "main.usda: references: expected no cycle",
    ),
    "nested": (nested, "layer6.usda: prims: expected at most 200,000, found more"),
    "instanced": (
        lambda folder: nested(folder, "instanceable = true\n"),
        "layer6.usda: prims: expected at most 200,000, found more",
    ),
    "brackets": (
        lambda folder: layer(folder, "main", "custom double3 x = " + "(" * 100_000),
        "main.usda: brackets: expected at most 1,000 deep",
    ),
    "no USD": (
        lambda folder: layer(folder, "main", "def ?"),
        "main.usda: file: expected USD, found ",
    ),
    "counts below 0": (
        lambda folder: layer(folder, "main", MESH.replace("[3]", "[-3, 6]")),
        "main.usda: /a/m: expected as many indices as it counts",
    ),
    "counts that overflow": (
        lambda folder: layer(folder, "main", MESH.replace("[3]", "[2147483647, -2147483644]")),
        "main.usda: /a/m: expected as many indices as it counts",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_one_line_before_usd_composes_it(tmp_path, capfd, name):
    make, words = BAD[name]
    path = make(tmp_path)
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
