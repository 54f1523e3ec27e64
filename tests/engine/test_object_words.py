"""Scores on objects in words, and side by side."""

from dataclasses import replace

import pytest

import pe_core as pe
from pe_core.scoring import FoundClass
from pe_core.scoring.targets.lone_objects import SECTORS
from pe_tools import advice
from pe_tools.cli.explain_verbs import comparison
from pe_tools.cli.terminal import summary
from tests.engine import shapes

REACH = {way: 0.0 for way in SECTORS} | {"front": 25.6, "left": 12.2}
CAR = FoundClass(40, 0.5, 1.0, 0.1, 0.453, 0.01, {1: 1.0, 5: 0.9, 20: 0.5}, REACH)
CONE = replace(CAR, ap=0.2, points={}, reach=dict.fromkeys(SECTORS, 0.0))


def scored(ap=0.33, traffic=True, **classes):
    found = pe.ObjectScore(ap, 0.004, 80, 8, traffic, {"car": CAR, "cone": CONE} | classes)
    return pe.Score(3.0, 0.5, 0.1, {}, {}, {}, 0, objects=found)


def test_words_of_a_score_on_objects():
    assert advice.words(scored()) == (
        "50% of the objects are seen, by weight (80 objects in 8 scenes, in traffic)",
        "expected AP 0.33 +- 0.004: car 0.45, cone 0.20",
        "car: 100%, 90%, 50% get 1, 5, 20 points or more; "
        "found alone (AP 0.5) up to 26 m ahead, 12 m left; not behind, right",
        "cone: found alone (AP 0.5) nowhere ahead, behind, left or right",
    )
    far = replace(CAR, reach=REACH | {"front": 80.0})
    assert "up to 80 m and more ahead, 12 m left" in advice.words(scored(car=far))[2]
    assert [advice.lone_reach(m) for m in (0.2, 25.6, 80.0)] == ["nowhere", "26 m", "≥ 80 m"]
    assert "80 objects, none occludes another" in advice.words(scored(traffic=False))[0]


def test_a_score_comes_back_from_its_data():
    score = scored()
    assert pe.ObjectScore.from_dict(score.to_dict()["objects"]) == score.objects


def test_ap_and_reach_stand_side_by_side():
    better = replace(CAR, ap=0.5, reach=REACH | {"front": 30.0})
    rows = advice.compare({"a": scored(), "b": scored(0.35, car=better)})
    found = {(row.measure, row.name): row for row in rows}
    assert found["ap", ""].values == (0.33, 0.35) and found["ap", ""].best == (False, True)
    assert found["reach", "car"].differences == (0.0, pytest.approx(4.4))
    lines = comparison(["a", "b"], rows)
    assert "expected AP" in lines and any("30.0 (+4.4)*" in line for line in lines)
    voxels = pe.Score(3.0, 0.5, 0.1, {}, {}, {}, 9)
    assert "expected AP" not in comparison(["a"], advice.compare({"a": voxels}))


def test_the_summary_says_what_was_evaluated():
    study = pe.Study(pe.Rig([shapes.lidar_on_roof()]), targets=pe.TargetRule("objects", scenes=64))
    own = pe.SensorScore(3.0, 0.5, 1.0, 0, 0, {})
    score = replace(scored(), per_sensor={"roof": own})
    text = summary(pe.Outcome("optimize", study, study, score, score, evaluations=7))
    assert "expected AP 0.33" in text and "on 80 objects in 8 scenes, in traffic" in text
    assert "7 placements evaluated on 32, then 64 scenes of objects" in text
