"""Sweeps: changes of a study, folders and tables, workers that die, and going on."""

import csv
import json
import os
import signal
import sys
import time
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import Journal
from pe_core.study import SEARCH
from pe_tools.cli.verbs import main
from pe_tools.jobs import read_search
from pe_tools.sweep import RunTask, read_tried, run_all, sweep_runs
from pe_tools.sweep.parameter_grid import MAX_NAME_LENGTH, folder_names
from tests.engine import shapes
from tests.engine.processes import Command, finished
from tests.limits import HANG_S

pytestmark = pytest.mark.usefixtures("few_errors")

SEEDS = f"optimize.seed={','.join(map(str, range(10_001)))}"
OWN_EXECUTORS = """
from concurrent.futures import Executor


class NoShutdown:
    def submit(self, function, *arguments):
        return None


class NoFutures(Executor):
    def submit(self, function, *arguments):
        return None
"""
HELD = {1}
"""Not done yet when the next one is handed out."""


@pytest.fixture
def study(tmp_path):
    search = shapes.short_search({"roof": ("x", "z")})
    path = tmp_path / "car.toml"
    pt.export_study(shapes.car_study(shapes.roof_rig(16, 90), search=search), path)
    return path


def table(folder):
    with (folder / "sweep.csv").open() as file:
        return list(csv.DictReader(file))


def test_values_are_toml_or_else_texts():
    texts = ("a.b=1,2.5,true", "c=HDL-64E,Velodyne VLP-16 Puck", 'd."e f".0=[1, 2],[3,4],"x,y"')
    first, second, third = read_tried(texts)
    paths = [changes[0].path for changes in (first, second, third)]
    assert paths == [("a", "b"), ("c",), ("d", "e f", "0")]
    found = [[change.value for change in changes] for changes in (first, second, third)]
    assert found[0] == [1, 2.5, True] and found[1] == ["HDL-64E", "Velodyne VLP-16 Puck"]
    assert found[2] == [[1, 2], [3, 4], "x,y"]


def test_several_settings_make_every_combination(study):
    settings = read_tried(
        ("sensor.roof.model=Pandar64,HDL-64E", "optimize.seed=1,2", "sensor.0.position.2=1.9")
    )
    runs = sweep_runs({"car": study}, settings)
    assert [(r.study.rig["roof"].model.name, r.study.search.seed) for r in runs] == [
        ("Pandar64", 1),
        ("Pandar64", 2),
        ("HDL-64E", 1),
        ("HDL-64E", 2),
    ]
    assert {run.study.rig["roof"].pose.position for run in runs} == {(-0.43, 0.0, 1.9)}
    assert len({id(run.study.vehicle) for run in runs}) == 1, "a body is kept once"
    assert runs[0].name == (
        "car,sensor.roof.model=Pandar64,optimize.seed=1,sensor.0.position.2=1.9"
    )


@pytest.mark.parametrize(
    ("setting", "complaint"),
    [
        ("sensr.roof.model=x", "{study} with sensr.roof.model=x: sensr: expected one of"),
        (
            "sensor.rof.model=x",
            "{study} with sensor.rof.model=x: sensor.rof.model: expected one of roof, found 'rof'",
        ),
        ("samples=1.5", "{study} with samples=1.5: samples: expected a whole number"),
        (
            "space.x.0.y=1",
            "{study} with space.x.0.y=1: space.x.0.y: expected a table before the last dot",
        ),
        (
            "space.x.5=1",
            "{study} with space.x.5=1: space.x.5: expected an index from 0 to 1, found '5'",
        ),
        ("samples=", "command line: samples: expected a value, found ''"),
        ("samples=0,0", "command line: samples: expected each value once, found 0 twice"),
        ("samples", "command line: expected KEY=VALUE, the key as in a study"),
        (".".join("a" * 31) + "=1", "command line: expected keys of at most 30 parts"),
    ],
)
def test_what_fits_no_study_is_one_line_before_any_work(study, out, setting, complaint, capsys):
    assert main(["sweep", str(study), "--set", setting, "-o", str(out)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"pe: {complaint.format(study=study)}"), line
    assert not out.exists()


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (
            ["--set", "samples=0", "--set", "samples=2048"],
            "command line: samples: expected each key",
        ),
        pytest.param(
            ["--executor", "foo"],
            "command line: executor: expected dask://HOST:PORT, tcp://HOST:PORT",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            ["--executor", "tcp://u:p@127.0.0.1:1"],
            "command line: executor: expected dask://HOST:PORT",
            marks=pytest.mark.thorough,
        ),
        (["--executor", "os:getcwd"], "command line: executor: expected a function that returns a"),
        (["--set", "optimize.seed=5:5"], "command line: range: expected A:B with 1 to 10,000"),
        pytest.param(
            ["--executor", "tcp://127.0.0.1:1"],
            "tcp://127.0.0.1:1: scheduler: expected a",
            marks=pytest.mark.thorough,
        ),
        (["--set", SEEDS], "command line: runs: expected"),
    ],
)
def test_sweeps_that_cannot_be_are_one_line(study, out, more, complaint, capsys, monkeypatch):
    monkeypatch.setattr("pe_tools.cli.executors.CONNECT_S", 0.2)
    assert main(["sweep", str(study), "-o", str(out), *more]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"pe: {complaint}"), line


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("NoShutdown", "command line: executor: expected a function that returns a"),
        ("NoFutures", "executor: submit: expected an executor whose submit returns a"),
    ],
)
@pytest.mark.parametrize("verb", ["sweep", "optimize"])
def test_an_executor_that_is_none_is_one_line(
    study, out, verb, name, complaint, tmp_path, capsys, monkeypatch
):
    (tmp_path / f"own_{verb}_{name}.py").write_text(OWN_EXECUTORS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    named = ["--executor", f"own_{verb}_{name}:{name}"]
    assert main([verb, str(study), "-o", str(out), *named]) == 1
    line = [each for each in capsys.readouterr().err.splitlines() if each.startswith("pe: ")][-1]
    assert line.startswith(f"pe: {complaint}")


def test_files_of_somebody_s_own_are_refused_before_the_work(study, out, capsys):
    (out / "car").mkdir(parents=True)
    (out / "car" / "result.json").write_text("mine")
    assert main(["sweep", str(study), "-o", str(out)]) == 1
    assert f"pe: {out / 'car' / 'result.json'}: output: expected no file" in capsys.readouterr().err
    (out / "sweep.csv").write_text("mine")
    assert main(["sweep", str(study), "-o", str(out)]) == 1
    assert f"pe: {out / 'sweep.csv'}: output" in capsys.readouterr().err
    assert (out / "car" / "result.json").read_text() == "mine"


def test_names_are_safe_short_and_of_one_run_each():
    changes = [{"m": "a/b"}, {"m": "a b"}, {"m": "X"}, {"m": "x"}, {"m": "y" * 300}, {"m": "../é"}]
    names = folder_names([("car", each) for each in changes])
    names += folder_names([("..", {}), ("plain", {})])
    assert len({name.casefold() for name in names}) == len(names)
    for name in names:
        assert name.isascii() and not set(name) & set('/\\:*?"<>| ') and name[0] not in ".-"
        assert len(name) <= MAX_NAME_LENGTH + 9
    assert names[-1] == "plain" and names[0].startswith("car,m=a-b-")
    assert folder_names([("car", {"m": "x"})]) == ["car,m=x"]


def test_a_sweep_leaves_each_run_and_a_table(study, out, capsys):
    argv = ["sweep", str(study), "--set", "sensor.roof.position.2=1.7,1.9", "--optimize"]
    assert main([*argv, "-o", str(out), "--workers", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:4] == ["sensor.roof.position.2", "start", "entropy", "coverage"]
    assert sum("*" in line for line in lines[1:]) == 1 and len(lines) == 3
    data = json.loads((out / "sweep.json").read_text())
    for row, told in zip(table(out), data["runs"], strict=True):
        result = json.loads((out / row["run"] / "result.json").read_text())
        assert float(row["entropy"]) == told["entropy"] == result["entropy"]
        assert float(row["entropy_before"]) == result["before"]["entropy"]
        assert row["sensor.roof.position.2"] == told["changes"]["sensor.roof.position.2"]
        changed = pe.load_study(study)
        lidar = changed.rig["roof"]
        height = float(row["sensor.roof.position.2"])
        placed = replace(lidar, pose=replace(lidar.pose, position=(-0.43, 0.0, height)))
        searched = finished(pt.OptimizeJob(changed.with_rig(pe.Rig([placed]))))
        assert searched.after.entropy == result["entropy"]


def test_a_sweep_goes_on_and_does_nothing_twice(study, out, capsys):
    argv = ["sweep", str(study), "-o", str(out), "--workers", "1", "--set"]
    assert main([*argv, "samples=1024,2048"]) == 0
    before = {path: path.stat().st_mtime_ns for path in out.rglob("result.json")}
    capsys.readouterr()
    assert main([*argv, "samples=1024,2048,0"]) == 0
    err = capsys.readouterr().err
    assert "pe: 2 of 3 runs are done already" in err and "[3/3] car,samples=0" in err
    assert all(path.stat().st_mtime_ns == time for path, time in before.items())
    assert [row["samples"] for row in table(out)] == ["1024", "2048", "0"]
    (out / "car,samples=0" / "study.toml").write_text("changed")  # not that of the result any more
    (out / "car,samples=0" / "study.toml").unlink()
    assert main([*argv, "samples=1024", "--seed", "9"]) == 0
    assert "already" not in capsys.readouterr().err, "of another study"


def test_the_table_has_all_figures_that_were_computed(study, out, capsys):
    """Those of the dashboard of each run's result, before a search as well; the same after the
    same command has read them again."""
    text = study.read_text().replace(
        "[optimize]", '[[requirement]]\nname = "behind"\npreset = "r158_detection"\n[optimize]', 1
    )
    study.write_text(text)
    argv = ["sweep", str(study), "--optimize", "--set", "optimize.seed=1,2", "-o", str(out)]
    assert main([*argv, "--workers", "1"]) == 0
    first = table(out)
    shown = capsys.readouterr().out
    known = 0
    for row in first:
        result = json.loads((out / row["run"] / "result.json").read_text())
        for each in result["dashboard"]:
            key = each["figure"]
            value = each["value"]
            assert float(row[key]) == value if value is not None else key not in row, key
            known += value is not None
        before = result["figures"]["before"]
        assert float(row["blind_ground_before"]) == before["values"]["blind_ground"]
        assert row["requirements_checked"] == "1"
        values = result["figures"]["after"]["values"]
        assert all(float(row[key]) == value for key, value in values.items()) and "height" in values
    assert known > 8
    assert "blind ground" in shown and " of 1 met" in shown
    assert main(argv) == 0
    assert table(out) == first and capsys.readouterr().out == shown


def test_a_run_that_fails_is_named_and_the_others_are_kept(study, out, capsys):
    """No placement keeps to what the first one asks for; that shows only while it is searched."""
    argv = ["sweep", str(study), "--optimize", "--set", "limits.height=0.1,9.0"]
    assert main([*argv, "-o", str(out), "--workers", "1"]) == 1
    out_text, err = capsys.readouterr()
    (line,) = [line for line in err.splitlines() if line.startswith("pe: ")]
    assert line.startswith("pe: car,limits.height=0.1: ")
    assert [row["status"] for row in table(out)] == ["failed", "done"]
    assert table(out)[0]["message"] and "failed" in out_text


@pytest.fixture
def noted(monkeypatch):
    """Placements that a search evaluated, rather than took from its journal."""
    noted = []
    record = Journal.record

    def watched(self, rig, level, evaluated):
        noted.append(rig)
        record(self, rig, level, evaluated)

    monkeypatch.setattr(Journal, "record", watched)
    return noted


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
@pytest.mark.parametrize("ending", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.usefixtures("heeded_signals")
def test_a_sweep_that_is_ended_keeps_what_is_under_way(study, out, ending, capsys, noted):
    argv = ["sweep", str(study), "--optimize", "--set", "optimize.seed=3,4", "--workers", "1"]
    first = out / "car,optimize.seed=3"
    with Command([*argv, "-o", out], hang_in_score=2) as command:
        deadline = time.monotonic() + HANG_S
        while not (first / SEARCH).exists():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        command.send(ending)
        status = command.end()
    killed = ending == signal.SIGKILL
    assert status == (-ending if killed else 128 + ending)
    if not killed:
        kept = "0 of 2 runs are done, 1 begun and kept; the same command goes on"
        assert command.complaints == [f"pe: interrupted; {kept}\n"]
        assert [row["status"] for row in table(out)] == ["begun", "waiting"]
    assert not list(out.rglob(".*.tmp"))
    kept = len(read_search(first).evaluated)
    noted.clear()
    assert main([*argv, "-o", str(out)]) == 0
    err = capsys.readouterr().err
    assert "pe: 0 of 2 runs are done already; searches that go on: 1" in err
    evaluated = len(noted)
    noted.clear()
    whole = [finished(pt.OptimizeJob(replace_seed(pe.load_study(study), seed))) for seed in (3, 4)]
    assert [float(row["entropy"]) for row in table(out)] == [each.after.entropy for each in whole]
    assert evaluated == len(noted) - kept


def replace_seed(study, seed):
    return replace(study, search=replace(study.search, seed=seed))


class Dying(Executor):
    """An executor whose workers die with some tasks, and with all others handed out meanwhile."""

    def __init__(self, deadly, deaths):
        self.deadly = deadly
        self.deaths = dict.fromkeys(deadly, deaths)
        self.given = []
        self.open = []

    def submit(self, fn, call, task):
        self.given.append(task.study.search.seed)
        future = Future()
        seed = task.study.search.seed
        self.open.append(future)
        if self.deaths.get(seed, 0):
            self.deaths[seed] -= 1
            for each in self.open:
                if not each.done():
                    each.set_exception(BrokenExecutor("died"))
        elif seed not in HELD or len(self.open) > 2:
            future.set_result(fn(call, task))
        return future


class Place:
    threads = 1

    def __init__(self, executor, count):
        self.executor = executor
        self.count = count

    def width(self):
        return self.count

    def check(self):
        pass

    def checkpoints(self, run, folder):
        raise AssertionError("scores have none")


@pytest.mark.parametrize(("deaths", "named"), [(1, []), (2, ["run2"])])
def test_a_worker_that_dies_costs_at_most_the_run_that_killed_it(study, deaths, named):
    plain = replace(pe.load_study(study), samples=1024)
    tasks = {
        f"run{seed}": RunTask(replace(plain, search=replace(plain.search, seed=seed)), False, 1)
        for seed in (1, 2, 3)
    }
    found = {}
    executor = Dying({2}, deaths)

    def take(name, what):
        assert name not in found, "each once"
        found[name] = what

    run_all(list(tasks), tasks.get, Place(executor, 2), take)
    assert sorted(found) == ["run1", "run2", "run3"]
    failed = {name: str(what) for name, what in found.items() if isinstance(what, pe.InputError)}
    assert list(failed) == named
    for line in failed.values():
        expected = "a worker that survives its task, found two that died (BrokenExecutor)"
        assert line == f"run2: worker: expected {expected}"
    assert executor.given == [1, 2, 3, 1, 2], "what may be guilty is tried again, alone"


def test_parts_in_processes_of_their_own_and_the_same_command_after_them_merge(study, out):
    """A part writes no table and leaves the other runs alone; what a part did not do is done."""
    argv = ["sweep", str(study), "--set", "optimize.seed=0:5", "-o", str(out), "--workers", "1"]
    for part in ("1/3", "3/3"):
        with Command([*argv, "--part", part]) as command:
            assert command.process.wait(HANG_S) == 0
    assert not list(out.glob("sweep.*")) and len(list(out.iterdir())) == 3
    assert main(argv) == 0
    assert [row["optimize.seed"] for row in table(out)] == ["0", "1", "2", "3", "4"]
    assert {row["status"] for row in table(out)} == {"done"}
