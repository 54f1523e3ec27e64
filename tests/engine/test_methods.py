"""Search methods: what they share, CMA-ES, and block descent with its parts."""

import contextlib
import hashlib
import math
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from itertools import pairwise
from typing import ClassVar

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import METHODS, PARTS, Evaluation, Parametrization, pose_values
from pe_core.search.domains import RADIAN
from pe_core.search.methods import Given, Question, block_descent
from pe_core.search.methods.block_descent import Descent, corner_start, random_start
from pe_core.search.methods.cma_es import Evolution, SymmetricCma
from pe_core.search.methods.method import Phase
from pe_core.search.parametrization import feasible_start
from tests.engine import mounting, shapes
from tests.engine.mounting import can, roof
from tests.engine.recording import Recorder, distance_to, flat

SPACE = shapes.small_space()


def fingerprint(steps):
    """Number of steps, and a digest of all that they told before methods had names."""
    digest, count = hashlib.sha256(), 0
    for s in steps:
        told = (s.entropy, s.evaluations, s.fraction, s.round, s.improved)
        digest.update(repr((*told, [(own.name, own.pose) for own in s.best])).encode())
        count += 1
    return count, digest.hexdigest()[:16]


def on_the_box_car():
    """Rig, search space and evaluator of one LiDAR on a box."""
    rig, car = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180))]), shapes.box_car()
    evaluator = pe.Evaluator(SPACE, pe.Prior.road(), car, samples=4096)
    return evaluator, rig, pe.SearchSpace.on_vehicle(rig, car)


@pytest.mark.parametrize("executor", [None, ThreadPoolExecutor(2)])
@pytest.mark.parametrize(("seed", "digest"), [(0, "bc8462015e6638ea"), (1, "89dcdee0663b4dbd")])
def test_algorithm_1_takes_the_steps_it_always_took(seed, digest, executor):
    """Digests are of the search as it was before there were methods."""
    asked = (*on_the_box_car(), seed, pe.Schedule(candidates=10))
    steps = pe.optimize(*asked, method="random", executor=executor)
    assert fingerprint(steps) == (71, digest)


def test_algorithm_1_on_a_roof_with_a_no_go_area_takes_the_steps_it_always_took():
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    rig, space = mounting.space(can(), mount={"roof": roof()}, constraints=limits)
    landscape, schedule = Recorder(distance_to({"x": 1.0})), pe.Schedule(candidates=30)
    steps = pe.optimize(landscape, rig, space, 3, schedule, method="random")
    assert fingerprint(steps) == (211, "e533652c3e57f69b")


def test_a_budget_ends_any_search():
    rig, space = mounting.space(can())
    for method in (*METHODS, *PARTS):
        recorder = Recorder(distance_to({"x": 1.0}))
        steps = list(pe.optimize(recorder, rig, space, method=method, evaluations=25))
        assert len(recorder.rigs) == steps[-1].evaluations == 25
        assert steps[-1].fraction == 1.0


def test_an_unknown_method_is_refused_in_one_line():
    rig, space = mounting.space(can())
    with pytest.raises(pe.InputError, match=r"optimize: method: expected one of .*random") as error:
        next(pe.optimize(Recorder(flat), rig, space, method="simulated annealing"))
    assert "\n" not in str(error.value)
    with pytest.raises(pe.InputError, match="method"):
        pe.Search(method="annealing")


def test_on_another_level_the_best_so_far_is_evaluated_anew(monkeypatch):
    """A method that asks twice for one better placement: on few voxels, then on many."""
    rig, space = mounting.space(can())
    better = Parametrization(rig, space).candidate([0.5, 0.0, 1.5, 0.0])

    def ask(given):
        yield Question((better,), level=0, total=2)
        yield Question((better,), level=1, total=2, round=1)

    monkeypatch.setitem(METHODS, "twice", pe.Method("Twice", "for a test", ask))
    coarse, fine = (
        Recorder(distance_to({"x": 0.5})),
        Recorder(lambda rig: 7 + rig["roof"].pose.position[0]),
    )
    steps = list(pe.optimize([coarse, fine], rig, space, method="twice"))
    assert [(s.level, s.entropy, s.improved) for s in steps[1:]] == [
        (0, 0.0, True),
        (1, 7.5, True),
        (1, 7.5, False),
    ]
    assert [s.evaluations for s in steps] == [1, 2, 3, 4]
    assert [s.fraction for s in steps] == [0.0, 0.5, 0.5, 1.0]


def test_what_a_method_asks_follows_from_its_answers_alone():
    """Sent the same answers, it asks the same again: what a journal of answers rests on."""
    rig, space = mounting.space(can())
    coding = Parametrization(rig, space)
    for method in (METHODS | PARTS).values():
        asked = []
        for _ in range(2):
            given = Given(coding, coding.start, 1.0, seed=4, evaluations=60)
            asking, questions = method.ask(given), []
            question = next(asking)
            for number in range(8):
                questions.append([c and c.vector for c in question.candidates])
                values = [math.sin(number + k) for k in range(len(question.candidates))]
                question = asking.send([pe.scoring.Evaluation(v, False) for v in values])
            asked.append(questions)
        assert asked[0] == asked[1]


RELEASED = {
    "_cma.py": "a0f27c93e7a6b1dffd1097fa4adcc2026b396adcc50d21b8121edb01228a5be5",
    "LICENSE": "f37ff0eaa67cd538d2fac0e5868e412bd17973d3261ec8ff7e8116dc69eab695",
}
"""SHA-256 of the two files in cmaes-0.13.1-py3-none-any.whl of the Python package index."""


@pytest.mark.parametrize(("name", "digest"), RELEASED.items())
def test_the_file_of_the_package_cmaes_and_its_licence_are_as_released(name, digest):
    data = files("pe_core").joinpath("search", "_vendor", "cmaes", name).read_bytes()
    assert hashlib.sha256(data).hexdigest() == digest


def test_samples_do_not_depend_on_which_eigenvectors_are_found(monkeypatch):
    """Where eigenvalues are equal, LAPACKs differ: here each eigenvector is turned round."""

    def asked():
        cma = SymmetricCma(np.zeros(3), 0.5, seed=1, population_size=6)
        for _ in range(4):
            points = [cma.ask() for _ in range(6)]
            cma.tell([(p, float(np.round(p @ p, 9))) for p in points])
        return np.array([cma.ask() for _ in range(5)])

    plain, eigh = asked(), np.linalg.eigh
    monkeypatch.setattr(np.linalg, "eigh", lambda c: (eigh(c)[0][::-1], -eigh(c)[1][:, ::-1]))
    assert asked() == pytest.approx(plain, abs=1e-12)


def given_on_the_car(**options):
    rig, space = mounting.space(can(), **options)
    coding = Parametrization(rig, space)
    return Given(coding, coding.start, 1.0, seed=3)


def test_no_lower_bound_is_ranked_before_an_entropy():
    """Of the later half only what is below the worst of the first half is told as it is."""
    given = given_on_the_car()
    evolution = Evolution(given, given.parametrization.blocks[0], given.start, [1])
    asking, told = evolution.evaluate(given.start, Phase(0, 8)), []
    evolution._cma.tell = told.extend
    question = next(asking)
    assert question.cutoff == math.inf and len(question.candidates) == 4
    question = asking.send([Evaluation(v, False) for v in (4.0, 2.0, 3.0, 1.0)])
    assert question.cutoff == 4.0 and len(question.candidates) == 4
    answers = [Evaluation(4.0, True), Evaluation(0.5, False), Evaluation(9.0, True), None]
    with pytest.raises(StopIteration):
        asking.send(answers)
    assert [value for _, value in told] == [4.0, 2.0, 3.0, 1.0, 4.0, 0.5, 4.0, math.inf]


def test_every_candidate_is_in_its_range_and_keeps_to_the_rules():
    """Two metres of steps on a roof of 2.3 m with a hatch in it."""
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    given = given_on_the_car(mount={"roof": roof()}, constraints=limits)
    evolution = Evolution(given, given.parametrization.blocks[0], given.start, [1])
    evolution._cma._sigma = 2.0
    asking = evolution.evaluate(given.start, Phase(0, 8))
    question = next(asking)
    found = [c for c in question.candidates if c is not None]
    assert len({c.vector for c in found}) == len(found) >= 3
    for candidate in found:
        assert not given.parametrization.broken(candidate.rig)
        for unknown, value in zip(given.parametrization.variables, candidate.vector, strict=True):
            assert unknown.low - 1e-9 <= value <= unknown.high + 1e-9


PHASE = Phase(0, 1000)


@pytest.fixture(scope="module")
def coding():
    return Parametrization(*mounting.space(can(), can((0.2, 0.1, 1.6), "b")))


def answered(asking, value):
    """Drive a part of a method: each candidate is worth `value` of it; return what it returns."""
    try:
        question = next(asking)
        while True:
            answers = [c and Evaluation(value(c), False) for c in question.candidates]
            question = asking.send(answers)
    except StopIteration as stop:
        return stop.value


class Racer:
    """A descent whose entropy is its start's, less what it gains each time it goes down."""

    log: ClassVar[list] = []
    gain: ClassVar[dict] = {}

    def __init__(self, given, start, entropy, seed, step=None):
        self.best, self.entropy, self.count, self.spread = start, entropy, 0, 1.0
        self.log.append(("new", start, seed, step))

    def descend(self, phase, count, finest=0.0):
        yield from ()
        self.log.append(("descend", self.best))
        self.count, self.entropy = self.count + 10, self.entropy - self.gain.get(self.best, 0.0)


@pytest.fixture
def racers(monkeypatch):
    """Descents are racers, and starts are four: worth 3, 1, 2, and 4."""

    def start(name, entropy):
        def begin(given, phase):
            yield from ()
            return name, entropy

        return begin

    starts = [start(name, entropy) for name, entropy in (("a", 3), ("b", 1), ("c", 2), ("d", 4))]
    monkeypatch.setattr(block_descent, "STARTS", tuple(starts))
    monkeypatch.setattr(block_descent, "Descent", Racer)
    monkeypatch.setattr(Racer, "log", [])
    monkeypatch.setattr(Racer, "gain", {"c": 0.6})
    return Racer


def test_after_each_race_the_better_half_goes_on(racers, coding):
    """The third start gains 0.6 in each race: 3, 1, 1.4, 4 after the first, then 1 against 0.8."""
    given = Given(coding, coding.start, 5.0, seed=7)
    best, count = answered(block_descent._raced(given, 1000), None)
    assert [e[1] for e in racers.log if e[0] == "descend"] == ["a", "b", "c", "d", "b", "c"]
    assert (best.best, count) == ("c", 60.0)
    assert [e[2] for e in racers.log if e[0] == "new"] == [[7, n] for n in range(4)]


def test_repeats_begin_where_the_last_one_ended_wide_and_by_other_numbers_of_the_seed(
    racers, coding
):
    given = Given(coding, coding.start, 5.0, seed=7)
    answered(block_descent._repeated(given, Racer(given, "c", 1.0, [7, 2]), 1000, 25.0), None)
    wide = block_descent.RESTART_STEP
    assert wide == 0.25
    assert [e for e in racers.log if e[0] == "new"][1:] == [
        ("new", "c", [7, number], wide) for number in (4, 5, 6)
    ]


def test_a_corner_that_is_worse_than_the_start_is_left(coding):
    given = Given(coding, coding.start, 3.0)
    assert answered(corner_start(given, PHASE), lambda c: 4.0) == (given.start, 3.0)
    found, entropy = answered(corner_start(given, PHASE), lambda c: 2.0 + c.vector[0] / 10.0)
    assert entropy < 2.0 and found.vector[0] == given.parametrization.variables[0].low


def test_anywhere_is_another_place_with_the_angles_of_the_start(coding):
    given = Given(coding, coding.start, 3.0, seed=2)
    found, entropy = answered(random_start(given, PHASE), lambda c: 8.5)
    units = [unknown.unit for unknown in coding.variables]
    for unit, value, before in zip(units, found.vector, coding.start.vector, strict=True):
        assert (value == before) == (unit == RADIAN)
    assert entropy == 8.5


def test_on_another_level_the_best_is_worth_what_that_level_says(coding):
    descent = Descent(Given(coding, coding.start, 3.0, levels=2), coding.start, 3.0, [1, 0])
    answered(descent.reevaluate(Phase(1, 1000, 1)), lambda c: 6.0)
    assert (descent.entropy, descent.best) == (6.0, coding.start)


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
