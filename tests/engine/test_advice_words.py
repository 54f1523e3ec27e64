"""A score in words, figures as people read them, and scores side by side."""

import pytest

import pe_core as pe
from pe_core.base.errors import plural
from pe_tools import advice
from pe_tools.wording import metres, percent, times
from tests.engine import shapes


@pytest.mark.parametrize(
    ("share", "text"),
    [
        *((0.0, "0%"), (1.0, "100%"), (0.854, "85%"), (0.0042, "0.4%"), (0.099, "9.9%")),
        *((0.0995, "10%"), (0.997, "99.7%"), (0.9999, "over 99.9%"), (0.0001, "under 0.1%")),
    ],
)
def test_percent(share, text):
    assert percent(share) == text


def test_metres_and_counts():
    assert [metres(v) for v in (0.05, 0.994, 1.45, 9.99, 84.2)] == [
        *("5 cm", "99 cm", "1.45 m", "9.99 m", "84 m")
    ]
    assert [plural(v, "pixel") for v in (1, 7, 1310.4, 4.34)] == [
        *("1 pixel", "7 pixels", "1,310 pixels", "4.3 pixels")
    ]
    assert [times(v) for v in (12.3, 1.0, 0.312)] == ["12 times", "1 times", "0.31 times"]


def part(entropy, coverage, share=0.5):
    return pe.PartScore(entropy, coverage, share)


def score(entropy=3.0, coverage=0.854, zones=None, classes=None, sensors=None):
    return pe.Score(entropy, coverage, 0.0, classes or {}, zones or {}, sensors or {}, 1000)


SENSORS = {
    "roof": pe.SensorScore(4.0, 0.8, 0.42, 1000, 75, {"hood": 15, "roof": 60}),
    "spare": pe.SensorScore(9.0, 0.1, 0.0, 0, 0, {}),
}


def test_a_score_in_words():
    zones = {"front": part(1.234, 0.98), "rear": part(5.0, 0.62), "far": part(9.5, 0.4)}
    assert advice.words(score(zones=zones, sensors=SENSORS)) == (
        "85% of where objects are is seen",
        "best ahead (1.23 nats, 98% seen), worst beyond 40 m (9.50 nats, 40% seen)",
        "roof: without it 0.42 nats worse",
        "  7.5% of its beams occluded: roof 6.0%, hood 1.5%",
        "spare: without it no worse",
    )


def test_a_sensor_in_phrases():
    zones = {"front": 0.61, "rear": 0.02, "far": 0.3}
    assert advice.sensor_words(SENSORS["roof"], zones=zones) == (
        "without it 0.42 nats worse",
        "sees most ahead (61%), least behind (2.0%)",
        "7.5% of its beams occluded: roof 6.0%, hood 1.5%",
    )
    blind = dict.fromkeys(zones, 0.0)
    assert advice.sensor_words(SENSORS["spare"], zones=blind, alone=True) == ("the only sensor",)


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


@pytest.mark.parametrize(
    ("by_part", "text"),
    [
        ({"roof": 250}, "25% of its beams occluded by roof"),
        ({"roof": 245, "mirror": 5}, "25% of its beams occluded by roof"),  # 2 % of them: not named
        (
            {"a": 50, "b": 50, "c": 40, "d": 30},
            "17% of its beams occluded: a 5.0%, b 5.0%, c 4.0%, ...",
        ),
        ({}, ""),
    ],
)
def test_what_stops_a_sensor(by_part, text):
    own = pe.SensorScore(4.0, 0.8, 0.1, 1000, sum(by_part.values()), by_part)
    assert advice.occluded_words(None, own) == text


def test_pixels_are_looked_for_where_no_score_counts_them():
    """A level camera over the bonnet loses what is below its edge, which is 1.45 m ahead."""
    sensor = shapes.camera(40.0, (0.85, 0.0, 0.95))
    uncounted = pe.SensorScore(4.0, 0.8, 0.1, 0, 0, {})
    shares = advice.occluded_shares(sensor, uncounted, shapes.box_car())
    edge = sensor.model.focal_px * 0.05 / 1.45  # pixels below the middle where the bonnet ends
    assert shares == {"body": pytest.approx((540 - edge) / 1080, abs=0.02)}
    words = advice.occluded_words(sensor, uncounted, shapes.box_car())
    assert words == f"{100 * shares['body']:.0f}% of its pixels occluded by body"
    assert advice.occluded_words(sensor, uncounted) == ""


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
    job = pe.ScoreJob(study)
    assert list(job)[-1].stage == "done"
    told = job.outcome.warnings
    assert [(each.subject, each.code) for each in told] == [("roof", "inside")]
    assert pe.result_dict(job.outcome)["warnings"] == [
        {
            "subject": "roof",
            "code": "inside",
            "values": {},
            "part": None,
            "fix": None,
            "amount": [],
        }
    ]
    last = summary(job.outcome).splitlines()[-1]
    assert last == "warning: roof: it is inside the body and sees next to nothing"


def test_a_search_warns_of_the_placement_it_found():
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(), (1.5, 0.0, 0.5))])
    bounds = {"roof": {"z": (0.5, 1.6)}}
    search = pe.Search({"roof": ("z",)}, bounds, 0, 1024, pe.Schedule(8), method="random")
    study = pe.Study(rig, shapes.box_car(), shapes.small_space(), search=search, samples=1024)
    job = pe.OptimizeJob(study, 1)
    assert list(job) and job.outcome.study.rig["roof"].pose.position[2] > 0.95
    told = [each.code for each in job.outcome.warnings]
    assert told == [advice.FRAGILE], "it is in the body no more; a few beams are easily off"
