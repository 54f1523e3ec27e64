"""`pe check`: tables, JSON, CSV, and the exit status."""

import csv
import json
import os
import signal
import threading

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.codec import record
from pe_core.base.errors import InputError
from pe_core.study.requirement_file import presets
from pe_tools.cli import run_job
from pe_tools.cli.check_verb import COLUMNS, NOT_MET
from pe_tools.cli.verbs import main
from pe_tools.jobs import SuggestJob
from tests.engine import shapes

pytestmark = pytest.mark.usefixtures("few_errors")
STUDY = """
samples = 2048
[space]
x = [-80, 80]
y = [-40, 40]
z = [0, 4]
interval = 0.2

[vehicle]
mesh = "car.npz"

[[sensor]]
name = "roof"
model = "Pandar64"
position = [0.0, 0.0, 1.9]

[[requirement]]
name = "adult ahead"
body = ["adult"]
zone = { x = ["front + 3", "front + 5"], y = [-1, 1], step = 0.5 }
"""
SMALL = """
[[requirement]]
name = "bump"
body = [{ diameter = 0.1, height = 0.05 }]
zone = { ring = [0.2, 0.5] }
"""
LIMITS = """
[limits]
blind_ground = 400.0
height = { value = 3.0, kept = false }
entropy = -20.0
"""


@pytest.fixture
def study(tmp_path):
    car = shapes.box_car()
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def test_the_exit_status_says_whether_all_are_met(study, capsys):
    assert main(["check", str(study)]) == 0
    assert "1 of 1 met" in capsys.readouterr().out
    study.write_text(STUDY + SMALL)
    assert main(["check", str(study), "--json"]) == NOT_MET == 3
    found = json.loads(capsys.readouterr().out)
    assert [row["met"] for row in found["requirements"]] == [True, False]
    assert found["met"] == 1 and found["requirements"][1]["margin_m"] < 0.0
    study.write_text(STUDY.split("[[requirement]]")[0])
    assert main(["check", str(study)]) == 1
    assert "check: requirements: expected" in capsys.readouterr().err


@pytest.mark.usefixtures("heeded_signals")
def test_ctrl_c_keeps_the_verdicts_that_were_found(study, tmp_path, monkeypatch, capsys):
    study.write_text(STUDY + SMALL)
    steps = pe.Study.check_steps
    ended = threading.Event()

    def interrupted(self, checker, **options):
        for step in steps(self, checker, **options):
            yield step
            if step.verdict is not None:
                os.kill(os.getpid(), signal.SIGINT)
                ended.wait(10.0)

    monkeypatch.setattr(pe.Study, "check_steps", interrupted)
    table = tmp_path / "verdicts.csv"
    try:
        assert main(["check", str(study), "-o", str(table)]) == 130
    finally:
        ended.set()
    shown = capsys.readouterr()
    assert "1 of 1 met, 1 not checked" in shown.out and "bump: not checked" in shown.out
    assert "checking" in shown.err
    assert [row["name"] for row in csv.DictReader(table.open())] == ["adult ahead"]


def test_a_table_that_cannot_be_written_is_told_before_the_work_or_takes_no_verdict_along(
    study, tmp_path, monkeypatch, capsys
):
    nowhere = ["check", str(study), "-o", str(tmp_path / "no" / "table.csv")]
    assert main(nowhere) == 1
    assert "no such folder" in capsys.readouterr().err.splitlines()[-1]

    def full(path, _data):
        raise InputError(path, "file", "a path that can be written", "no space left on device")

    monkeypatch.setattr(run_job, "write_bytes", full)
    assert main(["check", str(study), "-o", str(tmp_path / "table.csv")]) == 1
    shown = capsys.readouterr()
    assert "1 of 1 met" in shown.out and "no space left" in shown.err


def test_all_presets_are_checked_or_said_why_not(study, tmp_path, capsys):
    """The CSV has a row for each that was checked; no text claims that a rule is complied with."""
    table = tmp_path / "table.csv"
    status = main(["check", str(study), "--preset", "all", "-o", str(table)])
    text = capsys.readouterr().out
    rows = list(csv.DictReader(table.open()))
    assert status == NOT_MET and tuple(rows[0]) == COLUMNS
    named = {row["name"] for row in rows} - {"adult ahead"}
    skipped = {line.split(":")[0] for line in text.splitlines() if ": not checked: " in line}
    assert named | skipped == set(presets()) and not named & skipped
    assert "r46_class_I" in skipped and "r159_crossing" in named
    assert "compl" not in text.lower() and "no approval" in text


def test_a_score_has_the_verdicts_in_its_result(study, tmp_path, capsys):
    assert main(["score", str(study), "-o", str(tmp_path / "out"), "--json"]) == 0
    found = json.loads((tmp_path / "out" / "result.json").read_text())
    assert [row["name"] for row in found["requirements"]] == ["adult ahead"]
    assert main(["check", str(tmp_path / "out" / "study.toml"), "--json"]) == 0
    again = json.loads(capsys.readouterr().out.split("\n{\n")[-1].join(["{\n", ""]))
    assert again["requirements"] == found["requirements"]


def test_a_blind_place_is_mended_by_the_job_and_by_the_command(study, capsys):
    found = pe.load_study(study)
    job = SuggestJob(found, spot=(0.0, 1.6))
    assert list(job)[-1].stage == "done"
    expected = [each.to_dict() for own in job.found.values() for each in own]
    assert main(["explain", str(study), "--at", "0.0", "1.6", "--suggest", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["suggestions"] == expected
    assert main(["explain", str(study), "--suggest"]) == 1


def test_limits_with_a_number_are_checked_as_a_score_has_them(study, capsys):
    """Also where nothing else is asked for; scenarios alone have none."""
    study.write_text(STUDY.partition("[[requirement]]")[0] + LIMITS)
    outcome = pt.ScoreJob(pe.load_study(study), 1).run()
    capsys.readouterr()
    assert main(["check", str(study), "--json"]) == NOT_MET
    rows = json.loads(capsys.readouterr().out)["limits"]
    expected = [record(each.row) for each in outcome.dashboard if each.wanted is not None]
    assert rows == expected and [row["met"] for row in rows] == [True, False, True]
    assert main(["check", str(study), "--set", "limits.entropy=90"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(" ")[0] for line in lines] == ["limit:"] * 3
    assert all("(met: wanted" in line for line in lines)
