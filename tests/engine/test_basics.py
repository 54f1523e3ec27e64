"""Poses, spaces, sensors, rigs and the catalogue."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.geometry.poses import rpy_from_matrix
from tests.engine import shapes


def test_positive_pitch_is_nose_down_and_positive_yaw_turns_left():
    forward = pe.Pose.from_degrees((0, 0, 0), (0, 10, 0)).ground_from_sensor[:, 0]
    assert forward[2] == pytest.approx(-math.sin(math.radians(10)))
    left = pe.Pose.from_degrees((0, 0, 0), (0, 0, 90)).ground_from_sensor[:, 0]
    assert left == pytest.approx([0, 1, 0], abs=1e-15)


def test_angles_come_back_from_the_matrix():
    rng = np.random.default_rng(0)
    for _ in range(100):
        rpy = tuple(rng.uniform(-1, 1, 3) * (math.pi, math.pi / 2, math.pi))
        pose = pe.Pose((0, 0, 0), rpy)
        assert rpy_from_matrix(pose.ground_from_sensor) == pytest.approx(rpy, abs=1e-9)


def test_every_entry_of_the_catalogue_loads_and_says_its_source():
    for name in pe.catalog.names():
        model = pe.catalog.load(name)
        assert pe.catalog.load(name) is model and pe.catalog.entries()[name].source, name
        if isinstance(model, pe.Lidar):
            assert model.directions.shape == (model.beam_count, 3), name
            assert np.abs(np.linalg.norm(model.directions, axis=1) - 1.0).max() <= 1e-6, name


def test_a_rig_needs_sensors_with_names_of_their_own():
    with pytest.raises(pe.InputError, match="at least one sensor"):
        pe.Rig([])
    with pytest.raises(pe.InputError, match="'roof'"):
        pe.Rig([shapes.lidar_on_roof(), shapes.lidar_on_roof()])


def test_a_fusion_group_holds_one_kind_of_sensor():
    camera = pe.Sensor("c", shapes.camera().model, pe.Pose((0, 0, 1)), fusion="lidar")
    with pytest.raises(pe.InputError, match="fusion group 'lidar'"):
        pe.Rig([shapes.lidar_on_roof(), camera])


def test_a_sensor_in_another_country_is_refused_and_a_far_one_sees_nothing():
    with pytest.raises(pe.InputError, match=r"pose: position: .* within \+-10000 m"):
        pe.Pose((1e30, 0.0, 1.0))
    rig = pe.Rig([pe.Sensor("far", pe.catalog.load("Pandar64"), pe.Pose((1e4, 0.0, 1.0)))])
    for samples in (0, 2048):
        evaluator = pe.Evaluator(shapes.small_space(), pe.Prior.road(), samples=samples)
        assert evaluator.score(rig).coverage == 0.0
