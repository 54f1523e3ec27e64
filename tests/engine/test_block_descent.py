"""Block descent: it finds what others walk past, from afar, in slots, on several levels."""

import contextlib
import math
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import pytest

import pe_core as pe
from pe_core.scoring import Evaluation
from pe_core.search import Parametrization, pose_values
from pe_core.search.methods import PARTS, block_descent
from pe_core.search.methods.method import Given, Phase
from pe_core.search.parametrization import feasible_start
from tests.engine import mounting
from tests.engine.mounting import can
from tests.engine.recording import Recorder, distance_to

METHOD = PARTS["block-descent"]
POSES = [(-1.0, 0.0, 1.6), (-0.5, 0.3, 1.6), (0.0, -0.3, 1.6), (0.5, 0.0, 1.6), (0.7, 0.5, 1.6)]


def searched(landscape, rig, space, method="block-descent", evaluations=0, **options):
    recorder = Recorder(landscape, **options)
    steps = list(pe.optimize(recorder, rig, space, 1, method=method, evaluations=evaluations))
    return recorder, steps


@pytest.mark.parametrize(("method", "most_m"), [("block-descent", 0.01), ("cma-es", 0.004)])
def test_a_smooth_valley_is_found(method, most_m):
    rig, space = mounting.space(can(), can((0.2, 0.1, 1.6), "b"))
    target = {"x": 0.71, "y": -0.33, "z": 1.9, "pitch": 0.1}
    recorder, steps = searched(distance_to(target), rig, space, method, evaluations=800)
    assert len(recorder.rigs) <= 800
    assert math.sqrt(steps[-1].entropy) < most_m < math.sqrt(steps[0].entropy) / 100


def test_the_best_corner_is_found_from_the_opposite_one():
    """Hollows in the car's corners, the deepest one far from the start: descent alone stays."""

    def hollows(rig):
        x, y, _ = rig["roof"].pose.position
        return min(
            depth + (x - cx) ** 2 + (y - cy) ** 2
            for depth, cx, cy in ((1.0, -2.0, -0.8), (0.9, -2.0, 0.8), (0.0, 2.0, 0.8))
        )

    rig, space = mounting.space(can((-2.0, -0.8, 1.6)))
    _, steps = searched(hollows, rig, space)
    assert steps[-1].entropy < 0.01
    _, steps = searched(hollows, rig, space, evaluations=90)  # too few for a second start
    assert steps[-1].entropy > 0.8


def test_sensors_on_a_rack_take_the_best_slots():
    slots = [pe.Slot(f"s{k}", pe.Pose(place)) for k, place in enumerate(POSES)]
    rig = pe.Rig([can(POSES[0]), can(POSES[1], "b")])
    on = {"roof": "rack", "b": "rack"}
    rack = pe.Mounting(mounts={"rack": pe.SlotMount(slots)}, on=on)
    space = pe.SearchSpace.on_vehicle(rig, mounting.car(), mounting=rack)

    def apart(rig):
        one, other = (pose_values(sensor.pose)["x"] for sensor in rig)
        return abs(one - 0.7) + abs(other + 0.5)

    recorder, steps = searched(apart, rig, space)
    assert steps[-1].entropy == pytest.approx(0.0)
    assert len(recorder.rigs) < 100  # there are 20 placements
    coding = Parametrization(rig, space)
    assert not any(coding.broken(rig) for rig in recorder.rigs)


def test_the_last_placements_are_evaluated_on_all_voxels_of_the_search():
    assert METHOD.samples(65_536) == (16_384, 65_536)
    assert METHOD.samples(4_096) == (2_048, 4_096)
    assert METHOD.samples(1_024) == (1_024, 1_024)
    assert METHOD.samples(0) == (16_384, 0)
    rig, space = mounting.space(can())
    both = [Recorder(distance_to({"x": 0.5})), Recorder(distance_to({"x": 0.6}))]
    steps = list(pe.optimize(both, rig, space, method="block-descent", evaluations=300))
    levels = [step.level for step in steps]
    assert levels == sorted(levels)
    coarse = 1.0 - sum(levels) / len(levels)
    assert coarse == pytest.approx(block_descent.FIRST_LEVEL, abs=0.1)
    assert pose_values(steps[-1].best["roof"].pose)["x"] == pytest.approx(0.6, abs=0.01)
    for before, after in pairwise(steps):
        assert after.entropy <= before.entropy or after.level > before.level


def test_several_workers_take_the_same_steps():
    rig, space = mounting.space(can())

    def steps(executor):
        found = pe.optimize(
            Recorder(distance_to({"x": 0.5})),
            rig,
            space,
            method="block-descent",
            evaluations=90,
            executor=executor,
        )
        return [(s.entropy, s.best["roof"].pose, s.evaluations) for s in found]

    with ThreadPoolExecutor(2) as executor:
        assert steps(executor) == steps(None) == steps(lambda: None)


def driven(part, landscape):
    """Answer the questions of a part of the method; the number of placements of each question."""
    counts = []
    with contextlib.suppress(StopIteration):
        question = next(part)
        while True:
            counts.append(len(question.candidates))
            answers = [Evaluation(landscape(c.rig), False) for c in question.candidates]
            question = part.send(answers)
    return counts


def given_of(landscape, *sensors, evaluations=0):
    rig, space = mounting.space(*sensors)
    parametrization = Parametrization(rig, space)
    start = feasible_start(parametrization, 0)
    return Given(parametrization, start, landscape(start.rig), evaluations=evaluations)


def test_a_descent_ends_where_its_last_cycle_comes_nearest_to_its_budget():
    """All cycles are alike: 1.4 of them are 1, 1.6 are 2, and a budget of 0 evaluates nothing."""
    landscape = distance_to({"x": 0.5, "y": 0.1})
    cycles = []
    for share in (0.0, 1.0, 1.4, 1.6, 3.4, 3.6):
        given = given_of(landscape, can())
        descent = block_descent.Descent(given, given.start, given.entropy, [1])
        cycle = sum(driven(descent.cycle(Phase(0, 1)), landscape))
        driven(descent.descend(Phase(0, 1), share * cycle), landscape)
        cycles.append(descent.count / cycle - 1.0)
    assert cycles == [0.0, 1.0, 1.0, 2.0, 3.0, 4.0]


def test_starts_race_twice_for_a_twentieth_of_the_budget_each():
    """Four starts, then the better two: 4 x 0.05 + 2 x 0.05 of the budget."""
    landscape = distance_to({"x": 0.5, "y": 0.1})
    total = 4000
    given = given_of(landscape, can(), evaluations=total)
    part = block_descent._raced(given, total)
    asked = sum(driven(part, landscape))
    corners, random_placement = 8, 1
    assert asked - corners - random_placement == pytest.approx(0.3 * total, rel=0.05)
