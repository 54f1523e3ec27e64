"""`pe new`: the first study of a mesh in any format is found right, is commented, and runs."""

import re

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scene import cuts_body
from pe_core.scene.mesh import LARGEST_M, SMALLER_UNITS, fitting_units
from pe_tools.cli.roof import find_roof
from pe_tools.cli.verbs import main
from tests.engine.mesh_files import glb_file, gltf, obj_bytes, ply_binary, stl_binary
from tests.engine.test_docs import ROOT
from tests.engine.test_mesh_axes import car, obj, triangles_of

ASSETS = ROOT / "blend_assets"
CHEAP = ["--samples", "1024"]
VEHICLES_M = {
    "car": (4.5, 1.8, 1.45),
    "sports car": (4.4, 1.9, 1.1),
    "van": (4.3, 1.7, 1.8),
    "ambulance": (7.5, 2.2, 2.7),
    "city bus": (12.0, 2.55, 3.1),
    "lorry": (16.5, 2.6, 4.0),
}
"""Length, width and height."""


def new(mesh, study, more=()):
    return main(["new", str(mesh), "-o", str(study), *more])


def car_files(folder):
    """The car of `test_mesh_axes` in every format that is written by hand, in several axes."""
    points, faces = car("-Y forward, Z up")
    triangles = np.concatenate(
        [quads[:, [0, k, k + 1]] for quads in faces.values() for k in (1, 2)]
    )
    glb = triangles_of("Z forward, Y up")
    root, _ = gltf(points=triangles_of("ours"), indices=None)
    files = {
        "names.obj": obj("Blender, Y up"),
        "shape.obj": obj("Z forward, Y up", named=False),
        "turned.stl": stl_binary(triangles=triangles_of("-Y forward, Z up")),
        "millimetres.stl": stl_binary(triangles=1000.0 * triangles_of("Blender, Y up")),
        "turned.ply": ply_binary("<", points, triangles),
        "car.glb": glb_file(root, glb.astype("<f4").tobytes()),
    }
    for name, data in files.items():
        (folder / name).write_bytes(data)
    return list(files)


def checked(path):
    """Read a study that was written: its LiDAR is clear, on its mount, high and in the middle."""
    study = pe.load_study(path)
    (sensor,) = study.rig
    low, high = study.vehicle.bounds
    x, y, z = sensor.pose.position
    assert high[2] - 0.25 < z < high[2] + 0.3 and abs(y - (low[1] + high[1]) / 2) < 0.05
    assert low[0] + 0.2 * (high[0] - low[0]) < x < high[0] - 0.2 * (high[0] - low[0])
    assert not cuts_body(sensor.pose, catalog.housing(sensor.model.name), study.vehicle)
    assert study.search.mounting.on == {"roof": "roof"}
    study.coding()  # the start is on its mount
    return study


@pytest.mark.usefixtures("few_errors", "no_key_figures")
@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_a_study_of_our_vehicles_runs_as_it_is(name, tmp_path, monkeypatch, capsys):
    """The sedan's part `roof` is the mount; the bus has a pod there, so faces of it are."""
    monkeypatch.chdir(tmp_path)
    assert new(ASSETS / f"{name}.npz", "study.toml") == 0
    told = capsys.readouterr()
    assert "next: pe score study.toml" in told.out and "faces +x" in told.err
    study = checked(tmp_path / "study.toml")
    assert set(study.vehicle.glass) >= {"windshield", "windows_left", "rear_window"}
    assert main(["score", "study.toml", *CHEAP]) == 0
    budget = ["--set", "optimize.samples=1024", "--evaluations", "4", "--no-review"]
    assert main(["optimize", "study.toml", "-o", "out", *CHEAP, *budget]) == 0
    moved = pe.load_study(tmp_path / "out" / "study.toml")
    assert moved.search.mounting.on == {"roof": "roof"}


def test_axes_and_units_of_every_format_are_found_and_written(tmp_path, capsys):
    """The mesh is upright and faces forward; the study says so to a reader that guesses nothing."""
    for name in car_files(tmp_path):
        path = tmp_path / f"{name}.toml"
        assert new(tmp_path / name, path) == 0, capsys.readouterr().err
        study = checked(path)
        low, high = study.vehicle.bounds
        np.testing.assert_allclose([low, high], [(-2, -0.9, 0), (2, 0.9, 1.5)], atol=1e-5)
        corners = study.vehicle.triangles.reshape(-1, 3)
        assert corners[corners[:, 2] > 1.4][:, 0].mean() < 0.0, f"{name}: the cabin is behind"
        assert study.axes.up and study.axes.forward, name
        found = capsys.readouterr().err
        assert ("taken as millimetres" in found) == (study.axes.scale == 0.001)
    assert "scale = 0.001" in (tmp_path / "millimetres.stl.toml").read_text()


@pytest.mark.parametrize("unit", SMALLER_UNITS)
def test_the_unit_is_that_in_which_the_cross_section_is_a_vehicle_s(unit):
    factor = SMALLER_UNITS[unit]
    for kind, size in VEHICLES_M.items():
        sides = sorted((side / factor for side in size), reverse=True)
        if max(sides) > LARGEST_M:  # else the file is read as metres
            assert fitting_units(*sides)[0] == (unit, factor), kind


def test_most_keys_have_a_comment_and_those_that_are_off_work(tmp_path):
    """Without the "# " before them, the proposed camera and limits are a study that runs, too."""
    new(ASSETS / "sedan.npz", tmp_path / "study.toml")
    text = (tmp_path / "study.toml").read_text("utf-8")
    on, count = re.subn(r"^# (?=\[|\w+ = )", "", text, flags=re.MULTILINE)
    keys = [line for line in on.splitlines() if re.match(r"\w+ = ", line)]
    assert len(keys) == 28 and sum("  # " in line for line in keys) > 16
    assert count == 9, "a camera of five lines, the scale, a table of two limits"
    (tmp_path / "on.toml").write_text(on, "utf-8")
    study = pe.load_study(tmp_path / "on.toml")
    study.coding()
    lidar, camera = study.rig
    assert (
        camera.name == "front camera"
        and not study.vehicle.faces_near(camera.pose.position, 0.02).size
    )
    assert camera.pose.position[2] > find_roof(study.vehicle).level
    assert study.limits.height.value > lidar.pose.position[2]


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        ("none.obj", [], "no such file"),
        ("car.blend", [], "suffix"),
        ("box.obj", ["--set", "sensor.roof.model=Pandar640"], "such as Pandar64, "),
        ("dot.obj", [], "one point"),
        ("box.obj", ["--set", "vehicle.scale=0.0001"], "a vehicle"),
        ("box.obj", ["--set", "vehicle.up=up"], "vehicle: up: "),
        ("box.obj", ["--set", "vehicle.scale=1,2"], "one value"),
        ("box.obj", ["--set", "samples=9"], "expected one of vehicle.up"),
    ],
)
def test_what_cannot_be_is_one_line_and_leaves_no_file(name, more, words, tmp_path, capsys):
    (tmp_path / "box.obj").write_bytes(obj_bytes())
    (tmp_path / "dot.obj").write_bytes(obj_bytes(np.ones((8, 3))))
    before = {path.name for path in tmp_path.iterdir()}
    assert new(tmp_path / name, tmp_path / "study.toml", more) == 1
    (line,) = capsys.readouterr().err.splitlines()[-1:]
    assert line.startswith("pe: ") and words in line
    assert {path.name for path in tmp_path.iterdir()} == before
