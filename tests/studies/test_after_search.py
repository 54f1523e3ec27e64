"""Detectors before and after a search: what is searched, what is compared, what is said."""

import json
import math

import numpy as np
import pytest

from benchmarks.search_problems import PROBLEMS
from pe_core import InputError
from pe_core.study import load_study
from studies.detectors.after_search import (
    PLACEMENTS,
    START,
    after_search_analysis,
    placement_name,
    searched_placements,
    study_of,
)
from studies.detectors.analysis import HOLDS, OPEN, REFUTED
from studies.detectors.page import answer_after_search
from studies.detectors.plan import (
    AFTER_SEARCH,
    full_after_search_plan,
    full_plan,
    quick_after_search_plan,
    rings_of,
)
from studies.detectors.runs import RunFiles, seed_by_seed
from studies.paper.paper import STUDIES
from studies.ranks import student_interval
from tests.studies.conftest import ROOT, search_alone, study

PLAN = full_after_search_plan()
DIGEST = "21f71ed6d5e047cc"
"""Of the plan as it was before its first run."""
FOLDER_OF_DOCS = ROOT / "docs" / "validity" / "own"


def results_of(gain, seeds=3, noise=0.003):
    """Results of runs in which each search gains AP; `gain` by rig and objective."""
    found = {}
    for k, rig in enumerate(PLAN.searches.rigs):
        for what in (START, *PLAN.searches.objectives):
            for seed in PLAN.training.seeds[:seeds]:
                more = gain.get((rig, what), 0.0)
                ap = 0.5 + 0.1 * k + more + noise * math.sin(7.0 * seed + len(what))
                rings = {ring: {"car": ap, "cone": ap} for ring in rings_of(PLAN)}
                found[f"{placement_name(rig, what)}-s{seed}"] = {"ap": ap, "by_ring": rings}
    return found


def test_the_plan_is_the_one_before_the_first_run():
    assert PLAN.digest == DIGEST != full_plan().digest
    assert PLAN.training.seeds == (1, 2, 3)


def test_rigs_are_the_lidars_of_the_studies_that_the_plan_names():
    """Poses and bounds of experiment 4, and of the benchmark's shuttle with its body."""
    paper = load_study(STUDIES / "4_cameras.toml")
    bench = PROBLEMS["shuttle of eight"].make()
    for rig, other in zip(PLAN.searches.rigs, (paper, bench), strict=True):
        ours = study_of(PLAN, rig, "entropy", 1)
        lidars = [s for s in other.rig if s.kind == "lidar"]
        assert [s.pose for s in ours.rig] == [s.pose for s in lidars]
        assert [s.model for s in ours.rig] == [s.model for s in lidars]
        own = ours.search
        theirs = other.search
        for sensor, lidar in zip(ours.rig, lidars, strict=True):
            assert own.free[sensor.name] == theirs.free[lidar.name]
            assert own.limits.get(sensor.name, {}) == theirs.limits.get(lidar.name, {})
        constraints = own.mounting.constraints, theirs.mounting.constraints
        assert len({each.clear_housings for each in constraints}) == 1
        assert np.allclose(ours.vehicle.bounds, other.vehicle.bounds)
        assert (own.seed, own.method, own.evaluations) == (1, "portfolio", 0)
    assert (
        len({study_of(PLAN, "shuttle", o, 1).search.objective for o in PLAN.searches.objectives})
        == 2
    )


@pytest.mark.thorough
def test_a_short_search_is_kept_and_its_runs_are_gone_on_with_by_resume_alone(
    tmp_path, monkeypatch
):
    """It ends within its bounds, and its file is not searched again."""
    search_alone(monkeypatch)
    plan = quick_after_search_plan()
    said = []
    assert [p.name for p in searched_placements(plan, tmp_path / AFTER_SEARCH)] == [
        "after-shuttle-start"
    ]
    found = searched_placements(plan, tmp_path / AFTER_SEARCH, said.append)
    assert len(said) == 2 and len(found) == 1 + len(plan.searches.objectives)
    again = searched_placements(plan, tmp_path / AFTER_SEARCH, lambda line: pytest.fail(line))
    assert again == found
    files = RunFiles(tmp_path / AFTER_SEARCH, plan, seed_by_seed(plan, found))
    files.write(files.all[0], {"ap": 0.5})
    run = study("detectors", "--after-search", "--quick", f"--output={tmp_path}")
    assert run.returncode == 1 and "1 of 3 runs; pass --resume" in run.stderr
    kept = json.loads((tmp_path / AFTER_SEARCH / PLACEMENTS).read_text("utf-8"))["searches"]
    by_ap = kept["shuttle, expected_ap"]
    assert by_ap["evaluations"] == 6 and by_ap["expected_ap"][1] >= by_ap["expected_ap"][0]
    (x, y, z, _, pitch, _), *_ = found[1].poses
    assert abs(x) <= 3.4 and abs(y) <= 1.4 and 0.4 <= z <= 2.9 and abs(pitch) <= 15.0
    with pytest.raises(InputError, match="plan"):
        changed = plan.but(digest="other")
        searched_placements(changed, tmp_path / AFTER_SEARCH)


def test_student_s_interval_by_hand():
    low, high = student_interval([1.0, 2.0, 3.0])  # t = 4.3027 with two degrees
    assert (low, high) == pytest.approx((2.0 - 4.302653 / 3**0.5, 2.0 + 4.302653 / 3**0.5))


def test_a_verdict_needs_all_seeds_of_its_comparison_and_a_sentence_both_rigs():
    gains = {(rig, "entropy"): 0.05 for rig in PLAN.searches.rigs}
    gains["shuttle", "expected_ap"] = 0.05
    found = after_search_analysis(PLAN, results_of(gains), {})
    verdicts = {
        (name, objective): row["verdict"]
        for name, rig in found["rigs"].items()
        for objective, row in rig["after"].items()
    }
    assert verdicts == {
        ("experiment_4", "entropy"): HOLDS,
        ("experiment_4", "expected_ap"): REFUTED,
        ("shuttle", "entropy"): HOLDS,
        ("shuttle", "expected_ap"): HOLDS,
    }
    assert found["answers"] == {"entropy": HOLDS, "expected_ap": REFUTED}
    all_rigs, one_rig = answer_after_search(found).split(". ")
    assert all_rigs == (
        "After a search by perception entropy a detector finds more than at the start on "
        "2 of 2 rigs (experiment 4 and shuttle)"
    )
    assert one_rig == (
        "After a search by expected AP in traffic a detector finds more than at the start on "
        "1 of 2 rigs (shown: shuttle; not shown: experiment 4)."
    )
    partly = after_search_analysis(PLAN, results_of(gains, seeds=2), {})
    assert set(partly["answers"].values()) == {OPEN} and "is open" in answer_after_search(partly)
    assert partly["rigs"]["shuttle"]["after"]["entropy"]["mean"] == pytest.approx(0.05, abs=0.01)
    worse = results_of({(rig, "entropy"): -0.05 for rig in PLAN.searches.rigs})
    told = answer_after_search(after_search_analysis(PLAN, worse, {}))
    assert "It was not shown that a detector finds more" in told


def test_the_committed_placements_are_of_this_plan_and_other_pages_tell_the_results():
    assert len(searched_placements(PLAN, FOLDER_OF_DOCS / AFTER_SEARCH)) == 6
    saved = json.loads((FOLDER_OF_DOCS / AFTER_SEARCH / "results.json").read_text("utf-8"))
    assert saved["done"] == saved["planned"] == 18
    means = [[v["mean"] for v in rig["by_ring"].values()] for rig in saved["rigs"].values()]
    assert [v[0] for v in means] == pytest.approx([-0.0475, -0.0306], abs=1e-4)
    assert [v[-1] for v in means] == pytest.approx([0.0859, 0.1139], abs=1e-4)
    told = (ROOT / "docs" / "optimize.md").read_text("utf-8")
    gains = [row["mean"] for rig in saved["rigs"].values() for row in rig["after"].values()]
    assert all(f"{gain:+.3f}" in told for gain in gains), "and the documentation its figures"
