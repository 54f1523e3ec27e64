"""Expected AP in traffic as the objective of a search: its values, all that goes with it, files."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.sampling import CENTERED, HELD_OUT
from pe_core.search import Front, Goals
from pe_core.study import Conditions
from pe_core.study.condition_table import ExpectedApEvaluator, search_evaluator, study_objective
from pe_tools import jobs
from pe_tools.cli.terminal import summary
from pe_tools.jobs import result_dict
from pe_tools.page import ReportContext
from pe_tools.page.sections.score import flatness as flatness_section
from tests.engine import shapes
from tests.engine.processes import finished as driven
from tests.review.conftest import html_of

pytestmark = pytest.mark.usefixtures("few_errors")
AP = "expected_ap"


def study(goals=None, names=("roof",), **more):
    """A LiDAR or more on a box car among eight scenes of traffic; 30 placements."""
    model = shapes.small_lidar(16, 180)
    rig = pe.Rig(
        [shapes.lidar_on_roof(model, (0.0, 0.5 * k, 1.7), name=n) for k, n in enumerate(names)]
    )
    changes = {k: more.pop(k) for k in list(more) if k in ("rig", "conditions", "requirements")}
    given = {"free": dict.fromkeys(names, ("z", "pitch")), "objective": AP} | more
    search = pe.Search(samples=1024, evaluations=given.pop("evaluations", 30), **given)
    search = replace(search, goals=goals or Goals())
    targets = pe.TargetRule(scenes=8)
    space = pe.PerceptionSpace((-40, 40), (-20, 20), (0, 3), 0.5)
    own = {"rig": rig, "targets": targets, "samples": 1024, "search": search} | changes
    return pe.Study(vehicle=shapes.box_car(), space=space, **own)


def finished(given, workers=1, **more):
    return driven(pt.OptimizeJob(given, workers, **more))


def ap_of(given, rig):
    """The expected AP that a score of the study on objects in traffic has."""
    targets = pe.TargetRule("objects", traffic=True, scenes=given.targets.scenes)
    return replace(given, targets=targets).evaluator().score(rig).objects.ap


def placed(given, count):
    """Random placements of the study's search."""
    rng = np.random.default_rng(5)
    coding = given.coding()
    return [
        coding.candidate([rng.uniform(v.low, v.high) for v in coding.variables]).rig
        for _ in range(count)
    ]


@pytest.fixture(scope="module")
def plain():
    return finished(study())


def test_the_value_is_minus_the_ap_of_a_score_in_traffic():
    given = study(names=("roof", "front"))
    evaluator = search_evaluator(given, given.search.samples, shift=CENTERED)
    values = [evaluator.entropy(rig) for rig in placed(given, 6)]
    assert values == [-ap_of(given, rig) for rig in placed(given, 6)]
    assert len(set(values)) > 3
    again = pickle.loads(pickle.dumps(evaluator))
    assert isinstance(again, ExpectedApEvaluator)
    assert again.entropy(placed(given, 1)[0]) == values[0]


def test_a_search_raises_the_ap_and_tells_both(plain):
    first, last = plain.in_traffic
    assert last.ap > first.ap and last.traffic and last.scenes == 8
    assert (first.ap, last.ap) == tuple(
        ap_of(plain.start, o.rig) for o in (plain.start, plain.study)
    )
    values = [row.value.objective for row in plain.history]
    searched = search_evaluator(plain.start, plain.start.search.samples)
    assert values[-1] == searched.entropy(plain.study.rig) != -last.ap
    assert values == sorted(values, reverse=True)
    own = study().evaluator().score(plain.study.rig)
    assert plain.after.entropy == own.entropy and plain.before.entropy != own.entropy
    assert plain.robustness.after.entropy == plain.after.entropy
    text = summary(plain)
    assert f"AP in traffic {first.ap:.3f} -> {last.ap:.3f}\n" in text
    assert f"{plain.before.entropy:.3f} -> {plain.after.entropy:.3f} nats" in text
    assert "30 placements evaluated on 8 scenes of objects" in text


def test_the_analysis_is_of_the_ap():
    outcome = finished(study(evaluations=96))
    found = outcome.flatness
    best = outcome.study.rig
    x, y, z = best["roof"].pose.position
    lower = best.with_poses([replace(best["roof"].pose, position=(x, y, z - 0.01))])
    cost = next(each.cost[-1.0] for each in found.axes if each.axis == "z")
    own = outcome.study
    half = own.search.samples // 2
    halves = [search_evaluator(own, half, shift=shift) for shift in HELD_OUT]
    losses = [each.entropy(lower) - each.entropy(best) for each in halves]
    assert found.by_ap and cost == pytest.approx(np.mean(losses), abs=2e-9)
    table = result_dict(outcome)["flatness"]
    assert table["objective"] == AP
    text = summary(outcome)
    assert "nats: " not in text
    page = html_of(flatness_section, ReportContext("by AP", outcome))
    assert "What a step costs [expected AP]" in page and "nats" not in page


def test_tolerance_and_conditions_are_means_of_the_ap():
    tolerance = pe.Tolerance(0.05, 0.02, draws=2, failures=True)
    given = study(names=("roof", "front"), tolerance=tolerance)
    evaluator = search_evaluator(given, 1024, shift=CENTERED)
    objective = study_objective(given, evaluator, 1024)
    cases = [-ap_of(given, rig) for rig in tolerance.cases(given.rig)]
    assert objective.value(given.rig).objective == pytest.approx(np.mean(cases), abs=2e-9)
    lost = replace(given.search, tolerance=pe.Tolerance(failures=True, worst=True))
    worst = study_objective(replace(given, search=lost), evaluator, 1024)
    assert worst.value(given.rig).objective == max(
        -ap_of(given, r) for r in given.rig.without_each()
    )
    weathers = Conditions(weathers=[pe.Weather("sun", 0.7), pe.Weather("fog", 0.3, fog_mor_m=20.0)])
    search = replace(study().search, conditions="mean")
    foggy = replace(study(), conditions=weathers, search=search)
    values = [-ap_of(foggy, c.rig(foggy.rig, foggy.vehicle)) for c in weathers.all]
    mean = study_objective(foggy, search_evaluator(foggy, 1024), 1024, shift=CENTERED)
    assert values[1] > values[0]
    expected = 0.7 * values[0] + 0.3 * values[1]
    assert mean.value(foggy.rig).objective == pytest.approx(expected, abs=2e-9)
    outcome = finished(foggy)
    assert outcome.in_traffic[1].ap > 0.0 and outcome.conditions is not None


def test_a_front_has_the_ap_in_traffic_where_the_search_goes_by_it():
    goals = Goals(front=Front(("ap", "height"), 2))
    job = jobs.FrontJob(study(goals, evaluations=40), 1)
    list(job)
    for design in job.trade_off.front:
        assert design.figures["ap"] == ap_of(design.study, design.study.rig)
    with pytest.raises(pe.InputError, match=r"front\.objectives: ap: expected a study with metric"):
        list(jobs.FrontJob(study(goals, objective="entropy"), 1))
