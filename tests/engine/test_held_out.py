"""A search's result is reported on samples that the search did not use, and agrees with all voxels.

A placement fits the voxels that it was searched on: on them its score is too good.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.sampling import HELD_OUT, SEARCHED, draw
from pe_core.search.tolerance import FRESH, mounted_off
from pe_tools.jobs import result_dict
from tests.engine import shapes
from tests.engine.processes import finished

SAMPLES = 1024
MAX_ERRORS = 3.5
"""A sampled figure differs from that of all voxels by no more than so many standard errors."""


def study(**search):
    """Two LiDARs whose pattern can be fitted to a thousand voxels."""
    model = shapes.small_lidar(8, 90)
    rig = pe.Rig(
        [
            shapes.lidar_on_roof(model, (0.6, 0.5, 1.8), name="left"),
            shapes.lidar_on_roof(model, (0.6, -0.5, 1.8), name="right"),
        ]
    )
    free = dict.fromkeys(("left", "right"), ("z", "roll", "pitch"))
    given = {"free": free, "samples": SAMPLES, "evaluations": 250} | search
    return shapes.car_study(rig, samples=SAMPLES, search=pe.Search(**given))


@pytest.fixture(scope="module")
def outcome():
    return finished(pt.OptimizeJob(study(), 1))


@pytest.fixture(scope="module")
def whole():
    """The evaluator of all voxels."""
    return study().evaluator(0)


def test_the_samples_are_independent_draws():
    """Of 1,024 draws among millions of voxels two samples have next to none in common."""
    space = pe.PerceptionSpace()
    densities = study().prior.densities(space)
    shifts = (SEARCHED, *HELD_OUT)
    found = [
        set(map(tuple, draw(densities, space, count=1024, excluded=None, shift=s).index))
        for s in shifts
    ]
    for one, other in combinations(found, 2):
        assert len(one & other) < 8


def test_the_search_flatters_its_result_and_the_report_does_not(outcome, whole):
    searched = study().evaluator(SAMPLES, shift=SEARCHED)
    rig = outcome.study.rig
    assert outcome.history[-1].value.objective == searched.entropy(rig)
    true = whole.entropy(rig)
    flattered = true - searched.entropy(rig)
    assert flattered > 0.1, "the case shows nothing: its search does not fit its voxels"
    assert abs(outcome.after.entropy - true) < MAX_ERRORS * outcome.after.stderr
    assert outcome.after.scatter.sample != searched.score(rig).scatter.sample


def test_a_gain_and_its_error_are_those_of_all_voxels(outcome, whole):
    true = whole.entropy(outcome.start.rig) - whole.entropy(outcome.study.rig)
    gain = outcome.before.entropy - outcome.after.entropy
    error = outcome.change_errors["entropy"]
    assert error > 0.0 and abs(gain - true) < MAX_ERRORS * error
    assert result_dict(outcome)["change_stderr"] == outcome.change_errors


def test_robustness_is_that_of_all_voxels(outcome, whole):
    found = outcome.robustness
    for rig, own in ((outcome.start.rig, found.before), (outcome.study.rig, found.after)):
        off = [whole.entropy(each) for each in mounted_off(rig, found.errors, 0, FRESH)]
        rise = np.mean(off) - whole.entropy(rig)
        assert abs(own.rise - rise) < MAX_ERRORS * own.stderr


def test_what_a_step_costs_is_that_of_all_voxels(outcome, whole):
    rig = outcome.study.rig
    base = whole.entropy(rig)
    off = []
    for row in outcome.flatness.axes:
        if row.axis not in ("x", "y", "z"):
            continue
        pose = rig[row.sensor].pose
        moved = np.array(pose.position) + 0.01 * np.eye(3)["xyz".index(row.axis)]
        poses = [
            replace(pose, position=tuple(moved)) if s.name == row.sensor else s.pose for s in rig
        ]
        change = whole.entropy(rig.with_poses(poses)) - base
        off.append((row.cost[1.0] - change) / row.stderr)
    assert np.sqrt(np.mean(np.square(off))) < MAX_ERRORS


def test_a_figure_that_a_search_keeps_is_searched_in_other_scenes():
    """As the change from the start: the start itself is no worse than what it has."""
    given = study(evaluations=40)
    given = replace(given, targets=pe.TargetRule(scenes=8))
    own = given.sight().in_traffic(given.rig).ap
    other = given.sight(SEARCHED).in_traffic(given.rig).ap
    assert own != other
    for wanted, is_met in ((own - 1e-3, True), (own + 1e-3, False)):
        search = replace(given.search, evaluations=1)
        kept = replace(given, search=search, limits=pe.Limits(traffic_ap=wanted))
        (first, *_) = finished(pt.OptimizeJob(kept, 1)).history
        assert first.value.is_feasible == is_met
