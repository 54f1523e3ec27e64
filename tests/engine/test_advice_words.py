"""Scores in words: figures as people read them, tables, and sensors that see nothing."""

import dataclasses
import json

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.scoring import FoundClass
from pe_core.scoring.score import TrafficAp
from pe_core.scoring.targets.object_metric import SECTORS
from pe_tools import advice
from tests.engine import shapes


def part(entropy, coverage, share=0.5):
    return pe.PartScore(entropy, coverage, share)


def score(entropy=3.0, coverage=0.854, zones=None, classes=None, sensors=None):
    return pe.Score(entropy, coverage, 0.0, classes or {}, zones or {}, sensors or {}, 1000)


SENSORS = {
    "roof": pe.SensorScore(4.0, 0.8, 0.42, 1000, 75, {"hood": 15, "roof": 60}),
    "spare": pe.SensorScore(9.0, 0.1, 0.0, 0, 0, {}),
}


def test_the_table_has_a_row_a_sensor():
    rows = advice.sensor_rows(score(sensors=SENSORS))
    assert advice.sensor_table(rows) == [
        "sensor  loss [nats]  costs most  occluded by",
        "roof           0.42  -           roof 6.0%, hood 1.5%",
        "spare          none  -           -",
    ]
    alone = advice.sensor_rows(score(sensors={"roof": SENSORS["roof"]}))
    assert alone[0].loss is None
    losses = (None, 0.0, 0.00004, 0.0012, 0.006, 3.396, -0.2)
    texts = ["only", "none", "none", "0.00", "0.01", "3.40", "-0.20"]
    assert [advice.loss_text(loss) for loss in losses] == texts


def test_a_loss_is_reported_where_it_costs_most():
    """Two LiDARs see all round, a camera looks ahead: without it, ahead is what gets worse."""
    roof = shapes.lidar_on_roof(shapes.small_lidar(32, 360))
    camera = shapes.camera(60.0, (1.9, 0.0, 0.9))
    rig, space = pe.Rig([roof, camera]), shapes.small_space()
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
    uncounted = pe.SensorScore(4.0, 0.8, 0.1, 0, 0, {})
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
        *(("rig", "", "entropy"), ("rig", "", "coverage")),
        *(("zone", "front", "entropy"), ("zone", "front", "coverage")),
        *(("zone", "far", "entropy"), ("zone", "far", "coverage")),
        *(("class", "car", "entropy"), ("class", "car", "coverage")),
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
    study = pe.Study(rig, shapes.box_car(), shapes.small_space(), samples=1024)
    job = pt.ScoreJob(study)
    assert list(job)[-1].stage == "done"
    told = job.outcome.warnings
    assert [(each.subject, each.code) for each in told] == [("roof", "inside")]
    assert pt.result_dict(job.outcome)["warnings"] == [
        {"subject": "roof", "code": "inside", "values": {}, "part": None, "fix": None, "amount": []}
    ]
    last = summary(job.outcome).splitlines()[-1]
    assert last == "warning: roof: it is inside the body and sees next to nothing"


def test_a_search_warns_of_the_placement_it_found():
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(), (1.5, 0.0, 0.5))])
    bounds = {"roof": {"z": (0.5, 1.6)}}
    search = pe.Search({"roof": ("z",)}, bounds, 0, 1024, pe.Schedule(8), method="random")
    study = pe.Study(rig, shapes.box_car(), shapes.small_space(), search=search, samples=1024)
    job = pt.OptimizeJob(study, 1)
    assert list(job) and job.outcome.study.rig["roof"].pose.position[2] > 0.95
    told = [each.code for each in job.outcome.warnings]
    assert told == [advice.FRAGILE], "it is in the body no more; a few beams are easily off"


REACH = {way: 0.0 for way in SECTORS} | {"front": 25.6, "left": 12.2}
CAR = FoundClass(40, 0.5, 1.0, 0.1, 0.453, 0.01, {1: 1.0, 5: 0.9, 20: 0.5}, REACH)


INSIDE, SIDE = "camera in the boot", "side"


def sensor_score(coverage, stopped=0, beams=1000):
    return pe.SensorScore(4.0, coverage, 0.1, beams, stopped, {"body": stopped} if stopped else {})


RIG = pe.Rig([shapes.lidar_on_roof(), dataclasses.replace(shapes.camera(60.0), name=INSIDE)])


@pytest.mark.parametrize(
    "stopped, coverage, warned, stderr, lines",
    [
        (0, 0.5, (), 0.0, ()),
        (500, 0.5, (), 0.0, ()),  # half is the limit
        (
            *(860, 0.02, (), 0.0),
            ("camera in the boot (86% of its picture occluded) is mostly occluded",),
        ),
        (
            *(1000, 0.0, ("inside",), 0.0),
            ("camera in the boot (inside the body, 100% of its picture occluded) sees nothing",),
        ),
        (
            *(1000, 0.0, (), 0.02),
            ("camera in the boot (100% of its picture occluded) sees nothing, or next to it",),
        ),
        (
            *(0, 0.0, (), 0.0),
            ("camera in the boot (no object is expected where it looks) sees nothing",),
        ),
    ],
    ids=["well", "half", "mostly", "inside", "sampled", "away"],
)
def test_what_is_reported_of_it(stopped, coverage, warned, stderr, lines):
    own = {"roof": sensor_score(0.6), INSIDE: sensor_score(coverage, stopped)}
    score = pe.Score(2.0, 0.6, stderr, {}, {}, own, 9)
    warnings = [pt.Advice(INSIDE, code) for code in warned]
    assert advice.hidden_words(advice.hidden_sensors(RIG, score, warnings)) == lines
    assert advice.rig_words(score, None, RIG, warnings)[: len(lines)] == lines
    assert not advice.rig_words(score)[0].startswith("camera")


@pytest.mark.parametrize("samples", [0, 2048])
def test_a_wall_hides_the_left_half_of_the_picture(samples):
    """A wall from straight ahead to the left, one metre off, higher than the picture."""
    wall = pe.Vehicle(
        shapes.box((1.0, 0.0, 0.0), (1.1, 3.0, 4.0)), np.zeros(12, np.int32), ("wall",)
    )
    sensor = shapes.camera(60.0, (0.0, 0.0, 2.0))
    space = pe.PerceptionSpace((-2, 8), (-4, 4), (0, 4), 0.5)
    score = pe.Evaluator(space, pe.Prior.uniform(), wall, samples=samples).score(pe.Rig([sensor]))
    own = score.per_sensor["camera"]
    assert own.occluded / own.beams == pytest.approx(0.5, abs=0.01)
    assert own.occluded_by == {"wall": own.occluded}
    assert 16_000 < own.beams <= 16_384


@pytest.fixture(scope="module")
def study():
    """A small LiDAR on a box of a car."""
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(32, 360))])
    return pe.Study(rig, shapes.box_car(), space=shapes.small_space())


def test_they_are_those_of_sight(study):
    look = study.sight()
    found = advice.KeyFigures.of_rig(look, study.rig)
    reach, blind = look.reach(study.rig, "car"), look.blind(study.rig, 0.5)
    assert 0.0 < found.blind_m2 == pytest.approx(blind.area, abs=1e-9) and (
        found.height,
        found.within,
    ) == (0.5, 10.0)
    assert found.reach["car"] == (reach.distance[0], reach.distance[0] >= reach.limit[0] - 0.5)
    assert found.reach.keys() == set(study.prior.class_names)
    assert found.traffic == look.in_traffic(study.rig) is not None
    assert found.sectors == look.blind_sectors(study.rig)
    assert advice.KeyFigures.from_dict(json.loads(json.dumps(found.to_dict()))) == found


def in_traffic(near):
    """Key figures of a rig with this AP near the vehicle."""
    rings = {"near": near, "far": (0.33, 0.002)}
    return advice.KeyFigures(TrafficAp(0.4, 0.01, 8, rings), (), 1.0, 0.5, 10.0)


def test_a_move_is_told_with_its_gain_and_its_error(study):
    """The largest step and turn of each sensor that moved; AP by distance of start and result."""
    x, y, z = study.rig["roof"].pose.position
    up = study.rig.with_poses([pe.Pose.from_degrees((x - 0.03, y, z + 0.08), (0.0, 0.0, 12.0))])
    told = in_traffic((0.41, 0.01)), in_traffic((0.474, 0.0101))
    assert advice.gain_sentence(study.rig, up, *told) == (
        "roof 8 cm up and turned 12 deg: expected AP in traffic near 0.41 to 0.47, "
        "far 0.33 to 0.33 (+- 0.02)"
    )
    assert advice.gain_sentence(study.rig, study.rig, *told) == ""
