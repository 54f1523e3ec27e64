"""A search by an objective of one's own: what is minimised, told and kept."""

import json
import math
from dataclasses import replace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.cli.terminal import summary
from pe_tools.jobs import checkpoint, write_outcome
from tests.engine import shapes

pytestmark = pytest.mark.usefixtures("few_errors", "no_key_figures")


def cable_length(rig):
    """Metres from the sensor to the boot, by hand."""
    return sum(abs(s.pose.position[0] + 1.8) for s in rig)


def cable_cost(rig):
    """The same in a small currency: above all entropies."""
    return 1e5 * cable_length(rig)


class Bare:
    """A function as an object."""

    def __call__(self, rig):
        return -cable_length(rig)


def study(**search):
    options = {"samples": 2048, "seed": 4, "method": "random", "evaluations": 40}
    own = pe.Search({"roof": ("x", "z")}, **options | search)
    return shapes.car_study(shapes.roof_rig(), search=own)


def searched(objective, **search):
    job = pt.OptimizeJob(study(**search), 1, objective=objective)
    return list(job), job


@pytest.mark.parametrize(
    "objective", [cable_length, cable_cost, lambda rig: -rig.sensors[0].pose.position[0], Bare()]
)
def test_a_search_minimises_the_function_and_reports_it_beside_the_entropy(objective):
    steps, job = searched(objective)
    own = job.outcome.own
    found = job.outcome
    assert (own.before, own.after) == (objective(found.start.rig), objective(found.study.rig))
    assert own.after < own.before
    told = [job.figure.to_figure(row.value) for row in found.history]
    assert told == pytest.approx([objective(row.rig) for row in found.history], rel=1e-9)
    assert told == sorted(told, reverse=True) and len(told) > 1
    assert found.after.entropy == found.study.evaluator().score(found.study.rig).entropy
    assert found.robustness is None and found.flatness is None and found.seed_scatter is None
    texts = [step.value_text for step in steps if step.stage == "optimizing"]
    assert texts and all(text.startswith(job.figure.label) for text in texts)
    assert not any("broken" in text or "voxels" in text or "entropy" in text for text in texts)


def test_limits_of_the_study_are_kept_and_larger_figures_are_no_violation():
    given = replace(study(), limits=pe.Limits(blind_ground=True))
    job = pt.OptimizeJob(given, 1, objective=cable_cost)
    list(job)
    assert job.outcome.own.after < job.outcome.own.before
    start, end = (study().sight().blind_area(r, 0.5) for r in (job.study.rig, job.best.rig))
    assert end <= start
    free = searched(cable_cost)[1].best.rig
    assert cable_cost(free) <= job.outcome.own.after


def test_a_target_and_a_gain_are_of_the_function():
    job = pt.OptimizeJob(study(evaluations=400), 1, objective=cable_cost, target=0.9e5)
    list(job)
    assert job.outcome.stop_reason == "target" and job.outcome.own.after <= 0.9e5
    assert "ended at its target" in summary(job.outcome)


@pytest.mark.parametrize(
    ("objective", "search", "word"),
    [
        (7, {}, "int"),
        (cable_length, {"objective": "expected_ap"}, "expected_ap"),
        (cable_length, {"tolerance": pe.Tolerance(failures=True)}, "tolerance"),
        (cable_length, {"conditions": "mean"}, "conditions"),
    ],
)
def test_what_cannot_be_minimised_is_refused_before_the_search(objective, search, word):
    with pytest.raises(pe.InputError, match=word):
        pt.OptimizeJob(study(**search), objective=objective)


def test_a_function_that_returns_no_number_or_has_a_name_of_the_files_is_refused():
    def entropy(rig):
        return 1.0

    with pytest.raises(pe.InputError, match="entropy"):
        pt.OptimizeJob(study(), objective=entropy)
    for wrong in (None, math.nan, "low"):
        with pytest.raises(pe.InputError, match="number"):
            searched(lambda rig, wrong=wrong: wrong)


def test_a_search_resumes_with_its_own_function_only(tmp_path):
    _, job = searched(cable_length)
    write_outcome(job.outcome, tmp_path)
    assert list(json.loads((tmp_path / "search.json").read_text())["journals"]) == ["cable_length"]
    again = pt.OptimizeJob(study(), 1, objective=cable_length)
    assert checkpoint.resume(again, tmp_path) == len(job.journal.entries)
    for _ in again:
        pass
    first, second = (each.outcome.study.rig["roof"].pose for each in (job, again))
    assert first == second
    for other in (None, cable_cost):
        with pytest.raises(pe.InputError, match="cable_length"):
            checkpoint.resume(pt.OptimizeJob(study(), 1, objective=other), tmp_path)
