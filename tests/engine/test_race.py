"""Races: a candidate that is surely worse on the first voxels is not evaluated on all of them."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import average_precision, entropy_of, sigma_of
from pe_core.scoring import Evaluator, draw
from pe_core.search import NO_VALUE, Leader, Processes, Value, as_objective, evaluate_all, optimize
from pe_core.search.race import SURE_ERRORS, Rise, rise_between
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-20.0, 20.0), (-20.0, 20.0), (0.0, 3.0), 0.2)
PRIOR = pe.Prior.road()
RUNS = 16
SAMPLES = 65_536
FIRST = SAMPLES // 16


@pytest.fixture(scope="module")
def car():
    return shapes.box_car()


@pytest.fixture(scope="module")
def evaluator(car):
    return Evaluator(SPACE, PRIOR, car, samples=SAMPLES)


def rig_at(x=0.0, z=1.8, pitch=0.0):
    return pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(), (x, 0.0, z), (0.0, pitch, 0.0))])


def near(leader, count=40):
    """Rigs near another one, and farther ones."""
    rng = np.random.default_rng(3)
    for scale in np.geomspace(1e-3, 1.0, count):
        x, z, pitch = scale * rng.normal(size=3)
        yield rig_at(x, 1.8 + abs(z), 60.0 * pitch)


def of_voxels(rig, sample, car):
    """The entropy of each voxel, by the definition of m and equations 4, 5 and 8."""
    [sensor] = rig
    m = pe.measure(sensor, sample.centers, SPACE.interval, vehicle=car)
    ap = average_precision(m, pe.PerceptionModel().curve("lidar"))
    return entropy_of(sigma_of(ap) ** -2)


def test_a_rise_is_the_mean_difference_of_the_same_voxels_and_its_error_the_scatter_of_runs(
    evaluator, car
):
    sample = draw(PRIOR.densities(SPACE), SPACE, FIRST, car.top(SPACE))
    leader = rig_at()
    for rig in (rig_at(0.3), rig_at(pitch=2.0)):
        differences = of_voxels(rig, sample, car) - of_voxels(leader, sample, car)
        mean = differences.mean()
        off = [(differences[sample.run == run] - mean).sum() for run in range(RUNS)]
        error = math.sqrt(np.square(off).sum() * RUNS / (RUNS - 1)) / len(differences)
        found = rise_between(evaluator.on_first(FIRST), leader, rig)
        assert found.nats == pytest.approx(mean, abs=1e-8)
        assert found.error == pytest.approx(error, abs=1e-8)


def test_the_first_voxels_are_those_of_the_whole_sample():
    """A difference on them is one on voxels of the whole sample: they begin the same sequence."""
    densities = PRIOR.densities(SPACE)
    first = draw(densities, SPACE, FIRST)
    whole = draw(densities, SPACE, SAMPLES)
    of_first_run = whole.index[whole.run == 0]  # a sixteenth of the sequence
    assert sorted(map(tuple, first.index)) == sorted(map(tuple, of_first_run))


def test_without_any_difference_the_error_is_not_zero(evaluator):
    """Placements that differ in voxels beside the sample would be told apart by nothing."""
    rise = rise_between(evaluator.on_first(FIRST), rig_at(), rig_at())
    assert rise.nats == 0.0
    assert rise.error > 0.0
    assert not rise.is_surely_above(0.0)


def test_a_race_is_lost_from_three_errors_on():
    assert SURE_ERRORS == 3.0
    rise = Rise(nats=0.31, error=0.1)
    assert rise.is_surely_above(0.0)
    assert not rise.is_surely_above(0.02)
    assert not Rise(nats=0.31, error=0.11).is_surely_above(0.0)


def test_a_race_stops_what_is_not_below_and_nothing_else(evaluator):
    objective = as_objective(evaluator)
    rig = rig_at()
    leader = Leader(rig, objective.value(rig))
    stopped = 0
    for candidate in near(rig):
        value = objective.value(candidate)
        raced = objective.below(candidate, leader.value, leader)
        assert raced == (value if value < leader.value else NO_VALUE)
        stopped += objective.figure.loses(candidate, rig, 0.0)
    assert stopped > 5


def test_a_cutoff_above_the_leader_s_value_leaves_a_candidate_that_much_more(evaluator):
    objective = as_objective(evaluator)
    rig = rig_at()
    value = objective.value(rig)
    worse = rig_at(pitch=25.0)
    assert objective.figure.loses(worse, rig, 0.0)
    rise = objective.value(worse).objective - value.objective
    cutoff = value.worse_by(rise + 0.01)
    assert objective.below(worse, cutoff, Leader(rig, value)) == objective.value(worse)


def test_a_small_sample_has_no_race(car):
    objective = as_objective(Evaluator(SPACE, PRIOR, car, samples=SAMPLES // 2))
    assert not hasattr(objective.figure, "loses")


def test_against_a_leader_that_breaks_constraints_nothing_races(evaluator):
    """Its figure says nothing: all that counts is which violation is less."""
    rig = rig_at()
    objective = as_objective(evaluator)
    broken = Value(1.0, math.inf)
    worse = rig_at(pitch=25.0)
    assert objective.below(worse, broken, Leader(rig, broken)) == objective.value(worse)


def test_processes_race_to_the_same_values(evaluator):
    objective = as_objective(evaluator)
    rig = rig_at()
    leader = Leader(rig, objective.value(rig))
    rigs = list(near(rig, count=12))
    here = evaluate_all(objective, rigs, leader.value, leader=leader)
    with Processes(2) as processes:
        there = evaluate_all(objective, rigs, leader.value, processes, leader=leader)
    assert here == there
    assert NO_VALUE in here


@pytest.mark.parametrize("method", ["portfolio", "random"])
def test_a_search_ends_where_it_ends_without_races(evaluator, method):
    """The figure as a plain function has no races; 120 candidates have none that errs."""
    space = pe.SearchSpace({"roof": {"x": (-1.0, 1.0), "pitch": (-0.1, 0.1)}})
    options = {"evaluations": 120, "method": method}
    raced = [step.value for step in optimize(evaluator, rig_at(), space, 1, **options)]
    plain = [step.value for step in optimize(evaluator.entropy, rig_at(), space, 1, **options)]
    assert raced == plain
