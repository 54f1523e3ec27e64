"""Entropy over frames, tracks and scenarios: equations T1 to T5, bits of the paper, the command."""

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.setting import settings_of
from pe_core.base.values import Number
from pe_core.metric.entropy import BLIND_PRECISION, ap_of_entropy
from pe_core.metric.frames import Frames, predicted, updated
from pe_core.motion import Actor, Confirmation, Scenario, drive_by, scenarios
from pe_core.motion.clock import FrameClock
from pe_core.motion.detector_rank import rank_chain
from pe_core.motion.scan import factor_of, scan_factor
from pe_core.prior import ROAD_CLASSES
from pe_core.scene.objects import Objects
from pe_core.scoring.requirements.bodies import BODIES, Body
from pe_core.scoring.targets.object_metric import FusedObjects
from pe_core.sensors import ObjectMeasurementCache
from pe_tools.cli.verbs import main
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-24.0, 24.0), (-12.0, 12.0), (0.0, 2.0), 0.5)
FORWARD = pe.Camera("cam", 1280, 720, 1.2)
TIMES_S = (0.0, 0.3, 2.5, 1000.0)
TENTH = 0.1
"""Time between two frames [s]."""
STANDING = Scenario(
    "standing",
    speed_kmh=0.0,
    actors=(
        Actor("adult", BODIES["adult"], ((-1.0, 8.0, 1.0),)),
        Actor("wall", BODIES["car"], ((0.0, 4.0, 0.6),), watched=False),
    ),
)


def rig():
    roof = pe.Sensor("roof", pe.catalog.load("Pandar64"), pe.Pose.from_degrees((0, 0, 2.0)))
    front = pe.Sensor("front", FORWARD, pe.Pose.from_degrees((1.0, 0, 1.5)))
    return pe.Rig([roof, front])


def study(of=None, **other):
    car = shapes.box_car()
    return pe.Study(of or rig(), car, SPACE, samples=2048, **other)


def test_information_approaches_the_fixed_point_of_t1_and_t2():
    added = np.array([1e-3, 0.5, 3.0, 1e4])
    noise = 0.1
    precision = np.full(4, BLIND_PRECISION)
    for _ in range(20_000):
        precision = updated(predicted(precision, noise, 0.0), [added])
    steady = (added + np.sqrt(added * added + 4.0 * added / noise)) / 2.0
    assert np.abs(precision / steady - 1.0).max() < 1e-12


def by_definition(frames, rates, added, floor):
    """Return 1 / sigma^2 of numbers, with exact times: each sensor's frames backwards from 0."""
    ticks_per_s = math.lcm(*rates)
    step = 1.0 / ticks_per_s
    ticks = {}
    first = -(frames.frames - 1) * ticks_per_s // min(rates)
    for k, rate in enumerate(rates):
        for tick in range(0, first - 1, -(ticks_per_s // rate)):
            ticks.setdefault(tick, []).append(k)
    precision = floor
    last = None
    for tick in sorted(ticks):
        if last is not None:
            precision = max(1.0 / (1.0 / precision + frames.q * (tick - last) * step), floor)
        precision += sum(added[k] for k in ticks[tick])
        last = tick
    return precision


@pytest.mark.parametrize("rates", [(10, 10), (10, 30), (10, 13), (5, 20, 7)])
def test_frames_of_other_rates_are_fused_at_their_times(rates):
    kinds = [f"kind {k}" for k in range(len(rates))]
    added = [np.array([0.3 * (k + 1), 0.0, 2.0]) for k in range(len(rates))]
    frames = Frames(4, 2.0, rates=dict(zip(kinds, map(float, rates), strict=True)))
    fused = frames.fused(kinds, added, BLIND_PRECISION)
    for k, value in enumerate(fused):
        alone = by_definition(frames, rates, [float(a[k]) for a in added], BLIND_PRECISION)
        assert value == pytest.approx(alone, rel=1e-12)


@pytest.mark.parametrize("blind", ["floor", "literal"])
@pytest.mark.parametrize("kind", ["voxels", "grid", "objects"])
def test_without_memory_it_is_the_paper_to_the_bit(kind, blind):
    model = pe.PerceptionModel(blind)
    targets = pe.TargetRule("objects", scenes=16) if kind == "objects" else pe.TargetRule()
    scored = study(model=model, targets=targets)
    scored = replace(scored, samples=0) if kind == "grid" else scored
    paper = scored.evaluator().entropy(rig())
    forgetful = replace(scored, frames=Frames(5, math.inf, rates={"camera": 30.0}))
    assert forgetful.sight().over_frames(rig()) == paper
    assert scored.sight().over_frames(rig()) is None  # one frame is the entropy itself
    once = model.with_model(model.model, Frames(1, 1.0))
    assert replace(scored, model=once).evaluator().entropy(rig()) == paper
    some = replace(scored, frames=Frames(5, 0.01)).sight().over_frames(rig())
    more = replace(scored, frames=Frames(9, 0.01)).sight().over_frames(rig())
    assert more < some < paper


def test_a_class_has_its_own_noise():
    noises = {"pedestrian": 50.0}
    whole = study(frames=Frames(5, 1.0)).sight().over_frames(rig())
    mixed = study(frames=Frames(5, 1.0, noises=noises)).sight().over_frames(rig())
    forgetful = study(frames=Frames(5, 50.0)).sight().over_frames(rig())
    assert whole < mixed < forgetful
    same = dict.fromkeys(study().prior.class_names, 1.0)
    assert study(frames=Frames(5, 9.0, noises=same)).sight().over_frames(rig()) == whole


@pytest.mark.parametrize("time_s", TIMES_S)
@pytest.mark.parametrize(("needed", "window"), [(3, 5), (1, 1), (2, 3)])
def test_tracks_are_those_of_all_outcomes(time_s, needed, window):
    rule = Confirmation(needed)
    chain = rank_chain()
    step = chain.step(TENTH / time_s if time_s else math.inf)
    found = np.random.default_rng(7).random((2, 8))
    found[1, [2, 5]] = 0.0  # hidden: not found, whatever was before
    confirmed = np.zeros((2, 8))
    kept = np.zeros((2, 8))
    for row, outcome in itertools.product((0, 1), itertools.product((0, 1), repeat=8)):
        state = chain.shares  # how likely each rank is, with this outcome
        for k, hit in enumerate(outcome):
            state = state @ step if k else state
            p = chain.found(found[row, k])
            state = state * (p if hit else 1.0 - p)
        enough = [sum(outcome[max(0, k + 1 - window) : k + 1]) >= needed for k in range(8)]
        kept[row] += state.sum() * np.array(enough)
        confirmed[row] += state.sum() * np.maximum.accumulate(enough)
    assert np.abs(rule.confirmed(found, TENTH, window, time_s) - confirmed).max() < 1e-12
    assert np.abs(rule.kept(found, TENTH, window, time_s) - kept).max() < 1e-12


@pytest.mark.parametrize("time_s", TIMES_S)
def test_each_frame_finds_a_body_with_its_ap_whatever_was_before(time_s):
    found = np.random.default_rng(3).random((4, 60))
    found[1, 20:40] = 0.0  # nothing sees it
    found[2] = np.where(np.arange(60) < 30, 0.9, 0.05)
    found[3] = np.where(np.arange(60) < 30, 0.0, 0.999)
    assert np.abs(Confirmation(1).kept(found, TENTH, 1, time_s) - found).max() < 1e-12


def test_two_and_three_frames_are_those_of_a_gaussian_process():
    # P(all below the median) = 1/4 + asin(r) / 2 pi, and 1/8 + (sum of asin) / 4 pi
    time_s = 2.5
    arcs = [math.asin(math.exp(-k * TENTH / time_s)) for k in range(8)]
    two = Confirmation(2).kept([0.5, 0.5], TENTH, 2, time_s)[-1]
    assert two == pytest.approx(0.25 + arcs[1] / (2.0 * math.pi), abs=1e-3)
    three = Confirmation(3).kept([0.5] * 3, TENTH, 3, time_s)[-1]
    assert three == pytest.approx(0.125 + (2.0 * arcs[1] + arcs[2]) / (4.0 * math.pi), abs=1.5e-3)
    # frames in which nothing sees it say nothing: two that are seven apart
    apart = Confirmation(2).kept([0.5, *[0.0] * 6, 0.5], TENTH, 8, time_s)[-1]
    assert apart == pytest.approx(0.25 + arcs[7] / (2.0 * math.pi), abs=1e-3)


def test_the_correlation_of_ranks_is_the_same_over_one_long_step_or_several():
    chain = rank_chain()
    assert np.abs(chain.step(0.3) - chain.step(0.1) @ chain.step(0.2)).max() < 1e-12
    assert np.abs(chain.shares @ chain.step(0.3) - chain.shares).max() < 1e-14
    assert np.abs(chain.step(math.inf) - chain.shares).max() < 1e-12


def test_beams_meet_what_turns_with_the_scan_for_longer():
    assert (scan_factor(np.zeros(3), 10.0) == 1.0).all()
    assert scan_factor(2.0 * math.pi * 10.0 * 0.2, 10.0) == pytest.approx(1.25)
    turning = np.linspace(0.0, 0.5, 6)[None]  # 1 rad/s to the left
    roof, eye = rig().sensors

    lidar, camera = (float(factor_of(s, turning, 0.1, 10.0)[0, 2]) for s in (roof, eye))
    omega = 2.0 * math.pi * 10.0
    assert lidar == pytest.approx(omega / (omega + 1.0))  # against the scan, the worse way
    assert camera == 1.0


@pytest.mark.parametrize("samples", [0, 2048], ids=["grid", "sample"])
def test_a_sensor_with_its_own_curve_has_the_rate_of_its_kind(samples):
    """A curve of its own that is that of its kind changes nothing, at whatever rate."""
    frames = Frames(4, 2.0, rates={"camera": 37.0, "lidar": 5.0})
    cameras = [
        shapes.camera(60.0, (0.0, 0.0, 1.7), (0.0, 5.0, 90.0 * k), f"camera {k}") for k in range(2)
    ]
    lidar = pe.Sensor("roof", shapes.small_lidar(8, 180), pe.Pose((0.0, 0.0, 1.9)))
    curves = pe.PerceptionModel()
    given = {"samples": samples, "frames": frames}
    plain = pe.Rig([*cameras, lidar])
    own = pe.Rig([replace(each, curve=curves.curve(each.kind)) for each in plain])
    scores = [
        pe.Study(rig, None, shapes.small_space(), **given).key_figures().over_frames
        for rig in (plain, own)
    ]
    assert scores[0] == pytest.approx(scores[1], abs=1e-9)
    model = curves.with_model(curves.model, frames)
    drawn = [
        pe.Evaluator(shapes.small_space(), pe.Prior.road(), model=model, samples=samples).entropy(
            rig
        )
        for rig in (plain, own)
    ]
    assert drawn[0] == pytest.approx(drawn[1], abs=1e-9)


def test_a_scenario_at_rest_is_the_ap_of_objects_in_traffic():
    car = shapes.box_car()
    front = float(car.bounds[1][0])
    boxes = np.array([BODIES["adult"].box, BODIES["car"].hiding])
    centers = [(front + 8.0, 1.0, boxes[0, 2] / 2), (front + 4.0, 0.6, boxes[1, 2] / 2)]
    names = ("pedestrian", "car")
    objects = Objects(centers, boxes, [0.0, 0.0], [0, 1], class_names=names, scenes=[0, 0])
    m = ObjectMeasurementCache(objects, car, True).measure(rig())
    entropies, _ = FusedObjects(objects, np.ones(2), pe.PerceptionModel()).entropies(rig(), m)
    seen = drive_by(STANDING, rig(), car)
    assert len(seen.bodies) == 1
    assert np.abs(seen.bodies[0].ap - ap_of_entropy(entropies)[0]).max() < 1e-12
    alone = replace(STANDING, actors=STANDING.actors[:1])
    assert drive_by(alone, rig(), car).bodies[0].ap[0] > seen.bodies[0].ap[0]


def test_what_hides_is_at_least_the_prior_s_and_what_is_seen_is_small():
    sizes = {each.name: each.size for each in ROAD_CLASSES}
    for body in BODIES.values():
        least = np.array(sizes.get(body.class_name, body.size))
        assert (np.array(body.hiding) >= np.maximum(least, body.size)).all(), body.name
        assert (np.array(body.hiding) >= body.box).all()
    own = Body("own", (3.0, 1.5, 1.2), class_name="car")
    assert own.hiding == own.size  # it is as large as it is said to be
    adult, wall = STANDING.actors
    car = shapes.box_car()
    seen_wall = replace(STANDING, actors=(adult, replace(wall, watched=True)))
    hidden, both = (drive_by(scenario, rig(), car).bodies for scenario in (STANDING, seen_wall))
    assert both[0].ap.tolist() == hidden[0].ap.tolist()  # what has to be seen hides as well
    alone = drive_by(replace(STANDING, actors=(replace(wall, watched=True),)), rig(), car)
    assert both[1].ap.tolist() != [] and both[1].ap.max() <= alone.bodies[0].ap.max()


@pytest.mark.parametrize("name", ["crossing_child", "cut_in"])
def test_no_verdict_gets_better_with_a_larger_body_that_hides(name):
    car = shapes.box_car()
    scenario = scenarios()[name]
    watched = [actor for actor in scenario.actors if actor.watched]
    base = np.array(BODIES["car"].hiding)
    before = None
    for scale in (0.5, 1.0, 1.05, 1.5):
        size = tuple((base * scale).tolist())
        beside = Actor("beside", Body("own", size), ((0.0, -3.5, -2.6),), watched=False)
        ahead = Actor("ahead", Body("own", size), ((-6.0, 20.0, 3.5), (0.0, 9.0, 3.5)), False)
        driven = drive_by(replace(scenario, actors=(*watched, beside, ahead)), rig(), car)
        now = driven.bodies[0]
        if before is not None:
            assert (now.ap <= before.ap + 1e-12).all()
            assert (now.confirmed <= before.confirmed + 1e-12).all()
            margins = [-math.inf if b.margin_s is None else b.margin_s for b in (now, before)]
            assert margins[0] <= margins[1]
        before = now


def near_body(start_s=-3.0, **changed):
    """A scenario of a large body that stands near: each frame finds it with 0.999."""
    large = Body("large", (3.0, 5.0, 4.0), class_name="car")
    actor = Actor("large", large, ((start_s, 5.0, 0.0),))
    return Scenario("near", speed_kmh=0.0, actors=(actor,), **changed)


def confirmed_at(rates, of=None, **changed):
    seen = drive_by(near_body(**changed), of or pe.Rig([rig()["roof"]]), None, rates=rates)
    moment = seen.bodies[0].moments[0.9]
    return None if moment is None else moment.time_s


def test_a_slow_sensor_confirms_late():
    assert confirmed_at({}) == -2.8  # the third of ten frames a second
    assert confirmed_at({"lidar": 10.0}) == confirmed_at({"lidar": 40.0}) == -2.8
    assert confirmed_at({"lidar": 1.0}) == -1.0  # frames at -3, -2 and -1 s
    assert confirmed_at({"lidar": 0.5}, start_s=-6.0) == -2.0
    assert confirmed_at({"lidar": 0.5}) is None  # two frames
    assert confirmed_at({"lidar": 3.0}) == -2.3  # at -3, -2.6 and -2.3 s
    assert confirmed_at({"camera": 1.0}) == -2.8


def test_ap_is_that_of_the_last_frame():
    moving = Actor("adult", BODIES["adult"], ((-3.0, 60.0, 0.0), (0.0, 3.0, 0.0)))
    scenario = replace(near_body(), actors=(moving,))
    roof = pe.Rig([rig()["roof"]])
    whole, slow = (
        drive_by(scenario, roof, None, rates=rates).bodies[0].ap for rates in ({}, {"lidar": 2.0})
    )
    assert slow[:15].tolist() == np.repeat(whole[[0, 5, 10]], 5).tolist()
    clock = FrameClock.of(11, 10.0, 4.0)  # at 0, 0.25, 0.5, 0.75 and 1 s: at the next frame
    assert clock.frames.tolist() == [0, 3, 5, 8, 10]
    assert clock.last.tolist() == [0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 4]


def extremes(cls):
    """Return changes of a class of settings, one at a time: to its ends, and beside them."""
    for name, declared in settings_of(cls).items():
        rule = declared.rule
        if isinstance(rule, Number):
            ends = [rule.minimum, rule.maximum, rule.minimum + 5e-324, 1e-320, -1e-320, 1e308]
            yield from ({name: float(end)} for end in ends if math.isfinite(end))


@pytest.mark.parametrize("change", [*extremes(Scenario)], ids=str)
def test_a_scenario_at_the_ends_of_its_numbers_has_an_answer_or_one_line(change):
    try:
        scenario = replace(near_body(), **change)
        assert math.isfinite(scenario.brake_s) and math.isfinite(scenario.stop_m)
        json.dumps(drive_by(scenario, pe.Rig([rig()["front"]])).to_dict(), allow_nan=False)
    except pe.InputError as error:
        assert next(iter(change)) in str(error) or "frames" in str(error)


def test_the_scan_changes_no_bit_of_what_stands():
    car = shapes.box_car()
    before = drive_by(STANDING, rig(), car).to_dict()
    assert drive_by(STANDING, rig(), car, rates={"lidar": 20.0, "camera": 30.0}).to_dict() == before


def test_bodies_move_as_the_vehicle_drives_on():
    car = shapes.box_car()
    moving = replace(STANDING, speed_kmh=36.0)
    where, _ = moving.positions(car)
    front = float(car.bounds[1][0])
    assert where[0, 0] == pytest.approx((front + 18.0, 1.0))
    assert where[0, -1] == pytest.approx((front + 8.0, 1.0))
    reverse = replace(STANDING, speed_kmh=-36.0).positions(car)[0]
    assert reverse[0, 0] == pytest.approx((float(car.bounds[0][0]) - 18.0, 1.0))
    crossing = Actor("child", BODIES["child"], ((-1.0, 0.0, -2.0), (0.0, 0.0, 0.0)))
    turned = replace(moving, actors=(crossing,)).positions(car)
    assert turned[1][0] == pytest.approx(math.pi / 2)
    assert moving.brake_s == pytest.approx(-(0.5 + 10.0 / 12.0))
    assert moving.stop_m == pytest.approx(10.0 * 0.5 + 10.0**2 / 12.0)


@pytest.fixture
def file(tmp_path):
    car = shapes.box_car()
    pt.write_mesh(tmp_path / "car.npz", pe.Mesh(car.triangles, car.parts, car.part_names))
    pt.export_study(study(scenarios=(scenarios()["cyclist_from_right"],)), tmp_path / "study.toml")
    return tmp_path / "study.toml"


def test_the_command_says_when_each_body_is_confirmed(file, tmp_path, capsys):
    status = main(["check", str(file), "--scenarios", "--json", "-o", str(tmp_path / "out.json")])
    data = json.loads(capsys.readouterr().out)
    (scenario,) = data["scenarios"]
    whole = study().drive_by(scenarios()["cyclist_from_right"])
    assert scenario == json.loads(json.dumps(whole.to_dict()))
    assert json.loads((tmp_path / "out.json").read_text()) == data
    assert status == (0 if whole.is_met else 3)
    assert main(["check", str(file), "--scenarios", "all"]) == 3  # the child behind the cars
    assert "crossing_child" in capsys.readouterr().out
    assert main(["check", str(file), "--json"]) == status
    assert json.loads(capsys.readouterr().out)["scenarios"] == data["scenarios"]
    assert main(["check", "--list", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["scenarios"].keys() == scenarios().keys()
    own = tmp_path / "own.toml"
    own.write_text('[[scenario]]\npreset = "crossing_child"\nspeed_kmh = 10.0\n')
    assert main(["check", str(file), "--scenarios", str(own), "--json"]) in (0, 3)
    slow = json.loads(capsys.readouterr().out)["scenarios"][0]["bodies"][0]["margin_s"]
    assert slow is None or slow > -2.0
    assert main(["check", str(file), "--scenarios", "crossing"]) == 1
