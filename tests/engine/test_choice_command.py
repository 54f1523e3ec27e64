"""`pe optimize` of a study with choices: what it prints, writes and refuses."""

import json

import pytest

import pe_core as pe
from pe_tools.cli import choose_verb, verbs
from tests.engine import mounting
from tests.engine.test_choice_job import options, study

pytestmark = pytest.mark.usefixtures("few_errors")


@pytest.fixture
def file(tmp_path):
    given = study([pe.Choice(options(), ["roof"])], free=(), currency="EUR")
    pe.export_study(given, tmp_path / "car.toml")
    return tmp_path / "car.toml"


def test_the_table_tells_price_entropy_and_where_each_sensor_sits(file, tmp_path, capsys):
    assert verbs.main(["optimize", str(file), "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].split() == ["price", "[EUR]", "entropy", "coverage", "design"]
    data = json.loads((tmp_path / "out" / "front.json").read_text())
    first = next(row for row in data["designs"] if row["on_front"])
    assert out[1].split()[:2] == ["2", f"{first['entropy']:.4f}"]
    assert out[1].endswith(f"%  {mounting.CAN}")
    assert out[2].strip() == f"roof: {mounting.CAN}; (-0.43, 0, 1.478) m"
    count = len(data["front"])
    assert out[-1] == f"{count} on the front; 3 searched of 3 looked at (all that the limits allow)"
    study = tmp_path / "out" / first["study"]
    assert verbs.main(["score", str(study)]) == 0
    assert f"{first['entropy']:.4f}" in capsys.readouterr().out


def test_json_is_front_json(file, tmp_path, capsys):
    assert verbs.main(["optimize", str(file), "--json", "-o", str(tmp_path / "out")]) == 0
    printed = json.loads(capsys.readouterr().out)
    kept = json.loads((tmp_path / "out" / "front.json").read_text())
    assert printed["kind"] == "front"
    assert {**printed, "run": 0} == {**kept, "run": 0}


def test_a_user_s_own_file_is_refused_before_the_work(file, tmp_path, capsys, monkeypatch):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "front.csv").write_text("mine")
    monkeypatch.setattr(choose_verb, "_drive", lambda *_: pytest.fail("the work has begun"))
    assert verbs.main(["optimize", str(file), "-o", str(tmp_path / "out")]) == 1
    assert "front.csv: output: expected no file, or one that was" in capsys.readouterr().err
    assert (tmp_path / "out" / "front.csv").read_text() == "mine"


def test_the_plots_that_others_add_are_drawn_of_what_is_kept(file, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(choose_verb, "plots", [lambda data, folder: drawn.append((data, folder))])
    assert verbs.main(["optimize", str(file), "-o", str(tmp_path / "out")]) == 0
    ((data, folder),) = drawn
    assert folder == tmp_path / "out"
    assert data == json.loads((folder / "front.json").read_text())
