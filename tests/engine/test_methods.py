"""Search methods: what they share, and where each begins."""

import hashlib
import math
from concurrent.futures import ThreadPoolExecutor

import pytest

import pe_core as pe
from pe_core.search import METHODS, Parametrization, Value, pose_values
from pe_core.search.methods import Given, Question
from tests.engine import mounting, shapes
from tests.engine.mounting import can, roof
from tests.engine.recording import Recorder, distance_to

SPACE = shapes.small_space()


def fingerprint(steps):
    """Number of steps, and a digest of all that they told before methods had names."""
    digest = hashlib.sha256()
    count = 0
    for s in steps:
        told = (s.entropy, s.evaluations, s.fraction, s.round, s.improved)
        digest.update(repr((*told, [(own.name, own.pose) for own in s.best])).encode())
        count += 1
    return count, digest.hexdigest()[:16]


def on_the_box_car():
    """Rig, search space and evaluator of one LiDAR on a box."""
    rig = shapes.roof_rig(16, 180)
    car = shapes.box_car()
    evaluator = pe.Evaluator(SPACE, pe.Prior.road(), car, samples=4096)
    return evaluator, rig, pe.SearchSpace.on_vehicle(rig, car)


@pytest.mark.parametrize("executor", [None, ThreadPoolExecutor(2)])
@pytest.mark.parametrize(("seed", "digest"), [(0, "bc8462015e6638ea"), (1, "89dcdee0663b4dbd")])
def test_algorithm_1_takes_the_steps_it_always_took(seed, digest, executor):
    """Digests are of the search as it was before there were methods."""
    steps = pe.optimize(
        *on_the_box_car(), seed, pe.Schedule(candidates=10), method="random", executor=executor
    )
    assert fingerprint(steps) == (71, digest)


def test_algorithm_1_on_a_roof_with_a_no_go_area_takes_the_steps_it_always_took():
    limits = pe.Constraints(no_go=[pe.NoGo("hatch", x=(-0.2, 3.0))])
    rig, space = mounting.space(can(), mount={"roof": roof()}, constraints=limits)
    landscape = Recorder(distance_to({"x": 1.0}))
    schedule = pe.Schedule(candidates=30)
    steps = pe.optimize(landscape, rig, space, seed=3, schedule=schedule, method="random")
    assert fingerprint(steps) == (211, "e533652c3e57f69b")


@pytest.mark.parametrize(
    ("seed", "told"),
    [
        (0, (600, "f90bd1c4503227bf")),
        (1, (600, "8c71b8fe194e68c9")),
        (1, (640, "a0d62eb771879ae0")),
    ],
)
def test_the_portfolio_takes_the_steps_it_always_took(seed, told):
    """With two sensors that hinder each other: surveys, corners, a race, steps. A large budget has
    a third level."""
    rig = pe.Rig([shapes.lidar_on_roof(), shapes.camera()])
    space = pe.SearchSpace.on_vehicle(rig, shapes.box_car())
    wide = (0.9, 1.0, 1.001) if told[0] == 640 else (0.9, 1.0)
    levels = [Recorder(rugged(each)) for each in wide]
    steps = pe.optimize(levels, rig, space, seed, method="portfolio", evaluations=told[0])
    assert fingerprint(steps) == told


def rugged(wide):
    """A landscape with several hollows, and a ridge between its two sensors."""

    def landscape(rig):
        at = [pose_values(sensor.pose) for sensor in rig]
        bowl = sum((own["x"] - 0.4 * wide) ** 2 + 0.5 * (own["z"] - 1.7) ** 2 for own in at)
        turns = sum(0.1 * math.sin(3.0 * own["yaw"]) ** 2 + own["pitch"] ** 2 for own in at)
        near = abs(at[0]["x"] - at[1]["x"]) + abs(at[0]["y"] - at[1]["y"])
        return round(bowl + turns + 0.2 / (0.5 + near), 9)

    return landscape


def test_a_budget_ends_any_search():
    rig, space = mounting.space(can())
    for method in METHODS:
        recorder = Recorder(distance_to({"x": 1.0}))
        steps = list(pe.optimize(recorder, rig, space, method=method, evaluations=25))
        assert len(recorder.rigs) == steps[-1].evaluations == 25
        assert steps[-1].fraction == 1.0


def test_a_schedule_chooses_no_method():
    schedule = pe.Schedule(candidates=3)
    assert pe.Search().method == pe.Search(schedule=pe.Schedule()).method == "portfolio"
    with pytest.raises(pe.InputError, match="method: expected 'random' named with a schedule"):
        pe.Search(schedule=schedule)
    with pytest.raises(pe.InputError, match="method: expected 'random' named with a schedule"):
        rig, space = mounting.space(can())
        next(pe.optimize(objective=None, rig=rig, search_space=space, seed=0, schedule=schedule))


def test_what_a_method_asks_follows_from_its_answers_alone():
    """Sent the same answers, it asks the same again: what a journal of answers rests on."""
    rig, space = mounting.space(can())
    coding = Parametrization(rig, space)
    for method in METHODS.values():
        asked = []
        for _ in range(2):
            given = Given(coding, coding.start, Value(0.0, 1.0), seed=4, evaluations=60)
            asking = method.ask(given)
            questions = []
            question = next(asking)
            for number in range(8):
                questions.append([c and c.vector for c in question.candidates])
                count = len(question.candidates)
                values = [Value(0.0, math.sin(number + k)) for k in range(count)]
                question = asking.send(values)
            asked.append(questions)
        assert asked[0] == asked[1]


def test_a_lower_level_screens_candidates_but_makes_none_the_incumbent(monkeypatch):
    rig, space = mounting.space(can())
    coding = Parametrization(rig, space)
    near, far = (coding.candidate([x, 0.0, 1.5, 0.0]) for x in (0.5, 0.9))

    def ask(given):
        assert (yield Question((near,), level=1)) == [Value(0.0, 0.5)]
        assert (yield Question((far,), level=0)) == [Value(0.0, -1.0)]
        assert (yield Question((far,), level=1)) == [Value(0.0, 0.9)]

    monkeypatch.setitem(METHODS, "screened", pe.Method("Screened", "for a test", ask))
    levels = [Recorder(lambda rig: -1.0), Recorder(lambda rig: rig["roof"].pose.position[0])]
    *_, first, screened, last = pe.optimize(levels, rig, space, method="screened")
    for step in (first, screened, last):
        assert (step.best["roof"].pose, step.entropy, step.level) == (rig["roof"].pose, -0.43, 1)
