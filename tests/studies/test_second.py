"""The second plan: placements that were not used before, equal m, rows and columns."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scene.objects import Objects
from pe_core.sensors.kernels import ObjectView
from studies.detectors.analysis import HOLDS, REFUTED, UNDECIDED
from studies.detectors.placements import placements
from studies.detectors.plan import FIXED, full_plan
from studies.detectors.scores import COVERAGE, PRIMARY
from studies.detectors.second.analysis import BEYOND, second_analysis, tie_verdict
from studies.detectors.second.law import (
    PUBLISHED,
    camera_law,
    of_mean_ap,
    published_law,
    rows_and_beams,
    weighted,
)
from studies.detectors.second.plan import (
    arm_placements,
    full_second_plan,
    good_placements,
    quick_second_plan,
    second_runs,
)

FOLDER = Path(__file__).parents[2] / "docs/validity/own/second"


def test_the_good_placements_see_all_round_and_are_new():
    plan = full_second_plan()
    good = good_placements(plan)
    assert len(good) == 96 and all(p.all_round for p in good)
    known = {p.poses for p in placements(full_plan()) if p.design == FIXED}
    assert not known & {p.poses for p in good}
    assert plan.study.digest != full_plan().digest
    names = [run.name for run in second_runs(plan)]
    assert len(names) == len(set(names)) == 36 + 192
    assert names[0] == "equal-m-16-sedan-01-s1" and names[36] == "good-sedan-01-s1"


def test_arms_have_equal_beams_at_equal_poses():
    arms = arm_placements(full_second_plan())
    assert {len(p.poses) for p in arms} == {2}
    assert {p.lidar.beam_count for p in arms} == {28_800}
    assert sorted({len(p.lidar.elevations) for p in arms}) == [16, 32, 64]
    by_pose = {}
    for p in arms:
        by_pose.setdefault(p.poses, []).append(p.rig().sensors[0].model.name)
    assert len(by_pose) == 4
    assert all(n == ["16 x 1800", "32 x 900", "64 x 450"] for n in by_pose.values())
    assert len(second_runs(quick_second_plan())) == 4


def test_w_of_made_up_scans_is_found():
    shares = np.log([[1.0, 1.0], [1.0, 0.5], [0.5, 1.0], [0.5, 0.5]])
    ap = [0.8 + 0.1 * (2 * 0.7 * rows + 2 * 0.3 * columns) for rows, columns in shares]
    assert published_law(ap) == {"w": 0.7, "a": 0.1, "rmse": 0.0}
    assert all(0.65 < published_law(ap)["w"] < 0.78 for ap in PUBLISHED.values())


def test_half_is_the_number_of_beams():
    rows, beams = np.array([1.0, 4.0, 0.0]), np.array([7.0, 60.0, 0.0])
    assert weighted(rows, beams, 0.5) == pytest.approx(beams, rel=0.006)
    assert weighted(rows, beams, 1.0) == pytest.approx(rows**2, rel=0.006)


def test_rows_are_channels_of_each_lidar_that_meet_the_object():
    box = Objects(
        np.array([[10.0, 0.0, 0.9], [20.0, 0.0, 0.9]]),
        np.array([[1.0, 2.0, 1.8], [1.0, 1.0, 1.0]]),
        np.zeros(2),
        np.zeros(2, int),
        ("car",),
        np.zeros(2, int),
    )
    puck = catalog.load("Velodyne VLP-16 Puck")
    rig = pe.Rig([pe.Sensor(f"{z}", puck, pe.Pose((0.0, 0.0, z))) for z in (1.0, 1.5)])
    rows, beams = rows_and_beams(rig, ObjectView(box, None, True))
    spans = np.arctan(np.array([[-1.0, 0.8], [-1.5, 0.3]]) / 9.5)
    expected = sum(((puck.elevations > a) & (puck.elevations < b)).sum() for a, b in spans)
    assert rows[0] == expected and beams[0] > rows[0]
    assert rows[1] == beams[1] == 0.0  # behind the first


def test_saved_forecast_follows_from_its_errors():
    found = json.loads((FOLDER / "law.json").read_text("utf-8"))
    assert found["published"] == {name: published_law(ap) for name, ap in PUBLISHED.items()}
    assert found["cameras"] == camera_law()
    assert found["cameras"]["a"] == pytest.approx(0.026 / np.log(4.0), abs=1e-4)
    assert found["across"]["mean"] == of_mean_ap(found["across"]["classes"], full_plan())


def made_up(plan, gain, noise=0.002):
    """Return results in which rows gain, and AP of good placements follows their entropy."""
    rng = np.random.default_rng(5)
    quality = {p.name: rng.normal() for p in good_placements(plan)}
    results = {}
    for run in second_runs(plan):
        rows = len(run.placement.lidar.elevations) if run.placement.lidar else 16
        ap = 0.7 + gain * np.log2(rows / 16) + 0.02 * quality.get(run.placement.name, 0.0)
        results[run.name] = {"ap": ap + noise * rng.normal()}
    scores = {
        name: {
            "road": {"entropy": 10.0 - q, "coverage": rng.normal()},
            "uniform": 0.0,
            **{t: {"entropy": rng.normal(), "ap": rng.normal()} for t in ("alone", "traffic")},
            "beams": 1,
        }
        for name, q in quality.items()
    }
    return results, scores


def quickly(plan):
    rule = replace(plan.study.statistics, permutations=999, resamples=300)
    return replace(plan, study=replace(plan.study, statistics=rule))


def test_verdicts_of_made_up_runs():
    plan = quickly(full_second_plan())
    results, scores = made_up(plan, 0.05)
    found = second_analysis(plan, results, scores)
    assert found["done"] == found["planned"] == 228
    arms = found["equal-m"]["minus_first"]
    assert arms["64"]["mean"] == pytest.approx(0.1, abs=0.01) and arms["64"]["tie"] == REFUTED
    figures = found["good"]["figures"]
    assert len(found["good"]["placements"]) == 48
    assert figures[PRIMARY]["verdict"] == figures[BEYOND]["verdict"] == HOLDS
    assert figures[PRIMARY]["rho"] > 0.9 > abs(figures[COVERAGE]["rho"])
    assert figures[COVERAGE]["verdict"] in (UNDECIDED, REFUTED)
    same = second_analysis(plan, made_up(plan, 0.0)[0], scores)["equal-m"]["minus_first"]
    assert same["32"]["tie"] == same["64"]["tie"] == HOLDS


def test_no_verdict_before_a_part_is_done():
    plan = quickly(full_second_plan())
    results, scores = made_up(plan, 0.05)
    del results["good-bus-48-s2"]
    found = second_analysis(plan, results, scores)
    assert found["good"] is None and found["equal-m"]
    del results["equal-m-64-bus-02-s3"]
    assert second_analysis(plan, results, scores)["equal-m"] is None
    assert tie_verdict(-0.005, 0.02, 0.01) == UNDECIDED
