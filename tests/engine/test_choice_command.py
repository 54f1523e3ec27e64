"""`pe optimize` of a study with choices: what it prints, writes and refuses."""

import json

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import EvaluatedRig
from pe_tools import advice, jobs
from pe_tools.cli import choose_verb, verbs
from tests.engine import mounting
from tests.engine.test_choice_job import options, study

pytestmark = pytest.mark.usefixtures("few_errors")


@pytest.fixture
def file(tmp_path):
    given = study([pe.Choice(options(), ["roof"])], free=(), currency="EUR")
    pt.export_study(given, tmp_path / "car.toml")
    return tmp_path / "car.toml"


def test_the_table_tells_price_entropy_and_where_each_sensor_sits(file, tmp_path, capsys):
    assert verbs.main(["optimize", str(file), "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].split() == ["price", "[EUR]", "entropy", "[nats]", "design"]
    data = json.loads((tmp_path / "out" / "front.json").read_text())
    first = next(row for row in data["designs"] if row["on_front"])
    assert out[1].split()[:2] == ["2", f"{first['entropy']:.4f}"]
    assert out[1].endswith(f"  {mounting.CAN}")
    assert out[2].strip() == f"roof: {mounting.CAN}; (-0.43, 0, 1.478) m"
    assert out[-1] == advice.OTHER_HARDWARE and data["notes"] == [advice.OTHER_HARDWARE]
    assert (tmp_path / "out" / "front.html").exists()
    study = tmp_path / "out" / first["study"]
    assert verbs.main(["score", str(study)]) == 0
    assert f"{first['entropy']:.4f}" in capsys.readouterr().out


def test_a_user_s_own_file_is_refused_before_the_work(file, tmp_path, capsys, monkeypatch):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "front.csv").write_text("mine")
    monkeypatch.setattr(choose_verb, "_drive", lambda *_: pytest.fail("the work has begun"))
    assert verbs.main(["optimize", str(file), "-o", str(tmp_path / "out")]) == 1
    assert "front.csv: output: expected no file, or one that was" in capsys.readouterr().err
    assert (tmp_path / "out" / "front.csv").read_text() == "mine"


def test_an_interrupted_front_goes_on_to_the_same_bits(tmp_path, capsys):
    """Journals of half of the searches are lost, and half of the entries of another."""
    given = study([pe.Choice(options(), ["roof"])], free=("pitch",))
    pt.export_study(given, tmp_path / "car.toml")
    file, out = str(tmp_path / "car.toml"), tmp_path / "out"
    assert verbs.main(["optimize", file, "--json", "-o", str(out)]) == 0
    whole = json.loads(capsys.readouterr().out)
    kept = json.loads((out / "front.json").read_text())
    assert whole["kind"] == "front" and {**whole, "run": 0} == {**kept, "run": 0}
    state = json.loads((out / jobs.FRONT_SEARCH).read_text())
    names = list(state["journals"])
    cut = {n: rows[: len(rows) // (k + 1)] for k, (n, rows) in enumerate(state["journals"].items())}
    assert len(names) == 3 and all(cut.values())
    journals = jobs.FrontJournals({n: [EvaluatedRig(*row) for row in cut[n]] for n in names[:2]})
    jobs.FrontCheckpoint(given).save(journals, out)
    assert verbs.main(["optimize", "--json", "--resume", str(out)]) == 0
    told = capsys.readouterr()
    resumed = json.loads(told.out)  # the files of the study are those beside the checkpoint
    resumed["inputs"]["study"]["vehicle"] = whole["inputs"]["study"]["vehicle"]
    assert {**resumed, "run": 0} == {**whole, "run": 0}
    assert "going on after" in told.err
    assert json.loads((out / jobs.FRONT_SEARCH).read_text()) == state
    assert verbs.main(["optimize", file, "--seed", "5", "--resume", str(out)]) == 1
    assert "front_search.json: study: expected the study and the" in capsys.readouterr().err
    (out / jobs.FRONT_SEARCH).write_text("{}")
    assert verbs.main(["optimize", file, "--resume", str(out)]) == 1
    assert "expected the checkpoint of a front" in capsys.readouterr().err
