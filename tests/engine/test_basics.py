"""Poses, spaces, sensors, rigs and the catalogue."""

import math
import re

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


def test_degrees_make_the_round_trip_to_the_bit():
    rng = np.random.default_rng(1)
    for degrees in np.round(rng.uniform(-180, 180, (500, 3)), 4):
        pose = pe.Pose.from_degrees((1, 2, 3), degrees)
        assert pose.rotation_deg == tuple(degrees)
        assert pe.Pose.from_degrees((1, 2, 3), pose.rotation_deg) == pose


@pytest.mark.parametrize("bad", [(0, 0), (0, 0, math.nan), (0, 0, math.inf), "abc", None])
def test_a_bad_position_is_one_clear_line(bad):
    with pytest.raises(pe.InputError, match="pose: position: expected three finite numbers"):
        pe.Pose(bad)


def test_the_paper_s_space_has_64_million_voxels():
    space = pe.PerceptionSpace()
    assert space.shape == (1600, 800, 50)
    assert space.size == 64_000_000
    assert space.center_of(np.array([[0, 0, 0], [1599, 799, 49]])).ravel() == pytest.approx(
        [-79.95, -39.95, 0.05, 79.95, 39.95, 4.95]
    )


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"x": (5, 5)}, "space: x"),
        ({"y": (0, math.nan)}, "space: y"),
        ({"z": (0, math.inf)}, "space: z"),
        ({"interval": 0.0}, "space: interval"),
        ({"interval": 0.3}, "space: interval: expected a length that divides x"),
        ({"interval": 0.001}, "space: interval: expected at most"),
        ({"x": "ab"}, "space: x"),
    ],
)
def test_impossible_spaces_are_refused(options, field):
    with pytest.raises(pe.InputError, match=re.escape(field)):
        pe.PerceptionSpace(**options)


def test_the_paper_s_lidars_are_those_of_table_one():
    pandar64, hdl, pandar40 = (pe.catalog.load(n) for n in ("Pandar64", "HDL-64E", "Pandar40"))
    assert [len(s.elevations) for s in (pandar64, hdl, pandar40)] == [64, 64, 40]
    assert [s.azimuth_count for s in (pandar64, hdl, pandar40)] == [1800, 2156, 1800]
    degrees = np.degrees(pandar64.elevations)
    assert (degrees.min(), degrees.max()) == pytest.approx((-25, 15))
    steps = np.diff(np.sort(degrees))
    assert steps.min() == pytest.approx(1 / 6) and steps.max() == pytest.approx(6)
    assert np.diff(np.degrees(hdl.elevations)) == pytest.approx(0.427)


@pytest.mark.parametrize("name", pe.catalog.names())
def test_every_entry_of_the_catalogue_loads_and_says_its_source(name):
    model = pe.catalog.load(name)
    assert pe.catalog.load(name) is model
    assert pe.catalog.entries()[name].source
    if isinstance(model, pe.Lidar):
        directions = model.directions
        assert directions.shape == (model.beam_count, 3)
        assert np.abs(np.linalg.norm(directions, axis=1) - 1.0).max() <= 1e-6


def test_an_unknown_model_is_answered_with_near_ones():
    with pytest.raises(pe.InputError, match=r"'Pandar64'.*found 'pandar 64'"):
        pe.catalog.load("pandar 64")


def test_beams_of_a_limited_field_of_view_stay_inside_it():
    lidar = shapes.small_lidar(4, 360, horizontal_fov=tuple(np.radians((-60, 45))))
    azimuths = np.degrees(np.arctan2(lidar.directions[:, 1], lidar.directions[:, 0]))
    assert len(azimuths) == 4 * 106
    assert (azimuths.min(), azimuths.max()) == pytest.approx((-60, 45))


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"elevations": []}, "elevations"),
        ({"elevations": [math.nan]}, "elevations"),
        ({"elevations": [2.0]}, "elevations"),
        ({"azimuth_count": 0}, "azimuth_count"),
        ({"max_range": 0.0}, "max_range"),
        ({"max_range": math.inf}, "max_range"),
        ({"azimuth_offsets": [0.1, 0.2, 0.3]}, "azimuth_offsets"),
        ({"horizontal_fov": (0.5, 0.501), "azimuth_count": 4}, "horizontal_fov"),
    ],
)
def test_impossible_lidars_are_refused(options, field):
    values = {"elevations": [0.0, 0.1], "azimuth_count": 10, "max_range": 50.0} | options
    with pytest.raises(pe.InputError, match=f"mine: {field}"):
        pe.Lidar("mine", **values)


@pytest.mark.parametrize(("size", "hfov"), [((0, 10), 1.0), ((10, 2.5), 1.0), ((10, 10), 3.2)])
def test_impossible_cameras_are_refused(size, hfov):
    with pytest.raises(pe.InputError, match="mine"):
        pe.Camera("mine", *size, hfov)


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


@pytest.mark.parametrize(("a", "b", "blind"), [(1e-9, -5.0, True), (1e-9, 5.0, False)])
def test_a_curve_that_never_leaves_the_clip_has_a_documented_result(a, b, blind):
    rig = pe.Rig([pe.Sensor("roof", shapes.small_lidar(24, 360), pe.Pose((0.0, 0.0, 2.0)))])
    model = pe.PerceptionModel(lidar=pe.ApCurve(a, b))
    for samples in (0, 2048):
        evaluator = pe.Evaluator(
            shapes.small_space(), pe.Prior.road(), samples=samples, model=model
        )
        score = evaluator.score(rig)
        seen = 0.0 if blind else score.coverage
        expected = 16.651386624 * (1.0 - seen) - 10.975632 * seen
        assert score.entropy == pytest.approx(expected, abs=1e-5) and score.coverage > 0.1
