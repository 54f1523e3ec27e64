"""Closed-form models: the bound of a camera is one, and expected beam counts are mean counts."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import RTM3D, entropy_of, precision_of
from studies.paper.analytic import (
    expected_beams,
    max_distance_for,
    max_pixel_area,
    max_unseen_share,
    min_entropy,
)
from studies.paper.paper import ROW
from tests.thorough import pairs

SIDE = 0.1


@pytest.mark.parametrize("hfov", [30, 60, 120])
def test_no_voxel_is_larger_than_the_bound(hfov):
    rng = np.random.default_rng(hfov)
    camera = pe.catalog.load(f"Camera {hfov} deg")
    seen = 0
    for _ in range(20):
        rpy = rng.uniform(-math.pi, math.pi, 3)
        sensor = pe.Sensor("camera", camera, pe.Pose(rng.uniform(-3, 3, 3), tuple(rpy)))
        ahead = sensor.pose.ground_from_sensor[:, 0]
        around = rng.normal(0.0, 0.5, (400, 3)) + ahead
        centers = np.asarray(sensor.pose.position) + rng.uniform(0.3, 60.0, (400, 1)) * around
        area = pe.measure(sensor, centers, SIDE)
        distance = np.linalg.norm(centers - np.asarray(sensor.pose.position), axis=1)
        seen += int((area > 0).sum())
        assert (area <= max_pixel_area(camera, distance, SIDE) * (1 + 1e-9)).all()
        entropy = entropy_of(precision_of(area, RTM3D))
        assert (entropy >= min_entropy(camera, distance, SIDE, RTM3D) - 1e-9).all()
    assert seen > 500


def test_the_bound_is_nearly_reached():
    """Straight ahead a cube seen along its diagonal comes within a few percent of it."""
    camera = pe.catalog.load("Camera 30 deg")
    diagonal = np.ones(3) / math.sqrt(3.0)
    pitch = -math.asin(diagonal[2])
    yaw = math.atan2(diagonal[1], diagonal[0])
    sensor = pe.Sensor("camera", camera, pe.Pose((0, 0, 0), (0, pitch, yaw)))
    area = pe.measure(sensor, [20.0 * diagonal], SIDE)[0]
    bound = max_pixel_area(camera, np.array([20.0]), SIDE)[0]
    assert 0.8 * bound < area < bound


def test_the_printed_figure_needs_near_voxels_and_a_wide_view():
    """A voxel at the farthest distance has the printed entropy; the least unseen share is exact."""
    printed = ROW["2_60deg"].entropy
    camera = pe.catalog.load("Camera 60 deg")
    distance = max_distance_for(camera, printed, SIDE, RTM3D)
    assert min_entropy(camera, np.array([distance]), SIDE, RTM3D)[0] == pytest.approx(printed)
    assert 2.0 < distance < 6.0
    share = max_unseen_share(printed, camera, RTM3D)
    best = entropy_of(precision_of(1920.0 * 1080.0, RTM3D))
    assert share * 16.6512 + (1 - share) * best == pytest.approx(printed, abs=1e-3)


@pytest.mark.parametrize(("name", "distance"), pairs(("Pandar64", "HDL-64E"), (8.0, 25.0)))
def test_expected_counts_are_the_mean_of_whole_ones(name, distance):
    """Voxels all over a piece of the scene, where channels are evenly spread."""
    rng = np.random.default_rng(1)
    sensor = pe.Sensor("lidar", pe.catalog.load(name), pe.Pose((0.0, 0.0, 0.0)))
    azimuth = rng.uniform(-math.pi, math.pi, 4000)
    slope = np.tan(np.radians(rng.uniform(-5.0, 1.0, 4000)))
    centers = distance * np.stack([np.cos(azimuth), np.sin(azimuth), slope], axis=1)
    whole = pe.measure(sensor, centers, SIDE)
    assert expected_beams(sensor.model, centers, SIDE).mean() == pytest.approx(
        whole.mean(), rel=0.04
    )


def test_nothing_is_expected_beyond_the_range_or_far_from_every_channel():
    lidar = pe.catalog.load("Pandar64")
    far = np.array([[lidar.max_range + 1.0, 0.0, 0.0], [1.0, 0.0, 5.0]])
    assert (expected_beams(lidar, far, SIDE) == 0.0).all()
