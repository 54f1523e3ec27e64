"""Formats that other packages read: found by entry points, turned as all are; told when missing."""

import re
import sys
from contextlib import suppress
from importlib import metadata
from importlib.metadata import EntryPoint

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base import plugins
from pe_tools.cli import verbs
from pe_tools.formats import FoundMesh
from tests.engine.mesh_files import BOX

DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>
<unit name="inch" meter="0.0254"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g" name="shape"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 100 0 0 100 0 40 0 0 40</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount>
<p>0 1 2 3</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="roof">
<translate>0 60 0</translate><node id="m" name="inner"><instance_geometry url="#g"/></node>
</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""
POLYLIST = DAE[DAE.index("<polylist") : DAE.index("</mesh>")]
INPUT = '<input semantic="VERTEX" source="#v" offset="0"/>'
HOLED = (
    "0 0 0 100 0 0 100 0 40 0 0 40 10 0 10 20 0 10 20 0 30 10 0 30",
    f"<polygons count='1'>{INPUT}<ph><p>0 1 2 3</p><h>4 5 6 7</h></ph></polygons>",
)
AREAS = {  # square inches
    "a dart": ("0 0 0 100 0 0 10 0 10 0 0 100", POLYLIST, 1000.0),
    "polygons": (HOLED[0], f"<polygons count='1'>{INPUT}<p>0 1 2 3</p></polygons>", 4000.0),
    "a hole": (*HOLED, 3800.0),
    "a hole, and none": (HOLED[0], HOLED[1].replace("<ph>", "<p>4 5 6</p><ph>"), 3900.0),
    "a fan": (HOLED[0], f"<trifans count='1'>{INPUT}<p>0 1 2 3</p></trifans>", 4000.0),
    "lines": (HOLED[0], f"<linestrips>{INPUT}<p>0 1</p></linestrips>{POLYLIST}", 4000.0),
}


def install(monkeypatch, value):
    """Let the plugin for .dae lead there: one of another package."""
    points = [EntryPoint("mesh.dae", value, plugins.GROUP)]
    monkeypatch.delitem(plugins.SHIPPED, "mesh.dae")
    monkeypatch.setattr(
        metadata,
        "entry_points",
        lambda group, name="": points if (group, name) == (plugins.GROUP, "mesh.dae") else [],
    )


def box(path, data):
    """A reader: a box whose y is up, its length along z."""
    assert path.name == "box.dae" and data == b"anything"
    return FoundMesh(BOX[..., [1, 2, 0]], np.zeros(12, np.int32), ["a\nname"], "+y")


def test_a_reader_is_found_and_its_mesh_is_checked_and_turned(monkeypatch, tmp_path):
    install(monkeypatch, f"{__name__}:box")
    monkeypatch.setitem(sys.modules, __name__, sys.modules[box.__module__])
    (tmp_path / "box.dae").write_bytes(b"anything")
    mesh = pt.read_mesh(tmp_path / "box.dae")
    assert mesh.triangles.tolist() == BOX.tolist()
    assert mesh.part_names == ("a?name",)
    assert mesh.axes == "faces +z (shape), up is +y (file)"


def test_without_its_library_one_line_says_what_to_install(monkeypatch, tmp_path):
    install(monkeypatch, "no_such_library_at_all:read")
    (tmp_path / "car.dae").write_bytes(b"<COLLADA/>")
    expected = r'"perception-entropy\[meshes\]".*No module named .no_such_library_at_all'
    with pytest.raises(pe.InputError, match=expected):
        pt.read_mesh(tmp_path / "car.dae")


def fails(path, data):
    raise KeyError("of the plugin's own")


def gives_up(path, data):
    raise SystemExit(3)


def finds_nothing(path, data):
    return None


@pytest.mark.parametrize(
    ("function", "words"),
    [
        ("fails", "plugin: expected to complete, found KeyError"),
        ("gives_up", "plugin: expected to complete, found SystemExit: 3"),
        ("finds_nothing", "result: expected a FoundMesh, found None"),
        ("no_such_function", "plugin: expected to load, found AttributeError"),
        ("DAE", "entry point: expected a function, found str"),
    ],
)
def test_a_plugin_that_fails_is_named(monkeypatch, tmp_path, function, words):
    install(monkeypatch, f"{__name__}:{function}")
    monkeypatch.setitem(sys.modules, __name__, sys.modules[box.__module__])
    (tmp_path / "box.dae").write_bytes(b"anything")
    with pytest.raises(pe.InputError) as caught:
        pt.read_mesh(tmp_path / "box.dae")
    assert str(caught.value).startswith(f"plugin 'dae' of {__name__}: {words}")


def test_a_plugin_s_verbs_that_fail_leave_the_others(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, __name__, sys.modules[box.__module__])
    values = ("no_such_library_at_all:add", f"{__name__}:finds_nothing", "os:no_such_name")
    points = [EntryPoint("verb.odd", value, plugins.GROUP) for value in values]
    monkeypatch.setattr(metadata, "entry_points", lambda group, name="": [] if name else points)
    with suppress(SystemExit):
        verbs.main(["--help"])
    out, err = capsys.readouterr()
    assert "sensors" in out
    lines = err.splitlines()
    assert len(lines) == 3 and all(line.startswith("pe: plugin 'odd' of ") for line in lines)
    assert all(line.endswith("its verbs are missing") for line in lines)


def read_dae(monkeypatch, folder, text):
    pytest.importorskip("collada", reason="of the extra meshes")
    install(monkeypatch, "pe_tools.formats.meshes.collada:read_dae")
    (folder / "car.dae").write_text(text)
    return pt.read_mesh(folder / "car.dae", pe.MeshAxes(forward="+x"))


def test_collada_s_unit_up_axis_polygons_and_nodes(monkeypatch, tmp_path):
    """A rectangle of 100 x 40 inches, 60 inches up in a parent node, y up: z is right."""
    mesh = read_dae(monkeypatch, tmp_path, DAE)
    inch = 0.0254
    corners = np.array([(0, 0, 60), (100, 0, 60), (100, -40, 60), (0, -40, 60)]) * inch
    np.testing.assert_allclose(mesh.triangles, corners[[(0, 1, 2), (0, 2, 3)]], atol=1e-6)
    assert mesh.part_names == ("inner",)
    assert mesh.axes == "faces +x (study), up is +y (file)"


def dae(points, primitives):
    """The file with other points (3 N numbers) and primitives."""
    numbers = points.split()
    old = DAE[DAE.index('<float_array id="a"') : DAE.index("</float_array>")]
    text = DAE.replace(old, f'<float_array id="a" count="{len(numbers)}">{points}')
    text = text.replace('count="4" stride', f'count="{len(numbers) // 3}" stride')
    return text.replace(POLYLIST, primitives)


@pytest.mark.parametrize("name", AREAS)
def test_collada_s_polygons_have_the_shoelace_area(monkeypatch, tmp_path, name):
    points, primitives, right = AREAS[name]
    mesh = read_dae(monkeypatch, tmp_path, dae(points, primitives))
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    assert area == pytest.approx(right * 0.0254**2, rel=1e-6)
    assert mesh.notes == (("left out: 1 set of lines",) if name == "lines" else ())


@pytest.mark.parametrize("index", ["-1", "4", "99999999999"])
@pytest.mark.parametrize("name", ["a dart", "a hole"])
def test_collada_s_indices_are_within_its_vertices(monkeypatch, tmp_path, name, index):
    points, primitives, _ = AREAS[name]
    points = " ".join(points.split()[:12])
    wrong = primitives.replace("4 5 6 7", f"0 1 {index}").replace("0 1 2 3", f"0 1 {index}")
    wrong = wrong.replace("<vcount>4<", "<vcount>3<")
    with pytest.raises(pe.InputError, match=r"car\.dae"):
        read_dae(monkeypatch, tmp_path, dae(points, wrong))


@pytest.mark.parametrize(
    ("element", "text"), [("vcount", "4 x"), ("vcount", "x 4"), ("p", "0 1 2 3.5")]
)
def test_collada_s_numbers_are_numbers_to_their_end(monkeypatch, tmp_path, element, text):
    """What NumPy reads up to the first letter would be a part of the shape."""
    whole = dae(*AREAS["a dart"][:2])
    wrong = re.sub(f"<{element}>[^<]*<", f"<{element}>{text}<", whole)
    assert wrong != whole
    with pytest.raises(pe.InputError, match=r"car\.dae"):
        read_dae(monkeypatch, tmp_path, wrong)
