"""Searches that keep requirements, what stands against one that is not met."""

import math
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.scoring.requirements import (
    BODIES,
    Body,
    Criterion,
    Requirement,
    RequirementChecker,
    RobustTo,
    Zone,
)
from pe_core.scoring.sight import BLIND_TO_M
from pe_core.search import NO_VALUE, Goals
from pe_core.study.requirement_search import constraints_of
from pe_core.study.suggestion import BLIND_SPOT, SAMPLES, repairs, suggestions, with_blind_spot
from pe_tools import advice
from pe_tools.jobs import result_dict
from tests.engine import shapes
from tests.engine.processes import finished

SEDAN = Path(__file__).resolve().parents[2] / "examples" / "robotaxi_sedan" / "1_roof.toml"

BEHIND = Zone(x=("rear + 0.6", "rear + 1.6"), y=(-0.6, 0.6), step=0.3)
AHEAD = replace(BEHIND, x=("front + 0.6", "front + 1.6"))
LEFT = Zone(x=(-1, 1), y=("left + 0.7", "left + 1.6"), step=0.3)
BLIND = ("blind_ground",)


def study(**search):
    """A van whose cameras look up: two of its three requirements are broken."""
    triangles = shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.4))
    cameras = (
        ("front", (2.53, 0.0, 0.93), 20.0, 0.0),
        ("rear", (-2.53, 0.0, 1.5), -20.0, 180.0),
        ("left", (0.0, 1.03, 1.5), -20.0, 90.0),
    )
    sensors = [shapes.lidar_on_roof(shapes.small_lidar(16, 180), (0.0, 0.0, 2.63), name="top")]
    sensors += [shapes.camera(100.0, at, (0.0, p, y), name) for name, at, p, y in cameras]
    zones = {"ahead": AHEAD, "behind": BEHIND, "left": LEFT}
    requirements = [Requirement(n, zone, (BODIES["child"],)) for n, zone in zones.items()]
    return pe.Study(
        pe.Rig(sensors),
        pe.Vehicle(triangles, clearance=0.0),
        pe.PerceptionSpace((-16, 16), (-16, 16), (0, 3), 0.2),
        requirements=requirements,
        samples=2048,
        search=pe.Search(
            free={name: ("z", "pitch") for name in ("front", "rear", "left")} | {"top": ()},
            samples=2048,
            **search,
        ),
        limits=pe.Limits(requirements=True),
    )


@pytest.mark.usefixtures("few_errors", "no_key_figures")
def test_a_search_that_starts_with_two_requirements_broken_ends_with_none():
    start = study(evaluations=400)
    assert [v.met for v in start.verdicts()] == [True, False, False]
    outcome = finished(pt.OptimizeJob(start, workers=1))
    assert [v.met for v in outcome.verdicts] == [True, True, True]
    values = [row.value for row in outcome.history]
    assert not values[0].is_feasible and values[-1].is_feasible
    assert values == sorted(values, reverse=True)
    assert values[-1].objective == pytest.approx(outcome.after.entropy, abs=0.5)
    assert not [w for w in outcome.warnings if w.code == "requirement"]


def test_a_requirement_that_cannot_be_kept_is_told_with_what_stands_against_it():
    """A fixed LiDAR sees no patch beside a wheel; a rear camera cannot look down and far up."""
    hopeless = Requirement("under", AHEAD, (BODIES["patch"],), Criterion(of=("lidar",)))
    start = study(evaluations=60)
    outcome = finished(
        pt.OptimizeJob(replace(start, requirements=(*start.requirements, hopeless)), workers=1)
    )
    told = [w.line for w in outcome.warnings if w.code == "requirement"]
    assert any("under is not met" in line and "alone" in line for line in told)
    down = shapes.camera(40.0, (-2.53, 0.0, 1.5), (0.0, 60.0, 180.0), "rear")
    near = Requirement("near", Zone(spots=(("rear + 0.8", 0.0),)), (BODIES["patch"],))
    far = Requirement(
        "far", Zone(spots=(("rear + 12", 0.0),)), (Body("lamp", (0.3, 0.3, 0.3), low=3.0),)
    )
    both = replace(
        start,
        rig=pe.Rig([start.rig["front"], down]),
        requirements=(near, far),
        search=replace(
            start.search,
            free={"front": (), "rear": ("pitch",)},
            limits={"rear": {"pitch": (math.radians(-20.0), math.radians(80.0))}},
        ),
    )
    assert [v.met for v in both.verdicts()] == [True, False]
    (found,) = suggestions(both).values()
    assert found.breaks == ("near",)


def test_the_nearest_change_of_one_sensor_is_suggested():
    """It meets the requirement, moves one sensor, and no shorter step of any variable does."""
    start = study()
    found = suggestions(start)
    assert set(found) == {"behind", "left"}
    for name, own in found.items():
        assert own is not None and len(own.moved) == 1 and own.moved[0] in own.text
        met = {v.name: v.met for v in start.verdicts(own.rig)}
        assert met[name] and set(own.breaks) == {n for n in met if not met[n]} - {"behind", "left"}
    for name, own in found.items():
        shorter = start.rig.with_poses(list(map(a_step_less, own.rig, start.rig)))
        assert not {v.name: v.met for v in start.verdicts(shorter)}[name]


def a_step_less(moved, start):
    """The pose on the way from a start, 1 cm or 0.01 rad before the pose that is moved."""
    pairs = [(moved.pose.position, start.pose.position), (moved.pose.rpy, start.pose.rpy)]
    ways = [np.array(new) - np.array(old) for new, old in pairs]
    length = max(np.abs(way).max() for way in ways)
    share = 0.0 if length == 0.0 else 1.0 - 0.01 / length
    return pe.Pose(
        *((np.array(old) + share * way).tolist() for (_, old), way in zip(pairs, ways, strict=True))
    )


def test_one_more_sensor_meets_what_no_move_meets():
    """It is of a model that the rig has, looks there, and its figures are those of the rig."""
    start = study()
    fixed = replace(start, search=replace(start.search, free=dict.fromkeys(start.search.free, ())))
    found = repairs(fixed, ("left",))
    assert set(found) == {"left"}
    (own,) = found["left"]
    assert own.added and own.breaks == () and len(own.rig) == len(start.rig) + 1
    met = {v.name: v.met for v in start.verdicts(own.rig)}
    assert met["ahead"] and met["left"]
    new = own.rig[own.moved[0]]
    assert new.model in [each.model for each in start.rig]
    evaluator = start.evaluator(SAMPLES)
    sight = start.sight()
    for effect, rig in ((own.before, start.rig), (own.after, own.rig)):
        assert effect.entropy == evaluator.entropy(rig)
        assert effect.blind_m2 == pytest.approx(sight.blind_area(rig, BLIND_TO_M))
    assert new.model.name in own.sentence and f"{own.after.blind_m2:.1f} m2" in own.sentence
    assert own.to_dict()["poses"] == {own.moved[0]: [*new.pose.position, *new.pose.rotation_deg]}


def test_a_blind_place_is_mended_and_what_is_seen_needs_nothing():
    """The place is blind before, and not after; the study's requirements tell what breaks."""
    start = study()
    place = (0.0, 1.6)
    found = repairs(with_blind_spot(start, place), (BLIND_SPOT,))[BLIND_SPOT]
    assert [each.added for each in found] in ([False, True], [True])
    sight = start.sight()

    def is_blind(rig):
        away = [line - place for line in sight.blind(rig, BLIND_TO_M).outlines]
        turned = sum(np.diff(np.unwrap(np.arctan2(y, x))).sum() for x, y in (a.T for a in away))
        return round(turned / (2.0 * math.pi)) == 1

    assert is_blind(start.rig) and not any(is_blind(each.rig) for each in found)
    for each in found:
        met = {v.name: v.met for v in start.verdicts(each.rig)}
        assert set(each.breaks) == {name for name in ("ahead",) if not met[name]}
    assert all(each.after.blind_m2 < each.before.blind_m2 for each in found)
    assert repairs(with_blind_spot(start, (8.0, 0.0)), (BLIND_SPOT,)) == {}


def test_a_lidar_is_added_where_a_person_would_mount_it():
    """Beside the sedan's door it is tilted over the edge of the roof: at the wheel arch the body
    hides four of ten of its rays."""
    start = pe.load_study(SEDAN)
    (own,) = repairs(with_blind_spot(start, (0.4, 1.7)), (BLIND_SPOT,))[BLIND_SPOT]
    assert own.added and own.occluded <= 0.1 and own.is_gain
    pose = own.rig[own.moved[0]].pose
    assert pose.position[2] > 0.9 * start.vehicle.bounds[1][2]
    turned = math.degrees(pose.rpy[2])
    assert pose.rpy[1] > 0.0 and 0.0 < turned < 180.0, "tilted to the left, where the place is"


def test_a_rig_that_cannot_see_the_ground_is_told_so():
    """Nothing is said to be seen that the rig's kinds of sensors cannot be held to."""
    start = study()
    radar = replace(start.rig["rear"], model=catalog.load("Continental ARS408-21"))
    blind = replace(start, rig=pe.Rig([radar]), requirements=(), search=pe.Search())
    with pytest.raises(pe.InputError, match="can be held to"):
        repairs(with_blind_spot(blind, (0.0, 1.6)), (BLIND_SPOT,))


def test_shortfalls_are_zero_exactly_where_a_verdict_says_met():
    """And a placement that meets all has its entropy as its value, whichever others there are."""
    own = study()
    strict = (
        Requirement(
            "two", AHEAD, (BODIES["child"],), Criterion(kinds=2), robust_to=RobustTo(one_lost=True)
        ),
        Requirement(
            "ground",
            AHEAD,
            bodies=(),
            criterion=Criterion(blind_m2=0.3, blind_height=0.5),
            robust_to=RobustTo(True),
        ),
        Requirement("most", BEHIND, (BODIES["cyclist"],), Criterion(zone_share=0.4)),
    )
    checker = RequirementChecker((*own.requirements, *strict), own.vehicle, space=own.space)
    rng = np.random.default_rng(3)
    found = []
    for _ in range(4):
        poses = [
            pe.Pose(s.pose.position, (0.0, float(rng.uniform(-0.6, 0.9)), s.pose.rpy[2]))
            for s in own.rig
        ]
        moved = own.rig.with_poses(poses)
        offs = checker.shortfalls(moved)
        assert [off == 0.0 for off in offs] == [v.met for v in checker.check(moved)]
        assert all(0.0 <= off <= 1.0 for off in offs)
        found += [off == 0.0 for off in offs]
    assert True in found and False in found
    again = pickle.loads(pickle.dumps(checker))
    assert again.shortfalls(moved) == offs
    evaluator = own.evaluator()
    objective = pe.Objective(evaluator.entropy, constraints_of(own))
    free = replace(own, limits=pe.Limits())
    assert constraints_of(free) == () and not objective.value(own.rig).is_feasible


def tilted(keep=(), method="portfolio", **limits):
    """A LiDAR at the front, tilted down: level it sees farther, and less of the near ground."""
    van = pe.Vehicle(shapes.box((-2.5, -1.0, 0.25), (2.5, 1.0, 2.0)), clearance=0.0)
    pose = pe.Pose.from_degrees((2.6, 0.0, 1.0), (0.0, 15.0, 0.0))
    limits = pe.Limits(**dict.fromkeys(keep, True) | limits)
    goals = Goals()
    search = pe.Search(
        free={"nose": ("pitch",)}, samples=1024, evaluations=24, method=method, goals=goals
    )
    space = pe.PerceptionSpace((-20, 20), (-16, 16), (0, 3), 0.2)
    rig = pe.Rig([pe.Sensor("nose", shapes.small_lidar(16, 180), pose)])
    return pe.Study(rig, van, space, samples=1024, search=search, limits=limits)


@pytest.mark.usefixtures("few_errors")
@pytest.mark.parametrize("method", ["portfolio", "random"])
def test_a_search_that_keeps_blind_ground_ends_with_no_more_of_it(method):
    """Without the key the same search pays its gain with blind ground, and says so."""
    free, kept = (finished(pt.OptimizeJob(tilted(keep, method), 1)) for keep in ((), BLIND))
    before, after = (figures.values["blind_ground"] for figures in free.figures)
    assert after > before + 1.0
    assert "blind ground (" in free.cost and advice.costs_nothing(kept.cost) == (
        "nothing" in kept.cost.lower()
    )
    start, result = (figures.values["blind_ground"] for figures in kept.figures)
    assert start == before >= result
    assert "blind ground (" not in kept.cost and free.before == kept.before
    assert free.after.entropy < kept.after.entropy <= kept.before.entropy
    sight = kept.study.sight()
    assert sight.blind(kept.study.rig, BLIND_TO_M).area == pytest.approx(result)
    told = result_dict(kept)
    assert [told["figures"][which]["values"]["blind_ground"] for which in ("before", "after")] == [
        start,
        result,
    ]
    assert told["cost"] == kept.cost


@pytest.mark.usefixtures("few_errors")
def test_workers_and_cutoffs_keep_the_same_blind_ground():
    given = tilted(BLIND)
    assert constraints_of(tilted()) == ()
    (limit,) = constraints_of(given)
    objective = pe.Objective(given.evaluator().entropy, (limit,))
    level = given.rig.with_poses([pe.Pose((2.6, 0.0, 1.0), (0.0, 0.0, 0.0))])
    assert limit.violation(given.rig) == 0.0 < limit.violation(level) <= 1.0
    again = pickle.loads(pickle.dumps(limit))
    assert again.violation(level) == limit.violation(level)
    assert objective.value(level) == (limit.violation(level), math.inf)
    entropy = given.evaluator().entropy(given.rig)
    cutoffs = [pe.Value(0.0, entropy + by) for by in (-0.5, 0.0, 0.5)]
    for cutoff in (*cutoffs, pe.Value(2.0, math.inf)):
        for rig in (given.rig, level):
            value = objective.value(rig)
            assert objective.below(rig, cutoff) == (value if value < cutoff else NO_VALUE)
    one, two = (finished(pt.OptimizeJob(given, workers)) for workers in (1, 2))
    assert one.evaluated == two.evaluated and one.after == two.after
