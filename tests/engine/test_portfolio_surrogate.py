"""Surrogate descents: the model is what its equations say, and finds what others do not."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Evaluation, Parametrization, pose_values
from pe_core.search.methods import portfolio_surrogate as surrogate
from pe_core.search.methods.method import Given, Phase
from pe_core.search.methods.portfolio_linear import LinearDescent
from pe_core.search.methods.portfolio_surrogate import CubicModel, History, SurrogateDescent
from tests.engine import mounting
from tests.engine.mounting import can

PHASE = Phase(0, 1000)


def model_of(points, values):
    model = CubicModel(points.shape[1])
    for point, value in zip(points, values, strict=True):
        model.add(point, value)
    return model


def expected(model, points):
    return model.expected(points.T, model.distances(points.T))


def descent(landscape, rig, space, seed=0, step=0.2):
    """A surrogate descent, and a function that runs it and returns the rigs it asked for."""
    coding = Parametrization(rig, space)
    given = Given(coding, coding.start, landscape(rig))
    history = History(given.start, given.entropy)
    found = SurrogateDescent(given, history, given.start, given.entropy, [seed], step)

    def run(evaluations):
        asked = []
        questions = history.follow(found.descend(PHASE, evaluations))
        answers = None
        while True:
            try:
                question = next(questions) if answers is None else questions.send(answers)
            except StopIteration:
                return asked
            asked += [candidate.rig for candidate in question.candidates]
            answers = [Evaluation(landscape(c.rig), False) for c in question.candidates]

    return found, run


def test_the_model_is_the_solution_of_its_equations():
    rng = np.random.default_rng(0)
    points, values, at = rng.random((40, 6)), rng.random(40), rng.random((9, 6))
    distances = np.linalg.norm(points[:, None] - points, axis=2)
    tail = np.c_[np.ones(40), points]
    equations = np.block(
        [
            [distances**3 + surrogate.NOISE * np.eye(40), tail],
            [tail.T, -surrogate.TAIL_NOISE * np.eye(7)],
        ]
    )
    capped = np.r_[np.minimum(values, np.median(values)), np.zeros(7)]
    weights = np.linalg.solve(equations, capped)
    away = np.linalg.norm(at[:, None] - points, axis=2)
    definition = np.c_[away**3, np.ones(9), at] @ weights
    np.testing.assert_allclose(expected(model_of(points, values), at), definition, atol=1e-7)


def test_beyond_its_points_the_model_goes_on_downhill():
    """A tenth of the slope further, a plane is 0.525 lower."""
    rng = np.random.default_rng(1)
    points, slope = rng.random((30, 4)), np.array([1.0, -2.0, 0.0, 0.5])
    model = model_of(points, points @ slope)
    low = points[points @ slope < np.median(points @ slope)]
    fall = expected(model, low) - expected(model, low - 0.1 * slope)
    assert fall.min() > 0.25 and fall.max() < 0.8


def rugged(rig):
    """A wide valley that both sensors share, with ripples as high as its slope."""
    values = [pose_values(sensor.pose)[axis] for sensor in rig for axis in "xy"]
    away = [value - aim for value, aim in zip(values, (1.2, 0.5, -1.4, -0.6), strict=True)]
    ripples = sum(0.05 * (1.0 - math.cos(30.0 * each)) for each in away)
    return sum(each * each for each in away) + ripples


def test_among_small_valleys_it_ends_lower_than_a_linear_descent():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"), free=("x", "y"))
    ends = []
    for seed in range(5):
        found, run = descent(rugged, rig, space, seed)
        assert 120 <= len(run(120)) < 124
        ends.append(found.entropy)
    coding = Parametrization(rig, space)
    linear = LinearDescent(Given(coding, coding.start, rugged(rig)), coding.start, rugged(rig), 0.2)
    part = linear.descend(PHASE, 120, 1e-4)
    question = next(part)
    with pytest.raises(StopIteration):
        while True:
            question = part.send([Evaluation(rugged(c.rig), False) for c in question.candidates])
    assert np.median(ends) < 0.12 and max(ends) < linear.entropy


def test_it_neither_leaves_its_ranges_nor_breaks_a_rule():
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    rig, space = mounting.space(can((-1.0, 0.0, 1.6)), constraints=limits)
    coding = Parametrization(rig, space)
    found, run = descent(lambda rig: -rig["roof"].pose.position[0], rig, space)
    asked = run(100)
    assert not any(coding.broken(each) for each in asked)
    for variable, value in zip(coding.variables, found.best.vector, strict=True):
        assert variable.low <= value <= variable.high
    assert found.best.rig["roof"].pose.position[0] == pytest.approx(
        -0.2 - mounting.RADIUS, abs=0.03
    )


def test_it_ends_where_every_step_breaks_a_rule(monkeypatch):
    rig, space = mounting.space(can((-1.0, 0.0, 1.6)))
    found, run = descent(lambda rig: 0.0, rig, space)
    monkeypatch.setattr(Parametrization, "allowed", lambda *_: False)
    assert run(100) == [] and found.count == 0


def test_infinite_values_count_as_bad_ones_and_are_left_behind():
    def half(rig):
        x = pose_values(rig["roof"].pose)["x"]
        return x * x if x > -0.5 else math.inf

    rig, space = mounting.space(can(), free=("x", "y"))
    found, run = descent(half, rig, space)
    run(60)
    assert found.entropy < 0.01
    found, run = descent(lambda rig: math.inf, rig, space)
    assert run(20) == []
