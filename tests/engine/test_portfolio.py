"""The default method: surveys, a race of descents by steps of all lengths, and slots."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import Parametrization, Value, pose_values
from pe_core.search.methods import portfolio
from pe_core.search.methods.method import Given, Incumbent, Phase
from pe_core.search.methods.portfolio import PLACEMENTS_PER_START
from pe_core.search.methods.portfolio_steps import BATCH, MultiscaleDescent
from pe_core.search.methods.portfolio_survey import Survey
from tests.engine import mounting
from tests.engine.mounting import can
from tests.engine.recording import Recorder, distance_to

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
            question = part.send([Value(0.0, landscape(c.rig)) for c in question.candidates])
    except StopIteration:
        return sizes


def descended(landscape, rig, space, evaluations, seed=0):
    """Descend by steps from the start; return where it ended, and the rigs it asked for."""
    asked = []
    coding = Parametrization(rig, space)

    def noted(rig):
        asked.append(rig)
        return landscape(rig)

    incumbent = Incumbent(coding.start, Value(0.0, landscape(rig)))
    steps = MultiscaleDescent(Given(coding, coding.start, incumbent.value), [seed])
    answered(steps.descend(incumbent, PHASE, evaluations), noted)
    return incumbent, asked


def test_a_smooth_valley_is_found():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    target = {"x": 0.71, "y": -0.33, "z": 1.9, "pitch": 0.1}
    recorder, steps = searched(distance_to(target), rig, space)
    assert 0 <= len(recorder.rigs) - portfolio.default_budget(2) < 50
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


def test_a_race_tells_where_its_descents_ended_and_a_small_budget_has_none():
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    for short in (0, 1):
        evaluations = 2 * 2 * PLACEMENTS_PER_START - short
        _, steps = searched(rugged, rig, space, evaluations)
        assert len(steps[-1].ends) == (0 if short else 2)
        assert all(end >= steps[-1].value for end in steps[-1].ends)
    *_, last = searched(rugged, rig, space, 2 * 4 * PLACEMENTS_PER_START)[1]
    assert len(set(last.ends)) == portfolio.RACING


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
        ends.append(descended(ridge, each, space, 300)[0].value.objective)
    assert ends[0] < 0.02 and ends[1] > 0.2


def test_sensors_of_one_model_are_tried_beside_the_mirror_image_of_each_other():
    """Each axis but one as the other sensor's; none where it is of another model."""
    places = {"roof": ((0.2, 0.6, 1.6), (0.0, 6.0, 0.0)), "b": ((-0.4, -0.3, 1.9), (0.0, 0.0, 0.0))}
    rig, space = mounting.space(*[can(at, name, turn) for name, (at, turn) in places.items()])
    unlike = replace(rig["b"], model=replace(rig["b"].model, name="of another make"))
    asked = []
    for each in (rig, pe.Rig([rig["roof"], unlike])):
        coding = Parametrization(each, space)
        images = Survey(Given(coding, coding.start, Value(0.0, 5.0))).images(
            Incumbent(coding.start, Value(0.0, 5.0)), PHASE
        )
        sizes = answered(images, lambda rig: asked.append(rig) or 9.0)
        assert len(sizes) == (2 if each is rig else 0)
    for tried in asked:
        moved, kept = ("roof", "b") if tried["b"].pose == rig["b"].pose else ("b", "roof")
        at = pose_values(tried[moved].pose)
        other = pose_values(rig[kept].pose)
        image = {**other, "y": -other["y"]}
        apart = [axis for axis in ("x", "y", "z", "pitch") if abs(at[axis] - image[axis]) > 1e-9]
        assert len(apart) == 1, apart
    assert {tried["b"].pose == rig["b"].pose for tried in asked} == {True, False}


def test_hollows_that_few_voxels_alone_have_are_left():
    """Both lower levels have ripples. The last one evaluates few of the candidates."""
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    truth = distance_to({"x": 0.5, "z": 1.7})

    def coarse(rig):
        z = sum(pose_values(sensor.pose)["z"] for sensor in rig)
        return truth(rig) - 0.01 * math.sin(15.0 * z) ** 2

    def found(levels, seed):
        *_, end = pe.optimize(levels, rig, space, seed, method="portfolio", evaluations=700)
        return truth(end.best)

    ends = []
    for seed in range(3):
        levels = [Recorder(each) for each in (coarse, coarse, truth)]
        ends.append((found(levels[:2], seed), found(levels, seed)))
        assert 0 < len(levels[2].rigs) < len(levels[1].rigs) / 3
    without, screened = np.median(ends, axis=0)
    assert screened < 0.5 * without


def test_a_valley_as_narrow_as_a_step_is_found_beside_a_wide_one():
    """A descent by a model or by a distribution ends in the wide valley, at 1."""

    def valleys(rig):
        x = pose_values(rig["roof"].pose)["x"]
        return min(1.0 + x**2, 80.0 * abs(x - 0.4))

    rig, space = mounting.space(can((0.0, 0.0, 1.6)), free=("x",))
    coding = Parametrization(rig, space)
    incumbent = Incumbent(coding.start, Value(0.0, valleys(rig)))
    steps = MultiscaleDescent(Given(coding, coding.start, incumbent.value), [0])
    sizes = answered(steps.descend(incumbent, PHASE, 300), valleys)
    assert set(sizes) == {BATCH} and incumbent.count == sum(sizes) < 300 + BATCH
    assert incumbent.value < Value(0.0, 0.2)


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


def rugged(rig):
    """A wide valley that both sensors share, with ripples as high as its slope."""
    values = [pose_values(sensor.pose)[axis] for sensor in rig for axis in "xy"]
    away = [value - aim for value, aim in zip(values, (1.2, 0.5, -1.4, -0.6), strict=True)]
    ripples = sum(0.05 * (1.0 - math.cos(30.0 * each)) for each in away)
    return sum(each * each for each in away) + ripples


def test_a_descent_neither_leaves_its_ranges_nor_breaks_a_rule():
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    rig, space = mounting.space(can((-1.0, 0.0, 1.6)), constraints=limits)
    coding = Parametrization(rig, space)
    found, asked = descended(lambda rig: -rig["roof"].pose.position[0], rig, space, 200)
    assert asked and not any(coding.broken(each) for each in asked)
    for variable, value in zip(coding.variables, found.best.vector, strict=True):
        assert variable.low <= value <= variable.high
    assert found.best.rig["roof"].pose.position[0] == pytest.approx(
        -0.2 - mounting.RADIUS, abs=0.03
    )
