"""Methods of search: the steps of Algorithm 1 as they always were, and asking and telling."""

import hashlib
import math
from concurrent.futures import ThreadPoolExecutor

import pytest

import pe_core as pe
from pe_core.search import METHODS, PARTS, Parametrization
from pe_core.search.methods import Given, Question
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
