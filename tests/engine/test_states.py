"""States: parts and sensors that move, what a study file says of them, the table of conditions."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.sampling import CENTERED
from pe_core.scoring.sight.blind_ground import body_rectangle
from pe_core.search import Tolerance
from pe_core.study import Conditions, condition_table, study_to_dict
from pe_core.study.condition_table import study_objective
from pe_core.study.conditions import worst_verdict
from pe_tools.jobs import design_study
from pe_tools.page.markup import render
from pe_tools.page.sections.score import table_values
from tests.engine import shapes

BODY, DOOR, WHEEL = range(3)
HINGE = (0.8, 0.9, 0.6)
OPEN = pe.State("open", [pe.Motion(["door_*"], (0.0, 0.0, math.radians(70.0)), HINGE)])
WIDE_OPEN = pe.State("wide open", [replace(OPEN.motions[0], rotation=(0.0, 0.0, -1.2))])
LIFTED = pe.State("lifted", heave=0.2, pitch_rad=0.05, unsprung=["wheel_*"])


def car():
    """A body with a door on its left and a wheel."""
    boxes = [
        shapes.box((-2.0, -0.9, 0.3), (2.0, 0.88, 1.5)),
        shapes.box((-0.2, 0.88, 0.35), (0.8, 0.92, 1.3)),
        shapes.box((1.2, 0.7, 0.0), (1.8, 0.9, 0.6)),
    ]
    parts = np.repeat(np.arange(3), [len(b) for b in boxes])
    return pe.Vehicle(np.concatenate(boxes), parts, ("body", "door_left", "wheel_left"))


def rig():
    lidar = pe.catalog.load("Velodyne VLP-16 Puck")
    return pe.Rig(
        [
            pe.Sensor("roof", lidar, pe.Pose((0.0, 0.0, 1.7))),
            pe.Sensor("mirror", lidar, pe.Pose.from_degrees((0.6, 0.97, 1.1), (0, 20, 90))),
        ]
    )


def test_a_door_turns_about_its_hinge_and_takes_its_mirror_along():
    vehicle = car()
    moved = OPEN.vehicle(vehicle)
    door = vehicle.parts == DOOR
    assert np.array_equal(moved.triangles[~door], vehicle.triangles[~door])
    for before, after in zip(
        vehicle.triangles[door].reshape(-1, 3), moved.triangles[door].reshape(-1, 3), strict=True
    ):
        x, y, z = before - HINGE
        c = math.cos(math.radians(70.0))
        s = math.sin(math.radians(70.0))
        assert after == pytest.approx((0.8 + c * x - s * y, 0.9 + s * x + c * y, 0.6 + z))
    roof, mirror = OPEN.rig(rig(), vehicle)
    assert roof.pose == rig()["roof"].pose
    assert mirror.pose.rotation_deg == pytest.approx((0.0, 20.0, 160.0))
    x = -0.2
    y = 0.07
    assert mirror.pose.position[:2] == pytest.approx((0.8 + c * x - s * y, 0.9 + s * x + c * y))
    fixed = replace(OPEN, motions=[replace(OPEN.motions[0], sensors=["roof"])])
    roof, mirror = fixed.rig(rig(), vehicle)
    assert roof.pose != rig()["roof"].pose and mirror.pose == rig()["mirror"].pose


def test_a_body_heaves_pitches_and_leans_on_its_wheels():
    nose_down = pe.State(
        "loaded", heave=-0.1, pitch_rad=math.radians(2.0), unsprung=["wheel_*"], weight=0.5
    )
    vehicle = car()
    moved = nose_down.vehicle(vehicle)
    wheel = vehicle.parts == WHEEL
    assert np.array_equal(moved.triangles[wheel], vehicle.triangles[wheel])
    front = (moved.triangles[..., 0] > 1.5) & ~wheel[:, None]
    rear = moved.triangles[..., 0] < -1.5
    assert moved.triangles[front][:, 2].max() < moved.triangles[rear][:, 2].max() - 0.1
    pose = nose_down.rig(rig(), vehicle)["roof"].pose
    assert pose.rotation_deg == pytest.approx((0.0, 2.0, 0.0))
    assert pose.position[2] == pytest.approx(1.7 * math.cos(math.radians(2.0)) - 0.1)
    lean = pe.State("lean", roll_rad=math.radians(3.0))
    left, right = (
        lean.vehicle(vehicle).triangles[vehicle.triangles[..., 1] * side > 0.85][:, 2].max()
        for side in (1, -1)
    )
    assert left > right  # it leans to the right


def test_the_table_has_the_figures_of_each_condition_scored_alone():
    weathers = [pe.Weather("sun", 0.75), pe.Weather("fog", 0.25, fog_mor_m=40.0)]
    conditions = Conditions([pe.State("driving", weight=3.0), OPEN], weathers)
    study = pe.Study(rig(), car(), shapes.small_space(), samples=4096, conditions=conditions)
    table = condition_table(study)
    assert [(r.state, r.weather) for r in table.rows] == [
        (s, w) for s in ("driving", "open") for w in ("sun", "fog")
    ]
    alone = []
    for row, condition in zip(table.rows, conditions.all, strict=True):
        vehicle = condition.vehicle(study.vehicle)
        moved = condition.rig(study.rig, study.vehicle)
        moved = pe.Rig([replace(s, model=replace(s.model)) for s in moved])
        evaluator = pe.Evaluator(study.space, study.prior, vehicle, samples=4096)
        score = evaluator.score(moved)
        assert (row.entropy, row.stderr, row.coverage) == (
            score.entropy,
            score.stderr,
            score.coverage,
        )
        less = evaluator.entropy(pe.Rig([moved["roof"]]))
        assert row.without["mirror"] == pytest.approx(less, abs=2e-9)
        alone.append(score.entropy)
    assert table.mean == pytest.approx(np.average(alone, weights=[9, 3, 3, 1]), abs=1e-9)
    assert table.worst.entropy == max(alone)
    assert table.rows[2].covered["mirror"]["body"] > 0.05  # turned with its door, it faces the body
    assert table.rows[0].covered is None
    html = render("conditions.html", **table_values(table))
    assert html.count("heat worst") in (1, 2) and f"{abs(table.mean):.3f}" in html
    assert "without mirror" in html and "open, fog" in html
    data = table.to_dict()
    assert data["worst"]["entropy"] == max(alone) and len(data["rows"]) == 4


def parked(**under):
    """The car with a LiDAR on its left door's mirror, held to a cyclist who comes from behind."""
    zone = pe.requirements.Zone(path=((-7.0, 1.9), (-4.0, 1.9)))
    wanted = pe.requirements.Requirement(
        "dooring",
        zone,
        (pe.requirements.BODIES["cyclist"],),
        robust_to=pe.requirements.RobustTo(**under),
    )
    camera = pe.Camera("c", 640, 480, math.radians(40.0))
    back = pe.Sensor("back", camera, pe.Pose.from_degrees((0.6, 0.97, 1.1), (0, 0, 170)))
    conditions = Conditions([OPEN], [pe.Weather("dense fog", fog_mor_m=5.0)])
    return pe.Study(pe.Rig([back]), car(), requirements=(wanted,), conditions=conditions)


def test_a_requirement_is_met_under_each_state_and_weather_that_it_names():
    as_drawn, opened, foggy, both = (
        parked(**under).verdicts()[0]
        for under in (
            {},
            {"states": ["open"]},
            {"weathers": ["dense fog"]},
            {"states": ["*"], "weathers": ["*"]},
        )
    )
    assert as_drawn.met and as_drawn.condition == ""
    assert not opened.met and opened.condition == "open"
    assert not foggy.met and foggy.condition == "dense fog"
    assert not both.met and both.condition in ("open", "open, dense fog", "dense fog")
    study = parked(states=["open"])
    assert study_to_dict(study)["requirement"][0]["robust_to"] == {"states": ["open"]}
    checker = pickle.loads(pickle.dumps(study.checker()))
    assert checker.shortfalls(study.rig)[0] > 0.0 == parked().checker().shortfalls(study.rig)[0]
    with pytest.raises(pe.InputError, match="open"):
        parked(states=["opne"]).verdicts()


def test_what_blind_ground_leaves_to_spare_is_the_least_of_all_conditions():
    wanted = pe.requirements.Requirement(
        "ground",
        pe.requirements.Zone(x=("front + 1", "front + 1.5"), y=(-0.5, 0.5)),
        (),
        pe.requirements.Criterion(blind_m2=5.0, blind_height=0.8),
    )
    (found,) = replace(parked(), requirements=(wanted,)).verdicts()
    less = replace(found.ground, spare_m2=found.ground.spare_m2 - 0.5)
    worst = replace(found, margin=-1.0)
    joined = worst_verdict([found, worst, replace(found, ground=less)])
    assert joined.margin == -1.0 and joined.ground.spare_out is None
    assert joined.ground.spare_m2 == less.spare_m2


@pytest.mark.parametrize("state", [OPEN, WIDE_OPEN, LIFTED], ids=lambda state: state.name)
def test_what_stands_on_the_ground_does_not_move_with_the_vehicle(state):
    """Zones, the rectangle from which blind ground is measured, and the bodies of a scenario.

    A door that is wide open makes the vehicle 0.93 m wider.
    """
    requirement = pe.requirements.Requirement(
        "left",
        pe.requirements.Zone(x=("rear", "front"), y=("left + 0.5", "left + 1.5")),
        (pe.requirements.BODIES["child"],),
        robust_to=pe.requirements.RobustTo(states=("*",)),
    )
    study = pe.Study(rig(), car(), shapes.small_space(), conditions=Conditions([state]))
    study = replace(study, requirements=(requirement,))
    moved = study.under(study.conditions.one(state.name))
    bounds = [np.array(each.vehicle.bounds) for each in (study, moved)]
    assert np.abs(bounds[0] - bounds[1]).max() > 0.01
    zone, zone_moved = (each.checker().zones[0].corners for each in (study, moved))
    assert np.array_equal(zone, zone_moved)
    assert body_rectangle(moved.vehicle) == body_rectangle(study.vehicle)
    scenario = next(iter(pe.motion.scenarios().values()))
    assert np.array_equal(
        scenario.positions(moved.vehicle)[0], scenario.positions(study.vehicle)[0]
    )
    again = pickle.loads(pickle.dumps(moved.vehicle))
    assert body_rectangle(again) == body_rectangle(study.vehicle)
    undone = state.undone(moved.vehicle)
    assert np.abs(undone.triangles - study.vehicle.triangles).max() < 1e-12


def test_a_sensor_that_a_state_moves_may_fail_in_a_search():
    door = replace(OPEN.motions[0], sensors=["mirror"])
    search = pe.Search(samples=1024, conditions="mean", tolerance=Tolerance(failures=True))
    given = {"conditions": Conditions([pe.State("open", [door])]), "search": search}
    study = pe.Study(rig(), car(), shapes.small_space(), samples=1024, **given)
    evaluator = pe.Evaluator(study.space, study.prior, OPEN.vehicle(car()), samples=1024)
    worths = [evaluator.entropy(pe.Rig([sensor])) for sensor in OPEN.rig(rig(), car())]
    objective = study_objective(study, study.evaluator(), 1024, shift=CENTERED)
    assert objective.value(study.rig).objective == pytest.approx(np.mean(worths), abs=2e-9)
    with pytest.raises(pe.InputError, match=r"move\.sensors"):
        study.with_rig(pe.Rig([study.rig["roof"]]))
    # a design may leave it out; what else the state moves goes on
    assert design_study(study, {"mirror": None}).conditions.states[0].motions[0].sensors == ()
    alone = pe.State("mirror turned", [replace(door, parts=[])])
    study = replace(study, conditions=Conditions([alone]))
    assert design_study(study, {"mirror": None}).conditions.states[0].is_as_drawn


@pytest.mark.parametrize("how", ["mean", "worst"])
def test_a_search_minimises_the_mean_or_the_worst_of_the_table(how):
    weathers = [pe.Weather("sun", 0.75), pe.Weather("fog", 0.25, fog_mor_m=40.0)]
    study = pe.Study(
        rig(),
        car(),
        shapes.small_space(),
        samples=4096,
        conditions=Conditions([pe.State("driving"), OPEN, pe.State("never", weight=0.0)], weathers),
        search=pe.Search(conditions=how),
    )
    made = study_objective(study, study.evaluator(), 4096, shift=CENTERED)
    objective = pickle.loads(pickle.dumps(made))
    table = condition_table(study)
    expected = table.mean if how == "mean" else table.worst.entropy
    assert objective.value(study.rig).objective == expected
    below = objective.figure.below(study.rig, -100.0)  # one condition settles the worst
    assert below == (math.inf if how == "worst" else expected)
    assert study_to_dict(study)["optimize"]["conditions"] == how
    with pytest.raises(pe.InputError, match=r"\[\[state\]\] or \[\[weather\]\]"):
        plain = replace(study, conditions=Conditions())
        study_objective(plain, plain.evaluator(), 4096)
