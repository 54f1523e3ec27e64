"""Scores and what a rig sees in words: figures as people read them, tables, moves."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring.score import TrafficAp
from pe_core.scoring.sight import Reach
from pe_tools import advice
from pe_tools.advice.ranking import moved_words
from pe_tools.advice.summary import outlook_words
from tests.engine import shapes

INSIDE = "camera in the boot"
RIG = pe.Rig([shapes.lidar_on_roof(), dataclasses.replace(shapes.camera(60.0), name=INSIDE)])


def part(entropy, coverage, share=0.5):
    return pe.PartScore(entropy, coverage, share)


def score(entropy=3.0, coverage=0.854, zones=None, classes=None, sensors=None):
    return pe.Score(
        entropy,
        coverage,
        stderr=0.0,
        per_class=classes or {},
        per_zone=zones or {},
        per_sensor=sensors or {},
        voxels=1000,
    )


def test_a_loss_is_reported_where_it_costs_most():
    """Two LiDARs see all round, a camera looks ahead: without it, ahead is what gets worse."""
    roof = shapes.lidar_on_roof(shapes.small_lidar(32, 360))
    camera = shapes.camera(60.0, (1.9, 0.0, 0.9))
    rig = pe.Rig([roof, camera])
    space = shapes.small_space()
    study = pe.Study(rig, shapes.box_car(), space)
    seen = advice.outlook(study.sight(), rig)
    found = study.evaluator(4096).score(rig)
    rows = {row.name: row for row in advice.sensor_rows(found, rig, study.vehicle, seen)}
    losses = seen.shares.losses["camera"]
    assert rows["camera"].zone == max(losses, key=losses.get)
    assert losses["front"] > losses["rear"] == 0.0 and rows["camera"].zone_loss >= losses["front"]
    both = losses["near"], losses["mid"], losses.get("far", 0.0)
    assert min(both) <= rows["camera"].loss <= max(both)  # a mean over the rings, which cover all


def test_pixels_are_looked_for_where_no_score_counts_them():
    """A level camera over the bonnet loses what is below its edge, which is 1.45 m ahead."""
    sensor = shapes.camera(40.0, (0.85, 0.0, 0.95))
    uncounted = pe.SensorScore(
        entropy=4.0, coverage=0.8, lost=0.1, beams=0, occluded=0, occluded_by={}
    )
    shares = advice.occluded_shares(sensor, uncounted, shapes.box_car())
    edge = sensor.model.focal_px * 0.05 / 1.45  # pixels below the middle where the bonnet ends
    assert shares == {"body": pytest.approx((540 - edge) / 1080, abs=0.02)}
    assert advice.occluded_shares(sensor, uncounted, None) == {}


def test_side_by_side():
    """Lower entropy and higher coverage are better; differences are from the first."""
    first = score(3.0, 0.5, {"front": part(2.0, 0.75)}, {"car": part(4.0, 0.25)})
    second = score(
        2.5, 0.5, {"front": part(2.5, 0.5), "far": part(9.0, 0.5)}, {"car": part(4.0, 0.25)}
    )
    rows = {(r.group, r.name, r.measure): r for r in advice.compare({"a": first, "b": second})}
    assert list(rows) == [
        ("rig", "", "entropy"),
        ("rig", "", "coverage"),
        ("zone", "front", "entropy"),
        ("zone", "front", "coverage"),
        ("zone", "far", "entropy"),
        ("zone", "far", "coverage"),
        ("class", "car", "entropy"),
        ("class", "car", "coverage"),
    ]
    entropy = rows["rig", "", "entropy"]
    assert (entropy.values, entropy.differences) == ((3.0, 2.5), (0.0, -0.5))
    assert entropy.best == (False, True)
    assert rows["rig", "", "coverage"].best == (False, False)  # alike
    assert rows["zone", "front", "entropy"].best == (True, False)
    assert rows["zone", "front", "coverage"].best == (True, False)
    far = rows["zone", "far", "entropy"]
    assert (far.values, far.differences, far.best) == ((None, 9.0), (None, None), (False, False))


def test_warnings_are_in_the_result_and_below_the_summary():
    from pe_tools.cli.terminal import summary

    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(), (1.5, 0.0, 0.5))])
    study = shapes.car_study(rig, samples=1024)
    job = pt.ScoreJob(study)
    assert list(job)[-1].stage == "done"
    told = job.outcome.warnings
    assert [(each.subject, each.code) for each in told] == [("roof", "inside")]
    assert pt.result_dict(job.outcome)["warnings"] == [
        {"subject": "roof", "code": "inside", "values": {}, "part": None, "fix": None, "amount": []}
    ]
    last = summary(job.outcome).splitlines()[-1]
    assert last == "warning: roof: it is inside the body and sees next to nothing"


def sensor_score(coverage, stopped=0, beams=1000):
    return pe.SensorScore(
        entropy=4.0,
        coverage=coverage,
        lost=0.1,
        beams=beams,
        occluded=stopped,
        occluded_by={"body": stopped} if stopped else {},
    )


@pytest.mark.parametrize(
    "stopped, coverage, warned, stderr, lines",
    [
        (500, 0.5, (), 0.0, ()),  # half is the limit
        (860, 0.02, (), 0.0, (f"{INSIDE} (86% of its picture occluded) is mostly occluded",)),
        (
            1000,
            0.0,
            ("inside",),
            0.0,
            (f"{INSIDE} (inside the body, 100% of its picture occluded) sees nothing",),
        ),
        (
            1000,
            0.0,
            (),
            0.02,
            (f"{INSIDE} (100% of its picture occluded) sees nothing, or next to it",),
        ),
        (0, 0.0, (), 0.0, (f"{INSIDE} (no object is expected where it looks) sees nothing",)),
    ],
    ids=["half", "mostly", "inside", "sampled", "away"],
)
def test_what_is_reported_of_it(stopped, coverage, warned, stderr, lines):
    own = {"roof": sensor_score(0.6), INSIDE: sensor_score(coverage, stopped)}
    score = pe.Score(
        entropy=2.0,
        coverage=0.6,
        stderr=stderr,
        per_class={},
        per_zone={},
        per_sensor=own,
        voxels=9,
    )
    warnings = [pt.Advice(INSIDE, code) for code in warned]
    assert advice.hidden_words(advice.hidden_sensors(RIG, score, warnings)) == lines
    assert advice.rig_words(score, None, RIG, warnings)[: len(lines)] == lines
    assert not advice.rig_words(score)[0].startswith("camera")


def blind(**zone):
    """Blind ground that begins at the body: how far it reaches by side."""
    return SimpleNamespace(zone=zone, within=10.0, height=0.5)


def test_shares_by_number_and_by_sensor_by_hand():
    """One camera looks ahead, one behind, one as the first: none is seen by all three."""
    space = shapes.small_space()
    prior = pe.Prior.uniform()
    ahead, again, behind = (
        shapes.camera(90.0, (0.0, 0.0, 1.5), (0, 0, yaw), name)
        for yaw, name in ((0, "ahead"), (0, "again"), (180, "behind"))
    )
    shares = (
        pe.Study(pe.Rig([ahead, again, behind]), None, space, prior)
        .sight()
        .shares(pe.Rig([ahead, again, behind]))
    )
    one = shares.zones["ahead"]
    assert one == shares.zones["again"] and one["rear"] == 0.0 < one["front"]
    assert shares.by_number[0] == 1.0 and shares.by_number[3] == 0.0
    assert shares.by_number[2] == pytest.approx(one["front"] / 2, abs=1e-3)
    behind_too = shares.zones["behind"]["rear"] / 2
    assert shares.by_number[1] == pytest.approx(one["front"] / 2 + behind_too, abs=1e-3)
    aside = shapes.camera(90.0, (0.0, 0.0, 1.5), (0, 0, 90), "aside")
    left = pe.Study(pe.Rig([aside]), None, space, prior).sight().shares(pe.Rig([aside])).zones
    assert left["aside"]["left"] > 0.1 and left["aside"]["right"] == 0.0
    score = pe.Evaluator(space, prior).score(pe.Rig([ahead]))
    assert one["front"] == pytest.approx(score.per_zone["front"].coverage, abs=0.01)
    assert math.isclose(one["left"], score.per_zone["left"].coverage, abs_tol=0.01)


def test_a_turn_past_180_degrees_is_told_by_the_shorter_way():
    before, after = (
        pe.Rig([shapes.camera(60.0, (x, 0.0, 1.0), (0.0, 0.0, yaw))])
        for x, yaw in ((0.0, 179.0), (1.2, -179.0))
    )
    assert moved_words(before, after) == "camera 1.20 m ahead and turned 2 deg"


def test_figures_that_prefer_different_rigs_are_told():
    none = ((0.0, 0.0),) * 2

    def told(widths):
        rows = [
            advice.ComparedRow("rig", "", "entropy", (1.0, 2.0), errors=none, factor=2.0),
            advice.ComparedRow(advice.TRAFFIC, "", "ap", (0.6, 0.5), errors=none, factor=2.0),
            advice.ComparedRow("rig", "0.5 m tall, at 20 m", "blind_sector", widths, errors=none),
        ]
        return advice.disagreement(["one", "other"], rows)

    assert told((0.0, 0.0)) == "" and "other by the widest blind sector" in told((20.0, 0.0))


@pytest.fixture(scope="module")
def study():
    """A small LiDAR on a box of a car."""
    rig = shapes.roof_rig(32, 360)
    return shapes.car_study(rig)


def in_traffic(near):
    """Key figures of a rig with this AP near the vehicle."""
    rings = {"near": near, "far": (0.33, 0.002)}
    values = {"ap_near": near[0], "ap_far": 0.33, "traffic_ap": 0.4, "blind_ground": 1.0}
    return advice.KeyFigures(
        TrafficAp(0.4, 0.01, 8, rings), sectors=(), height=0.5, within=10.0, values=values
    )


def test_a_move_is_told_with_its_gain_and_its_error(study):
    """The largest step and turn of each sensor that moved; AP by distance of start and result."""
    x, y, z = study.rig["roof"].pose.position
    up = study.rig.with_poses([pe.Pose.from_degrees((x - 0.03, y, z + 0.08), (0.0, 0.0, 12.0))])
    start = in_traffic((0.41, 0.01))
    result = in_traffic((0.474, 0.0101))
    assert advice.gain_sentence(study.rig, up, start, result) == (
        "roof 8 cm up and turned 12 deg: expected AP in traffic near 0.41 to 0.47, "
        "far 0.33 to 0.33 (+- 0.02)"
    )
    assert advice.gain_sentence(study.rig, study.rig, start, result) == ""


def test_what_is_said():
    distance = np.array([43.9, 99.0, 0.0, 0.0, 80.0, 0.0, 12.0, 0.0])
    reach = Reach(
        "pedestrian",
        ap=0.5,
        bearings=np.radians(np.arange(0, 360, 45)),
        distance=distance,
        per_sensor={},
        limit=np.full(8, 80.0),
    )
    zone = {"front": 4.24, "rear": None, "left": 0.0, "right": 2.0}
    blind = SimpleNamespace(zone=zone, within=10.0, height=0.5)
    shares = SimpleNamespace(by_number=(1.0, 0.8, 0.22), zones={})
    found = outlook_words(advice.Outlook({"car": 0.614, "cone": 0.2}, shares, reach, blind))
    assert list(found) == [
        "expected AP: car 0.61, cone 0.20",
        "a pedestrian is found (AP 0.5 or more) up to 43 m ahead, 80 m and more behind, "
        "12 m right; not left",
        "blind to what is 0.5 m tall, from the body: to 4.3 m ahead, beyond 10 m behind, "
        "none left, to 2.0 m right",
    ]
