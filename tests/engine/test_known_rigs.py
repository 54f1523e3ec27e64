"""Known and published rigs: their places, their figures, their page, other vehicles."""

import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from pe_core import catalog
from pe_tools.exchange import pose_from_quaternion
from tests.thorough import tries

ROOT = Path(__file__).parents[2]
FEW = 16_384
SIGMAS = 4.0
"""Passes by chance all but once in 16,000 figures."""


@pytest.mark.parametrize("rig", catalog.known_rigs().values(), ids=lambda rig: rig.key)
def test_each_has_models_of_the_catalogue_names_of_its_own_and_a_source(rig):
    assert rig.sensors and rig.source and rig.note and rig.origin
    assert len({sensor.name for sensor in rig.sensors}) == len(rig.sensors)
    for sensor in rig.sensors:
        assert catalog.load(sensor.model)
    if rig.size is not None:
        length, width, _ = rig.size
        for sensor in rig.sensors:
            x, y, z = sensor.pose.position
            assert abs(x) < length / 2 + 0.3 and abs(y) < width / 2 + 0.3 and 0.0 < z < 3.0


def test_the_origin_moves_from_the_rear_axle_under_the_centre():
    """nuScenes' LiDAR is 0.9437 m ahead of the rear axle, the Zoe's centre 1.38 m."""
    lidar = catalog.known_rig("nuscenes").sensors[0]
    assert (lidar.name, lidar.model) == ("LIDAR_TOP", "Velodyne HDL-32E")
    assert lidar.pose.position == (-0.4363, 0.0, 1.8402)


def test_a_rig_is_stretched_to_another_box_by_hand():
    """From 4.084 x 1.73 x 1.562 m to twice that: inside doubled, what stands out stays out."""
    rig = catalog.known_rig("nuscenes")
    low = (-4.084, -1.73, 0.0)
    high = (4.084, 1.73, 3.124)
    lidar, front = rig.on_vehicle(low, high)[:2]
    assert lidar.pose.position == (-0.8726, 0.0, 3.4022)  # 0.2782 m above a roof of 3.124 m
    assert front.pose.position == pytest.approx((2 * 0.3208, 2 * 0.0159, 2 * 1.511), abs=1e-5)
    assert front.pose.rpy == rig.sensors[1].pose.rpy
    same = rig.on_vehicle((-2.042, -0.865, 0.0), (2.042, 0.865, 1.562))
    assert [s.pose for s in same] == [s.pose for s in rig.sensors]


@pytest.fixture(scope="module")
def page():
    """The page's rows by the rigs' keys: (entropy, stderr, coverage) in the open and on it."""
    rows = {}
    for line in (ROOT / "docs" / "known_rigs.md").read_text("utf-8").splitlines():
        found = re.match(r"\| .*\(`(\w+)`\) \|", line)
        if found:
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            figures = [cells[4], cells[5], cells[7], cells[8]]
            rows[found[1]] = [float(w) for cell in figures for w in cell.split(" ± ")]
    return rows


@pytest.fixture(scope="module")
def tool():
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import known_rigs
    finally:
        sys.path.remove(str(ROOT / "tools"))
    return known_rigs


def test_the_page_has_every_rig(page):
    assert set(page) == set(catalog.known_rigs())


@pytest.mark.parametrize("key", ["kitti", "paper_bus_front"][: tries(1, 2)])
def test_its_figures_are_those_of_a_fresh_score(page, tool, key):
    """Other voxels of another number: apart by no more than both standard errors allow."""
    fresh = tool.scored(key, FEW)
    for score, told in ((fresh.open, page[key][:3]), (fresh.on_vehicle, page[key][3:])):
        entropy, stderr, coverage = told
        apart = SIGMAS * (score.stderr**2 + stderr**2) ** 0.5
        assert score.entropy == pytest.approx(entropy, abs=apart)
        assert 100.0 * score.coverage == pytest.approx(coverage, abs=5.0)
        assert apart < 0.1 * entropy, "a band that would tell another rig's figure apart"


def test_a_pose_of_a_quaternion_by_hand():
    """A quarter turn to the left; and a camera that looks along the parent's y, 2 m ahead."""
    half = math.sqrt(0.5)
    pose = pose_from_quaternion((half, 0.0, 0.0, half), (1.0, 2.0, 3.0))
    assert pose.position == (1.0, 2.0, 3.0)
    assert pose.rotation_deg == pytest.approx((0.0, 0.0, 90.0))
    # Optical z along the parent's y, optical x along its x: a turn by -90 deg about x.
    seen = pose_from_quaternion((half, -half, 0.0, 0.0), (0.0, 2.0, 0.0), optical=True)
    assert seen.ground_from_sensor[:, 0] == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    assert seen.ground_from_sensor[:, 2] == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)
    # The same said the other way round: the parent as the camera has it.
    back = pose_from_quaternion(
        (half, half, 0.0, 0.0), (0.0, 0.0, -2.0), optical=True, inverse=True
    )
    assert back.position == pytest.approx(seen.position, abs=1e-12)
    assert np.abs(back.ground_from_sensor - seen.ground_from_sensor).max() < 1e-12
