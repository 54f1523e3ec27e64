"""Figures that a design is defended by: those of `Sight`, put together."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import pe_core as pe
from pe_tools import advice
from tests.engine import shapes


@pytest.fixture(scope="module")
def study():
    """A small LiDAR on a box of a car."""
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(32, 360))])
    return pe.Study(rig, shapes.box_car(), space=shapes.small_space())


def test_they_are_those_of_sight(study):
    look = study.sight()
    found = advice.key_figures(look, study.rig, 0.6, "car")
    reach, blind = look.reach(study.rig, "car"), look.blind(study.rig, 0.6)
    assert 0.0 < found.blind_m2 == blind.area and (found.height, found.within) == (0.6, 10.0)
    assert found.class_name == "car" and found.reach_m == reach.distance[0]
    assert found.at_least == (reach.distance[0] >= reach.limit[0] - 0.5)
    assert found.expected_ap == look.expected_ap(study.rig)["car"]
    assert advice.key_figures(look, study.rig).class_name == "pedestrian"
    assert found.to_dict() == {
        "blind_m2": found.blind_m2,
        "height": 0.6,
        "within": 10.0,
        "class_name": "car",
        "reach_m": found.reach_m,
        "at_least": found.at_least,
        "expected_ap": found.expected_ap,
    }


def test_on_objects_reach_and_ap_are_left_to_the_score(study):
    found = advice.key_figures(study.sight(), study.rig, of_voxels=False)
    assert found.blind_m2 > 0.0
    assert (found.class_name, found.reach_m, found.expected_ap) == (None, None, None)


def test_a_class_that_there_is_not(study):
    with pytest.raises(pe.InputError, match=r"expected one of .*pedestrian"):
        advice.key_figures(study.sight(), study.rig, class_name="boat")


@pytest.mark.parametrize(
    ("distance", "limit", "found"),
    [(43.2, 80.0, (43.2, False)), (79.6, 80.0, (79.6, True)), (0.0, 0.0, (0.0, False))],
)
def test_straight_ahead(study, distance, limit, found):
    reach = SimpleNamespace(
        bearings=np.radians([0.0, 180.0]),
        distance=np.array([distance, 9.0]),
        limit=np.array([limit, math.inf]),
    )
    look = study.sight()
    sight = SimpleNamespace(
        prior=look.prior,
        space=look.space,
        blind=look.blind,
        reach=lambda *_: reach,
        expected_ap=look.expected_ap,
    )
    figures = advice.key_figures(sight, study.rig)
    assert (figures.reach_m, figures.at_least) == found
