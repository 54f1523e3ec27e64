"""A search goes on from the state in its folder, to the bits of one that was never broken off."""

import json
import math
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.search import METHODS, Journal
from pe_core.study import SEARCH
from pe_tools.cli.verbs import main
from pe_tools.jobs import SearchState, fingerprint, read_search
from tests.engine import shapes
from tests.engine.processes import ROOT
from tests.engine.recording import Recorder, distance_to
from tests.limits import HANG_S

pytestmark = pytest.mark.usefixtures("few_errors")
CANDIDATES = 12
MOMENTS = (1, 17, 40, 70)
"""Candidates after which a search is broken off: in the first round, and later ones."""
ENDING_ITSELF = """
import os, signal, sys
from pe_tools.cli import run_job
told, replaced, replace = [], [], os.replace

class Told(run_job.Reporter):
    def report(self, progress):
        print(progress.evaluations, file=sys.stderr, flush=True)
        if {moment} == ("told", progress.evaluations) and not told:
            told.append(True)
            os.kill(os.getpid(), signal.{signal})

def replace_and_end(*paths):
    replaced.append(paths)
    if {moment} == ("replaced", len(replaced)):
        os.kill(os.getpid(), signal.{signal})
    replace(*paths)

os.replace, run_job.Reporter = replace_and_end, Told
from pe_tools.__main__ import main
main()
"""
"""A search that is sent a real signal after so many placements, or in the middle of writing."""


def a_study(method="random"):
    more = {"method": method, "evaluations": 90, "schedule": pe.Schedule(candidates=CANDIDATES)}
    search = shapes.short_search({"roof": ("x", "z", "pitch")}, **more)
    return shapes.car_study(shapes.roof_rig(16, 90), search=search, samples=1024)


@pytest.fixture
def path(tmp_path):
    pt.export_study(a_study(), tmp_path / "car.toml")
    return tmp_path / "car.toml"


def result(folder):
    """What result.json says but for times; the files beside it have to be those it tells of."""
    data = json.loads((folder / "result.json").read_text("utf-8"))
    del data["run"]["seconds"]
    return data


def outcome_of(job, steps=None):
    """Run a job, as far as a number of placements."""
    for _ in job:
        if steps is not None and job.evaluations >= steps:
            break
    return job.outcome


@pytest.mark.parametrize("method", METHODS)
def test_every_method_goes_on_to_the_bits_of_an_unbroken_search(method):
    study = a_study(method)
    whole = outcome_of(pt.OptimizeJob(study, 1))
    known = ()
    for steps in MOMENTS:  # broken off again and again
        job = pt.OptimizeJob(study, 1, journal=Journal(known))
        outcome_of(job, steps)
        known = job.journal.entries
        assert len(known) >= steps
    end = outcome_of(pt.OptimizeJob(study, 1, journal=Journal(known)))
    data = pt.result_dict(end)
    expected = pt.result_dict(whole)
    del data["run"], expected["run"]
    assert data == expected
    assert end.evaluated == whole.evaluated


def search(study, objectives, journal):
    return pe.optimize(
        objectives,
        study.rig,
        study.search_space(),
        study.search.seed,
        schedule=study.search.schedule,
        method=study.search.method,
        journal=journal,
    )


def test_a_journal_of_other_placements_is_refused():
    study = a_study()
    journal = Journal()
    list(search(study, [Recorder(distance_to({"x": 0.1}))], journal=journal))
    other = replace(study, search=replace(study.search, seed=4))
    again = Journal(journal.entries, "out/search.json")
    with pytest.raises(pe.InputError, match=r"evaluated\[1\]: expected the placements"):
        list(search(other, [Recorder(distance_to({"x": 0.1}))], journal=again))


def broken_off(signum, moment, arguments):
    """Run a search that a signal ends; return the number of placements it had told of."""
    code = ENDING_ITSELF.format(signal=signum.name, moment=moment)
    command = [sys.executable, "-c", code, *map(str, arguments)]
    answer = subprocess.run(command, cwd=ROOT, stderr=subprocess.PIPE, text=True, timeout=HANG_S)
    assert answer.returncode in (-signum, 128 + signum), answer.stderr
    return max(int(line) for line in answer.stderr.splitlines() if line.isdecimal())


def test_a_kill_at_any_moment_loses_at_most_a_round(path, tmp_path, out):
    assert main(["optimize", "--no-review", str(path), "-o", str(tmp_path / "whole")]) == 0
    begin = (path, "-o", out)
    for moment in (("told", 20), ("replaced", 2), ("told", 71)):
        told = broken_off(signal.SIGKILL, moment, ["optimize", "--no-review", *begin])
        kept = len(read_search(out).evaluated)
        assert kept >= told - CANDIDATES - 1, "a round, and the candidate that had been evaluated"
        begin = ("--resume", out)
    assert main(["optimize", "--no-review", "--resume", str(out)]) == 0
    assert result(out) == result(tmp_path / "whole")


def begun_in(folder, **changes):
    """Leave the state of a search in a folder, with other words in it."""
    study = a_study()
    SearchState(study).save(folder, study, {"": ()})
    data = json.loads((folder / SEARCH).read_text("utf-8")) | changes
    (folder / SEARCH).write_text(json.dumps(data))
    return folder


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"version": "0.0.9"}, f"version: expected {pe.__version__}, the version of this program"),
        ({"perception-entropy": "other"}, "file: expected the state of a search, as this program"),
        ({"study": 3}, "file: expected the state of a search"),
        ({"study": "samples = 1024"}, "sensor: expected at least one [[sensor]], found none"),
        ({"study_sha256": "0"}, "study: expected unchanged files beside the study, found"),
        ({"journals": {"": [[[0.0, 1.0], "a"], [[0, 1], 2]]}}, "evaluated[1][1]: expected a text"),
        ({"journals": {"": [[math.nan, "a"]]}}, "file: expected valid JSON, found NaN"),
        ({"journals": {"": [[[0.0, 1.0], "\ud800"]]}}, "file: expected valid JSON, found half a"),
        ({"inputs": {"study": "\udfff"}}, "file: expected valid JSON, found half a surrogate"),
        ({"journals": {"": None}}, "evaluated: expected an array"),
        ({"journals": {"": {"a": 1}}}, "evaluated: expected an array"),
        ({"journals": {"": [[[0.0, -math.inf], "a"]]}}, "evaluated[0][0][1]: expected a number"),
        (
            {"journals": {"": [[[0, 1], "a", "b"]]}},
            "evaluated[0]: expected a list of value, digest",
        ),
        ({"journals": {"": [], "other": []}}, "journals: expected the journal of one search"),
    ],
)
def test_a_state_that_is_none_is_refused_in_one_line(out, changes, complaint, capsys):
    begun_in(out, **changes)
    assert main(["optimize", "--resume", str(out)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"pe: {out / SEARCH}: {complaint}")


def test_a_fingerprint_tells_studies_apart_by_what_they_are(tmp_path):
    """Not by the names of their files: a copy in another folder is the same study."""
    study = a_study()
    pt.export_study(study, tmp_path / "copy.toml")
    assert fingerprint(pe.load_study(tmp_path / "copy.toml")) == fingerprint(study)
    colored = pe.Rig([replace(sensor, color="#5fb8f7") for sensor in study.rig])
    assert fingerprint(study.with_rig(colored)) == fingerprint(study), "as it has in a window"
    body = study.vehicle
    others = [
        replace(study, samples=2048),
        replace(study, search=replace(study.search, seed=9)),
        replace(study, vehicle=replace(body, triangles=body.triangles + 0.001)),
        replace(study, vehicle=replace(body, parts=None, part_names=("other",))),
        replace(study, vehicle=None),
    ]
    prints = {fingerprint(other) for other in (study, *others)}
    assert len(prints) == len(others) + 1
