"""AP curves fitted to our own detector: the fit against known curves, and the file that ships."""

import json
import tomllib

import numpy as np
import pytest

import pe_core as engine
from pe_core.scoring.targets import ObjectEvaluator, TargetRule
from pe_core.sensors import scan_curves as scan_file
from pe_core.sensors.perception import FILE
from studies.detectors.placements import placements, vehicle
from studies.detectors.plan import FIXED, PLAIN, full_plan
from studies.detectors.runs import runs
from studies.detectors.scan_curves import (
    BeamCounts,
    beam_counts,
    curves_text,
    date_of,
    fitted_curve,
    scan_curves,
)
from studies.detectors.scenes import CLASSES
from tests.studies.conftest import ROOT

PLAN = full_plan()
FEW = PLAN.but(statistics={"scenes": 16, "resamples": 20})
TRUE = engine.ApCurve(0.12, 0.1)


def counts(placements=12, seed=3):
    """Beams on objects of placements that differ in how many they meet and how often."""
    rng = np.random.default_rng(seed)
    m = np.unique(np.concatenate([[0], rng.lognormal(3.0, 1.5, 60).round()]))
    shares = rng.dirichlet(np.full(len(m), 0.3), placements)
    return BeamCounts(m, shares)


def results_of(plan, curve, planned=None):
    """Results of the fixed design in which each class has the AP of a curve, with all seeds."""
    chosen = [p for p in placements(plan) if p.design == FIXED]
    beams = beam_counts(plan, chosen)
    expected = {name: part.expected_ap(curve) for name, part in beams.items()}
    found = {}
    for run in [r for r in runs(plan) if r.design == FIXED and r.world == PLAIN][:planned]:
        if run.detector == "grid":
            by_class = {n: float(ap[chosen.index(run.placement)]) for n, ap in expected.items()}
            found[run.name] = {"ap": np.mean(list(by_class.values())), "by_class": by_class}
    return found


def test_the_fit_finds_the_curve_that_made_the_data():
    beams = counts()
    found = fitted_curve(beams, beams.expected_ap(TRUE))
    assert (found.a, found.b) == pytest.approx((TRUE.a, TRUE.b), abs=1e-5)


def test_the_fit_is_no_worse_than_any_curve_of_a_dense_grid():
    """With noise, and with a curve that is clipped at both ends: there is no better corner."""
    beams = counts(seed=5)
    rng = np.random.default_rng(6)
    for true in (TRUE, engine.ApCurve(0.5, -0.8)):
        ap = beams.expected_ap(true) + rng.normal(0.0, 0.02, len(beams.shares))
        error = ((beams.expected_ap(fitted_curve(beams, ap)) - ap) ** 2).sum()
        for a in np.geomspace(0.002, 0.9, 40):
            for b in np.linspace(-3.5, 1.4, 40):
                other = ((beams.expected_ap(engine.ApCurve(a, b)) - ap) ** 2).sum()
                assert error <= other + 1e-9


def test_expected_ap_is_that_of_the_evaluator():
    """The fit counts what a study with these curves is scored with."""
    chosen = [p for p in placements(PLAN) if p.name in ("fixed-bus-02", "fixed-sedan-01")]
    beams = beam_counts(FEW, chosen)
    assert set(beams) == set(CLASSES)
    model = engine.PerceptionModel(objects={"lidar": dict.fromkeys(CLASSES, TRUE)})
    for k, placement in enumerate(chosen):
        body = vehicle(placement.vehicle)
        rule = TargetRule("objects", True, 16)
        space = engine.PerceptionSpace()
        road = engine.Prior.road()
        evaluator = ObjectEvaluator(space, road, body, targets=rule, model=model)
        per_class = evaluator.score(placement.rig()).objects.per_class
        for name, part in beams.items():
            assert part.expected_ap(TRUE)[k] == pytest.approx(per_class[name].ap, abs=1e-8)


@pytest.mark.thorough
def test_curves_are_fitted_to_odd_placements_and_judged_on_even_ones():
    """Data of one curve give it back; a wrong AP of an even placement changes the error alone."""
    results = results_of(FEW, TRUE)
    found = scan_curves(FEW, results)
    assert (found["fitted"], found["judged"], found["seeds"]) == (16, 16, 3)
    assert found["done"] == found["planned"] == 96
    assert all(int(name[-2:]) % 2 == 0 for name in found["placements"])
    for row in found["classes"].values():
        assert (row["a"], row["b"]) == pytest.approx((TRUE.a, TRUE.b), abs=2e-3)
        assert row["rmse"]["fitted"][1] < 1e-3 and row["rmse"]["judged"][1] < 1e-3
        assert row["rmse"]["judged"][0] > 0.01
        assert row["a_interval"][0] <= row["a"] <= row["a_interval"][1]
    for name in (n for n in results if n.startswith("fixed-bus-02")):
        results[name]["by_class"]["car"] = 0.0
    car = scan_curves(FEW, results)["classes"]["car"]
    assert car["a"] == found["classes"]["car"]["a"] and car["rmse"]["judged"][1] > 0.05


def saved():
    path = ROOT / "docs" / "validity" / "own" / "results.json"
    return json.loads(path.read_text("utf-8"))["ap_curves"]


def test_the_engine_s_file_is_the_fit_of_the_saved_results():
    """Whoever commits more runs writes it: studies.detectors --page-only --curves FILE."""
    text = FILE.read_text("utf-8")
    assert text == curves_text(saved(), date_of(text))
    curves = scan_file()
    head = tomllib.loads(FILE.read_text("utf-8"))
    assert head["runs"] == head["planned"] == saved()["done"] == saved()["planned"]
    for name, row in saved()["classes"].items():
        assert curves["lidar"][name] == engine.ApCurve(row["a"], row["b"])
