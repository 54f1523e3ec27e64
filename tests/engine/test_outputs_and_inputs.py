"""No verb replaces a file that it has read, whichever option named the file."""

import json
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.cli.verbs import main
from tests.engine import shapes
from tests.engine.processes import pe as run_pe

SCENARIO = """
[[scenario]]
name = "crossing"
speed_kmh = 30.0
[[scenario.body]]
name = "child"
body = "child"
path = [[-6.0, 0.0, -10.0], [0.0, 0.0, 0.0]]
"""
INFO = """
/**:
  ros__parameters:
    wheel_radius: 0.3
    wheel_base: 2.8
    front_overhang: 0.9
    rear_overhang: 1.0
"""
CALLS = {
    "check": "check car.toml --preset r159_crossing -o",
    "scenarios": "check car.toml --scenarios scenario.toml -o",
    "where": "where car.toml --model Pandar40 --places 2 --workers 1 -o",
    "export a rig": "export car.toml --to csv --rear-axle info.param.yaml -o",
    "export a scene": "export car.toml --to gltf -o",
    "import": "import rig.csv --from csv --mesh car.npz --rear-axle info.param.yaml -o",
    "new": "new car.npz -o",
    "known rig": "new car.npz --rig kitti -o",
    "region": "region car.toml roof --places 4 --workers 1 -o",
}
"""Each verb that writes a file of a name that the user chooses; the name comes last."""
FOLDERS = {
    "score": "score {} -o",
    "optimize": "optimize car.toml --start {} --evaluations 4 -o",
    "sweep": "sweep {} -o",
}
"""Verbs that write a folder of results, and where they read a study."""
ALONE = {"review", "verify"}
"""Verbs that write a folder in which no file has a name that is read."""
FILES = "car.toml", "car.npz", "rig.csv", "scenario.toml", "info.param.yaml"


@pytest.fixture
def folder(tmp_path, monkeypatch, capsys):
    """Return a folder with a file of each kind that verbs read; it is the current one."""
    monkeypatch.chdir(tmp_path)
    rig = shapes.roof_rig(16, 180)
    search = pe.Search({"roof": ("x",)}, {}, 3, 2048)
    study = shapes.car_study(rig, search=search, samples=1024)
    pt.export_study(study, "car.toml")
    assert main(["export", "car.toml", "--to", "csv", "-o", "rig.csv"]) == 0
    Path("scenario.toml").write_text(SCENARIO)
    Path("info.param.yaml").write_text(INFO)
    capsys.readouterr()
    return tmp_path


def contents():
    """Return the bytes of the files of the current folder by name."""
    return {path.name: path.read_bytes() for path in Path().iterdir() if path.is_file()}


def read_by(call):
    """Return the files that a command names, and those that its study names."""
    words = call.split()
    named = [name for name in FILES if name in words]
    return [*named, "car.npz"] if "car.toml" in words and "car.npz" not in named else named


def outputs_of(verb):
    """Return the metavars of the options of a verb that name an output."""
    return {each["value"] for each in verb["arguments"] if "-o" in each["flags"]}


def test_every_verb_with_an_output_is_tried():
    verbs = json.loads(run_pe(["--help", "--json"]).stdout)["verbs"]
    writing = {verb["name"]: outputs_of(verb) for verb in verbs if outputs_of(verb)}
    files = {name for name, metavars in writing.items() if metavars != {"DIR"}}
    assert files == {call.split()[0] for call in CALLS.values()}
    assert set(writing) - files == {*FOLDERS} | ALONE


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_no_file_that_is_read_is_replaced(call, folder, capsys):
    free = "free.json" if call.startswith("region") else "free.out"
    assert main([*call.split(), free]) in (0, 3), capsys.readouterr().err
    Path(free).unlink()
    before = contents()
    assert read_by(call)
    for name in read_by(call):
        for output in (name, f"../{folder.name}/{name}"):
            capsys.readouterr()
            assert main([*call.split(), output, "--replace"]) == 1
            lines = capsys.readouterr().err.splitlines()
            assert "another file than the input" in lines[-1], lines
            assert contents() == before


@pytest.mark.parametrize("call", FOLDERS.values(), ids=FOLDERS)
def test_no_study_that_is_read_is_replaced_in_a_folder_of_results(call, folder, capsys):
    out = folder / "out" / "study" if call.startswith("sweep") else folder / "out"
    out.mkdir(parents=True)
    pt.export_study(pe.load_study("car.toml"), out / "study.toml")
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert main([*call.format(out / "study.toml").split(), "out"]) == 1
    assert "another file than the input" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
