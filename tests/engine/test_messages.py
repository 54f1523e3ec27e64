"""What a message quotes, and what a study is when it does not say."""

import math

import pytest

import pe_core as pe
from pe_core.base.values import Whole, listed
from tests.engine import shapes


def test_a_study_s_sensor_stands_upright_unless_it_is_turned():
    sensor = {"name": "roof", "model": "Pandar64", "position": [0, 0, 2]}
    (read,) = pe.study_from_dict({"sensor": [sensor]}).rig
    assert read.pose == pe.Pose((0.0, 0.0, 2.0)) and read.pose.rpy == (0.0, 0.0, 0.0)


def test_angles_of_a_study_s_own_sensor_are_those_it_says():
    model = {"kind": "lidar", "elevations_deg": [-10, 0.1, 5], "azimuth_count": 4, "max_range_m": 9}
    sensor = {"name": "roof", "model": model, "position": [0, 0, 2], "rotation": [0, 1, -90]}
    (read,) = pe.study_from_dict({"sensor": [sensor]}).rig
    assert read.model.elevations.tolist() == [math.radians(a) for a in (-10, 0.1, 5)]
    assert read.pose.rpy == (0.0, math.radians(1), math.radians(-90))
    odd = [0.1, -0.2, 1.0 / 3.0]  # of no round number of degrees
    assert pe.Lidar("x", odd, 4, 9.0).elevations.tolist() == pytest.approx(odd, abs=1e-15)


@pytest.mark.parametrize("key", ["rig", "vehicle", "space", "prior", "model", "search"])
def test_a_study_is_made_of_what_it_is_made_of(key):
    fields = {"rig": pe.Rig([shapes.lidar_on_roof(shapes.small_lidar())])} | {key: "road"}
    with pytest.raises(pe.InputError, match=f"study: {key}: expected a .*, found str"):
        pe.Study(**fields)


def test_whole_numbers_are_counts_unless_they_may_be_less():
    assert Whole().checked("x", "y", 0) == 0
    with pytest.raises(pe.InputError, match="a whole number >= 0, found -1"):
        Whole().checked("x", "y", -1)


def test_a_list_is_taken_one_beyond_what_it_may_hold():
    assert listed(iter(range(9)), 3) == [0, 1, 2, 3]
    assert listed(iter(range(4))) == [0, 1, 2, 3] and listed(range(2), 3) == [0, 1]
    assert listed("abc") is None and listed({"a": 1}) is None and listed(3) is None
