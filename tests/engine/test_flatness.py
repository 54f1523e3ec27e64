"""How flat an optimum is: costs of steps by axis, and the budget of the analysis."""

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.sampling import HELD_OUT
from pe_tools.advice.flatness import AxisCost, StepCosts, axis_costs
from tests.engine import shapes
from tests.engine.processes import finished

TOP_M = 1.8


def study(evaluations):
    model = shapes.small_lidar(4, 90)
    rig = pe.Rig([shapes.lidar_on_roof(model, (0.0, 0.0, TOP_M - 0.004))])
    limits = {"roof": {"z": (1.6, TOP_M)}}
    settings = pe.Search(
        free={"roof": ("z", "pitch")}, limits=limits, samples=2048, evaluations=evaluations
    )
    return shapes.car_study(rig, search=settings, samples=2048)


@pytest.fixture(scope="module")
def outcome():
    return finished(pt.OptimizeJob(study(96), 1))


def test_costs_are_those_of_plain_evaluations_on_samples_that_the_search_did_not_use(outcome):
    found = outcome.flatness
    rig = outcome.study.rig
    halves = [study(96).evaluator(1024, shift=shift) for shift in HELD_OUT]
    row = next(each for each in found.axes if each.axis == "z")
    pose = rig["roof"].pose
    x, y, z = pose.position
    lower = rig.with_poses([pe.Pose.from_degrees((x, y, z - 0.01), pose.rotation_deg)])
    costs = [each.entropy(lower) - each.entropy(rig) for each in halves]
    assert row.cost[-1.0] == pytest.approx(np.mean(costs), abs=1e-12)
    assert row.cost[-1.0] != 0.0 and row.stderr > 0.0
    assert found.evaluations == 1 + 2 * 6


@pytest.mark.parametrize(("evaluations", "steps"), [(95, None), (96, 2), (191, 2), (192, 4)])
def test_the_steps_evaluate_an_eighth_of_the_search_at_most(evaluations, steps):
    found = finished(pt.OptimizeJob(study(evaluations), 1)).flatness
    assert (None if found is None else len(found.axes[0].cost)) == steps


def test_yaw_of_a_spinning_lidar_is_flatter_than_its_height(outcome):
    cost = {each.axis: each.worst for each in outcome.flatness.axes}
    assert abs(cost["yaw"]) < max(abs(cost["z"]), abs(cost["pitch"]))


class Slope:
    """An objective that falls with z, three times as steeply as with x."""

    def __call__(self, rig):
        x, _, z = rig["roof"].pose.position
        return -3.0 * z - x


def test_costs_of_a_slope_are_its_gradient_and_all_else_is_flat():
    rows = {
        row.axis: row
        for row in axis_costs(StepCosts(study(1).rig, [pe.Objective(Slope())]), "roof", (1.0, 5.0))
    }
    assert rows["z"].cost == pytest.approx({-1.0: 0.03, 1.0: -0.03, -5.0: 0.15, 5.0: -0.15})
    assert rows["x"].cost[-1.0] == pytest.approx(0.01)
    assert {axis for axis, row in rows.items() if row.word == "flat"} == {
        "y",
        "roll",
        "pitch",
        "yaw",
    }
    assert rows["z"].word == "steep"


def test_a_cost_within_its_error_is_not_noticed():
    assert AxisCost("roof", "x", {-1.0: 0.02, 1.0: 0.0}, stderr=0.02).word == "flat"
    assert AxisCost("roof", "x", {-1.0: 0.02, 1.0: 0.0}, stderr=0.001).word == "steep"
