"""The default method: surveys, linear and surrogate descents, and slots."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Evaluation, Parametrization, pose_values
from pe_core.search.methods import portfolio
from pe_core.search.methods import portfolio_surrogate as surrogate
from pe_core.search.methods.method import Given, Phase
from pe_core.search.methods.portfolio import PLACEMENTS_PER_START, Incumbent, Survey
from pe_core.search.methods.portfolio_linear import LinearDescent
from pe_core.search.methods.portfolio_steps import BATCH, MultiscaleDescent
from pe_core.search.methods.portfolio_surrogate import CubicModel, History, SurrogateDescent
from tests.engine import mounting
from tests.engine.mounting import can
from tests.engine.recording import Recorder, distance_to, flat

PHASE = Phase(0, 1000)


def searched(landscape, rig, space, evaluations=0, seed=1):
    recorder = Recorder(landscape)
    options = {"method": "portfolio", "evaluations": evaluations}
    return recorder, list(pe.optimize(recorder, rig, space, seed, **options))


def answered(part, landscape):
    """Drive a part of a method to its end; return the sizes of its questions."""
    sizes = []
    try:
        question = next(part)
        while True:
            sizes.append(len(question.candidates))
            question = part.send([Evaluation(landscape(c.rig), False) for c in question.candidates])
    except StopIteration:
        return sizes


def linear(landscape, rig, space, radius=0.2):
    coding = Parametrization(rig, space)
    given = Given(coding, coding.start, landscape(rig))
    return LinearDescent(given, coding.start, given.entropy, radius)


def test_a_smooth_valley_is_found():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    target = {"x": 0.71, "y": -0.33, "z": 1.9, "pitch": 0.1}
    recorder, steps = searched(distance_to(target), rig, space)
    assert 0 <= len(recorder.rigs) - portfolio.budget(2) < 50
    assert math.sqrt(steps[-1].entropy) < 0.02 < math.sqrt(steps[0].entropy) / 50


def test_a_hollow_far_from_the_start_is_found_though_all_around_the_start_is_worse():
    def hollows(rig):
        x, y, _ = rig["roof"].pose.position
        return min(
            depth + (x - cx) ** 2 + (y - cy) ** 2
            for depth, cx, cy in ((1.0, -2.0, -0.8), (0.0, 2.0, 0.7))
        )

    rig, space = mounting.space(can((-2.0, -0.8, 1.6)))
    assert searched(hollows, rig, space)[1][-1].entropy < 0.01


def test_two_sensors_that_only_move_together_are_moved_together():
    """A valley along x of both: a sensor alone gets 0.25 m far."""

    def ridge(rig):
        a, b = (pose_values(sensor.pose) for sensor in rig)
        return 2.0 * (a["x"] - b["x"]) ** 2 + abs(a["x"] - 1.5)

    rig, space = mounting.space(can((-1.0, 0.3, 1.6)), can((-1.0, -0.3, 1.6), "b"), free=("x",))
    descent = linear(ridge, rig, space)
    answered(descent.descend(PHASE, 150, 1e-4), ridge)
    assert descent.entropy < 0.5 < ridge(rig)


def test_a_large_budget_races_descents_and_tells_where_they_ended_and_a_small_one_does_not():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    for short in (0, 1):
        evaluations = 2 * portfolio.RACING * PLACEMENTS_PER_START - short
        _, steps = searched(rugged, rig, space, evaluations)
        assert len(steps[-1].ends) == (0 if short else portfolio.RACING)
        assert all(end >= steps[-1].entropy for end in steps[-1].ends)
    assert len(set(steps[-1].ends)) == len(steps[-1].ends)


def test_sensors_of_one_model_take_values_from_each_other_and_move_together():
    """Along a narrow valley one sensor alone gets nowhere: here, equal pitches."""

    def ridge(rig):
        a, b = (pose_values(sensor.pose)["pitch"] for sensor in rig)
        return min(100.0 * abs(a - b), 1.0) + abs(a - 0.3)

    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"), free=("pitch",))
    other = rig["b"].model
    unlike = pe.Rig([rig["roof"], replace(rig["b"], model=replace(other, name="of another make"))])
    ends = []
    for each in (rig, unlike):
        coding = Parametrization(each, space)
        incumbent = Incumbent(coding.start, ridge(each))
        steps = MultiscaleDescent(Given(coding, coding.start, incumbent.entropy), [0])
        answered(steps.descend(incumbent, PHASE, 300), ridge)
        ends.append(incumbent.entropy)
    assert ends[0] < 0.02 and ends[1] > 0.2


def test_a_valley_as_narrow_as_a_step_is_found_beside_a_wide_one():
    """A descent by a model or by a distribution ends in the wide valley, at 1."""

    def valleys(rig):
        x = pose_values(rig["roof"].pose)["x"]
        return min(1.0 + x**2, 80.0 * abs(x - 0.4))

    rig, space = mounting.space(can((0.0, 0.0, 1.6)), free=("x",))
    coding = Parametrization(rig, space)
    incumbent = Incumbent(coding.start, valleys(rig))
    steps = MultiscaleDescent(Given(coding, coding.start, incumbent.entropy), [0])
    sizes = answered(steps.descend(incumbent, PHASE, 300), valleys)
    assert set(sizes) == {BATCH} and incumbent.count == sum(sizes) < 300 + BATCH
    assert incumbent.entropy < 0.2


def test_a_linear_landscape_takes_few_placements_to_the_end_of_its_range():
    """Of a plane the model is exact: after the simplex, each step is downhill to a corner."""

    def plane(rig):
        return sum(-pose_values(sensor.pose)["x"] - pose_values(sensor.pose)["y"] for sensor in rig)

    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"), free=("x", "y"))
    descent = linear(plane, rig, space)
    sizes = answered(descent.descend(PHASE, 60, 0.01), plane)
    assert sizes[:2] == [2, 2]  # the variables of one sensor after the other
    corner = [variable.high for variable in Parametrization(rig, space).variables]
    assert descent.best.vector == pytest.approx(corner, abs=0.02)


def test_sensors_in_slots_exchange_them_and_move_two_at_a_time():
    """Alone no sensor gains: what each wants the other one has, or both must go."""
    poses = [(-1.0, 0.0, 1.6), (-0.5, 0.3, 1.6), (0.0, -0.3, 1.6), (0.5, 0.0, 1.6)]
    slots = [pe.Slot(f"s{k}", pe.Pose(place)) for k, place in enumerate(poses)]
    rig = pe.Rig([can(poses[0]), can(poses[1], "b")])
    rack = pe.Mounting(mounts={"rack": pe.SlotMount(slots)}, on={"roof": "rack", "b": "rack"})
    space = pe.SearchSpace.on_vehicle(rig, mounting.car(), mounting=rack)

    def worth(rig):
        at = tuple(poses.index(sensor.pose.position) for sensor in rig)
        return {(0, 1): 3.0, (1, 0): 2.0, (3, 2): 1.0}.get(at, 4.0)

    recorder, steps = searched(worth, rig, space)
    assert steps[-1].entropy == 1.0
    assert len(recorder.rigs) < 600  # it ends where nothing better is left


def test_the_first_survey_is_the_same_for_every_seed_and_the_second_is_not():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    asked = [searched(flat, rig, space, 60, seed)[0].rigs for seed in (0, 1)]
    first, second = (
        [[s.pose for s in rig] for rig in rigs[: 1 + 4 * portfolio.SURVEYED]] for rigs in asked
    )
    half = 1 + 2 * (18 // 4)
    assert first[:half] == second[:half] and first[half] != second[half]


def test_a_survey_asks_for_one_sensor_at_a_time_and_tells_what_the_next_has_to_be_below():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    coding = Parametrization(rig, space)
    survey = Survey(Given(coding, coding.start, 5.0))
    part = survey.survey(Incumbent(coding.start, 5.0), PHASE, 4)
    question = next(part)
    assert (len(question.candidates), question.cutoff) == (4, 5.0)
    assert {c.rig["b"].pose for c in question.candidates} == {rig["b"].pose}
    question = part.send([Evaluation(value, False) for value in (6.0, 3.0, 4.0, 7.0)])
    assert question.cutoff == 3.0
    assert len({c.rig["roof"].pose for c in question.candidates}) == 1
    exact = Survey(Given(coding, coding.start, 5.0), exact=True)
    assert next(exact.survey(Incumbent(coding.start, 5.0), PHASE, 4)).cutoff == math.inf


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
