"""The command line: verbs, JSON, exit status, Ctrl-C."""

import json
import re
from itertools import product
from pathlib import Path

import pytest

import pe_core as pe
from pe_tools.cli.verbs import main

PATHS = (
    "compare {}",
    "review {} -o r",
    "score {}",
    "check {}",
    "optimize {}",
    "explain {}",
    "sweep {} -o s",
    "sweep car.toml -o {}",
    "score car.toml -o {}",
    "optimize --resume {}",
    "import {} -o x",
    "import car.toml -o {}",
    "export car.toml --to csv -o {}",
    "export car.toml --to ros -o {}",
    "new {} -o x",
    "new car.npz -o {}",
    "check car.toml -o {}",
    "review car.toml -o {}",
    "new {} --rig kitti -o x",
    "new --rig kitti -o {}",
)
"""Every path on the command line."""
OUTPUTS = {
    "check": "check car.toml --preset all -o {}",
    "export a rig": "export car.toml --to csv -o {}",
    "export a scene": "export car.toml --to gltf -o {}",
    "import": "import rig.csv --from csv -o {}",
    "new": "new car.npz -o {}",
    "known rig": "new --rig kitti -o {}",
}
"""Every output that is a file of a name that the user chooses."""


def test_score_prints_what_a_person_wants_to_know(study, capsys):
    assert main(["score", str(study)]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("entropy ") and "coverage" in out and "roof: " in out
    assert "scoring" in err
    line = "car.npz: 4.60 x 1.80 x 1.20 m, lies along x, 24 triangles, 2 parts"
    assert err.splitlines()[0] == line


def test_json_is_one_document_and_nothing_else(study, capsys):
    assert main(["score", str(study), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    loaded = pe.load_study(study)
    assert data["after"] == loaded.evaluator().score(loaded.rig).to_dict()


def test_a_search_that_would_keep_nothing_is_refused_before_it_begins(study, capsys, tmp_path):
    """It once searched for minutes and printed the result alone. With --json stdout has all."""
    before = set(tmp_path.rglob("*"))
    assert main(["optimize", str(study), "--evaluations", "1000000"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("pe: command line: output: expected -o DIR") and "--json" in line
    few = ("--evaluations", "2", "--no-review")
    assert main(["optimize", str(study), *few, "--json"]) == 0
    assert "placements" in json.loads(capsys.readouterr().out)
    assert set(tmp_path.rglob("*")) == before
    with pytest.raises(SystemExit):  # a sweep asks for its folder likewise
        main(["sweep", str(study)])


def test_a_schedule_of_another_method_is_refused(study, capsys):
    few = ("--evaluations", "3", "--no-review", "--json")
    by_default = study.with_name("default.toml")
    by_default.write_text(
        re.sub(r"(?m)^(method|candidates|reach|floor|decay).*\n", "", study.read_text())
    )
    assert main(["optimize", str(by_default), "--set", "optimize.candidates=4", *few]) == 1
    assert "optimize.method: expected 'random'" in capsys.readouterr().err
    assert main(["optimize", str(study), "--method", "portfolio", *few]) == 1
    assert "optimize.candidates: expected method" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "nearest"),
    [
        ("scoer", "expected score, or one of"),
        ("score car.toml --sampels 3", "expected --samples, or"),
        ("export car.toml --to gltff -o x", "such as gltf, "),
        ("score car.toml --condition foog", "car.toml: condition: expected fog, or one of rain"),
        ("score car.toml --set sampels=3", "car.toml: sampels: expected one of"),
        ("score car.toml --set sensor.rof.free=x", "car.toml: sensor.rof.free: expected one of"),
        ("optimize car.toml --seed x", "car.toml: optimize.seed: expected a whole number"),
        ("sensors Pandar46", "such as Pandar64, "),
    ],
)
def test_a_name_that_is_nearly_right_has_the_right_one_named(line, nearest, study, capsys):
    more = (
        '[[weather]]\nname = "fog"\nfog_mor_m = 100\n[[weather]]\nname = "rain"\nrain_mm_h = 25\n'
    )
    study.write_text(study.read_text() + more)
    try:
        status = main([word.replace("car.toml", str(study)) for word in line.split()])
    except SystemExit as stop:
        status = stop.code
    assert status in (1, 2) and nearest in capsys.readouterr().err


def test_a_path_that_cannot_be_is_one_line(study, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    offenders = []
    for argv, path in product(PATHS, ["", f"a/{'ü' * 200}/b", "a\0b"]):
        status = main([part.format(path) for part in argv.split()])
        told = capsys.readouterr().err.splitlines()
        if status != 1 or len(told) != 1 or not told[0].startswith("pe: command line: "):
            offenders.append((argv, path[:9], told))
    assert offenders == [] and sorted(tmp_path.iterdir()) == before


def test_no_memory_for_a_thread_is_one_line(study, monkeypatch, capsys):
    def start(_):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", start)
    assert main(["score", str(study)]) == 1
    assert capsys.readouterr().err.splitlines()[-1].startswith("pe: not enough memory: ")


@pytest.mark.parametrize("argv", OUTPUTS.values(), ids=OUTPUTS)
def test_no_output_replaces_a_file_unasked_or_an_input(study, tmp_path, monkeypatch, capsys, argv):
    monkeypatch.chdir(tmp_path)
    assert main(["export", "car.toml", "--to", "csv", "-o", "rig.csv"]) == 0
    Path("mine.out").write_text("mine.out")
    Path("link").symlink_to("nowhere")
    Path("loop").symlink_to("loop")
    given = argv.split()[1]
    files = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    capsys.readouterr()
    for name in {"mine.out", "car.toml", "car.npz", "link", "loop", given} - {"--rig"}:
        assert main(argv.format(name).split()) == 1
        assert name in (line := capsys.readouterr().err) and line.count("\n") == 1
    if argv != OUTPUTS["known rig"]:
        assert main([*argv.format(given).split(), "--replace"]) == 1
        assert "expected another file than the input" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == files
    assert Path("link").is_symlink() and Path("loop").is_symlink()
    assert main(argv.format("free.out").split()) in (0, 3) and Path("free.out").exists()
    assert main([*argv.format("mine.out").split(), "--replace"]) in (0, 3)
    assert Path("mine.out").read_bytes() != b"mine.out"
