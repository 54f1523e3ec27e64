"""The bound on what a camera can do is a bound: no voxel measured has a lower entropy."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import RTM3D, entropy_of, precision_of
from pe_report.bound import farthest_at, largest_area, least_entropy, least_unseen
from pe_report.paper import ROW

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
        assert (area <= largest_area(camera, distance, SIDE) * (1 + 1e-9)).all()
        entropy = entropy_of(precision_of(area, RTM3D))
        assert (entropy >= least_entropy(camera, distance, SIDE, RTM3D) - 1e-9).all()
    assert seen > 500


def test_the_bound_is_not_idle():
    """Straight ahead a cube seen along its diagonal comes within a few percent of it."""
    camera = pe.catalog.load("Camera 30 deg")
    diagonal = np.ones(3) / math.sqrt(3.0)
    pitch, yaw = -math.asin(diagonal[2]), math.atan2(diagonal[1], diagonal[0])
    sensor = pe.Sensor("camera", camera, pe.Pose((0, 0, 0), (0, pitch, yaw)))
    area = pe.measure(sensor, [20.0 * diagonal], SIDE)[0]
    bound = largest_area(camera, np.array([20.0]), SIDE)[0]
    assert 0.8 * bound < area < bound


def test_the_printed_figure_needs_what_no_prior_has():
    """A voxel at the farthest distance has the printed entropy; the least unseen share is exact."""
    printed, camera = ROW["2_60deg"].entropy, pe.catalog.load("Camera 60 deg")
    distance = farthest_at(camera, printed, SIDE, RTM3D)
    assert least_entropy(camera, np.array([distance]), SIDE, RTM3D)[0] == pytest.approx(printed)
    assert 2.0 < distance < 6.0
    share = least_unseen(printed, camera, RTM3D)
    best = entropy_of(precision_of(1920.0 * 1080.0, RTM3D))
    assert share * 16.6512 + (1 - share) * best == pytest.approx(printed, abs=1e-3)
