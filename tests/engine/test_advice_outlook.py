"""How far and how well a rig sees, in words: figures of `Sight`, said plainly."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
from pe_tools import advice
from pe_tools.advice.summary import outlook_words
from tests.engine import shapes


def reach(by_degrees, name="pedestrian", limit=80.0):
    """A reach along eight bearings: what is not named is 0."""
    degrees = [0, 45, 90, 135, 180, 225, 270, 315]
    return SimpleNamespace(
        class_name=name,
        ap=0.5,
        bearings=np.radians(degrees),
        distance=np.array([float(by_degrees.get(d, 0.0)) for d in degrees]),
        limit=np.full(8, limit),
        per_sensor={},
    )


def blind(**zone):
    """Blind ground that begins at the body: how far it reaches by side."""
    return SimpleNamespace(zone=zone, within=10.0, height=0.5)


ROUND = blind(front=4.24, rear=None, left=0.0, right=2.0)


def said(reach, blind):
    shares = SimpleNamespace(by_number=(1.0, 0.8, 0.22), zones={})
    found = advice.Outlook({"car": 0.614, "cone": 0.2}, shares, reach, blind)
    return list(outlook_words(found))


def test_what_is_said():
    assert said(reach({0: 43.2, 180: 80.0, 270: 12.0, 45: 99.0}), ROUND) == [
        "expected AP: car 0.61, cone 0.20",
        "a pedestrian is found (AP 0.5 or more) up to 43 m ahead, 80 m and more behind, "
        "nowhere left, 12 m right",
        "blind to what is 0.5 m tall, from the body: to 4.3 m ahead, beyond 10 m behind, "
        "none left, to 2.0 m right",
    ]


def test_an_outlook_is_sight_s():
    """Its figures are those of `Sight`, and the class is pedestrians unless it is asked for."""
    study = pe.Study(
        pe.Rig([shapes.lidar_on_roof(shapes.small_lidar()), shapes.camera()]),
        shapes.box_car(),
        shapes.small_space(),
    )
    sight = study.sight()
    found, car = advice.outlook(sight, study.rig), advice.outlook(sight, study.rig, "car")
    assert found.reach.class_name == "pedestrian" and car.reach.class_name == "car"
    assert found.expected_ap == sight.expected_ap(study.rig)
    assert np.array_equal(car.reach.distance, sight.reach(study.rig, "car").distance)
    assert found.blind.area == sight.blind(study.rig, 0.5).area
    data = found.to_dict()
    assert data["reach"]["bearings_deg"][:2] == [0.0, 5.0]
    assert data["seen_by_at_least"] == list(sight.shares(study.rig).by_number)


def test_shares_by_number_and_by_sensor_by_hand():
    """One camera looks ahead, one behind, one as the first: none is seen by all three."""
    space, prior = shapes.small_space(), pe.Prior.uniform()
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
