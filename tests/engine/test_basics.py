"""Poses, spaces, sensors, rigs and the catalogue."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.base import RecentCache
from pe_core.geometry.poses import rpy_from_matrix
from tests.engine import shapes

MATRIX = np.eye(4)


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


def test_a_pose_is_the_same_from_a_matrix_and_from_a_quaternion():
    """A quarter turn to the left, by hand: x becomes y, and (w, x, y, z) is (1, 0, 0, 1) / sqrt 2;
    turns about y and x likewise, and any rotation there and back."""
    half = math.sqrt(0.5)
    turns = (
        ((0, 0, 90), (half, 0, 0, half)),
        ((0, 90, 0), (half, 0, half, 0)),
        ((90, 0, 0), (half, half, 0, 0)),
    )
    for degrees, wxyz in turns:
        wanted = pe.Pose.from_degrees((1, 2, 3), degrees)
        found = pe.Pose.from_quaternion((1, 2, 3), wxyz)
        assert np.allclose(found.matrix, wanted.matrix, atol=1e-12)
    by_hand = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    left = pe.Pose.from_matrix(by_hand)
    assert left.position == (1, 2, 3) and left.rotation_deg == pytest.approx((0, 0, 90))
    rng = np.random.default_rng(1)
    for _ in range(50):
        pose = pe.Pose(rng.uniform(-9, 9, 3), rng.uniform(-1, 1, 3) * (math.pi, 1.5, math.pi))
        single = np.float32(pose.matrix)
        for given in (pose.matrix, pose.matrix[:3], pose.matrix.tolist(), single):
            back = pe.Pose.from_matrix(given)
            assert np.allclose(back.matrix, pose.matrix, atol=1e-5 if given is single else 1e-12)


MATRIX[:3, 3] = (1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    "wrong",
    [
        MATRIX.T,  # of row vectors
        MATRIX * (1, 1, -1, 1),  # mirrors
        MATRIX * (2, 2, 2, 1),  # scales
        np.add(MATRIX, [[0, 0.1, 0, 0], *np.zeros((3, 4))]),  # shears
        MATRIX[:3, :3],
        np.full((4, 4), np.nan),
        np.diag([1, 1, 1, np.inf]),
        "matrix",
        [[1, 0], [0]],
        None,
    ],
)
def test_a_matrix_that_is_no_pose_is_refused(wrong):
    with pytest.raises(pe.InputError, match="pose: matrix"):
        pe.Pose.from_matrix(wrong)


@pytest.mark.parametrize(
    "wrong", [(0, 0, 0, 0), (1, 0, 0), "wxyz", (np.nan, 0, 0, 1), (5, 0, 0, 0)]
)
def test_a_quaternion_that_is_no_rotation_is_refused(wrong):
    with pytest.raises(pe.InputError, match="pose: wxyz"):
        pe.Pose.from_quaternion((0, 0, 0), wrong)


def test_every_entry_of_the_catalogue_loads_and_says_its_source():
    for name in pe.catalog.names():
        model = pe.catalog.load(name)
        assert pe.catalog.load(name) is model and pe.catalog.entries()[name].source, name
        if isinstance(model, pe.Lidar):
            assert model.directions.shape == (model.beam_count, 3), name
            assert np.abs(np.linalg.norm(model.directions, axis=1) - 1.0).max() <= 1e-6, name


def test_an_entry_alone_is_that_of_all_entries():
    assert all(pe.catalog.entry_of(name) == each for name, each in pe.catalog.entries().items())
    assert pe.catalog.entry_of("Pandar") is None


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


def test_a_cache_keeps_as_many_values_as_it_may_and_drops_the_one_used_longest_ago():
    cache = RecentCache(5)
    for key in range(5):
        assert cache.made(key, lambda key=key: 10 * key) == 10 * key
    assert [cache.get(key) for key in (1, 2, 3, 4, 0)] == [10, 20, 30, 40, 0]
    cache.made(5, lambda: 50)
    assert [cache.get(key) for key in (1, 2, 3, 4, 0, 5)] == [None, 20, 30, 40, 0, 50]
