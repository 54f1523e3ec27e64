"""Ultrasonic sensors: echoes by hand, against points of an own lattice, kernels, no entropy."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core import sensors as kinds
from pe_core.geometry.grids import GroundGrid
from tests.engine import shapes
from tests.engine.kernels import every_voxel

TABLE = {"kind": "ultrasonic", "hfov_deg": 60, "vfov_deg": 30, "max_range_m": 2.0}
SPACE = pe.PerceptionSpace((-1, 5), (-3, 3), (0, 1), 0.25)


def ultrasonic(position=(2.4, 0.0, 0.5), rotation=(0, 0, 0), **change):
    model = catalog.from_table("own", {**TABLE, **change})
    return pe.Sensor("rear", model, pe.Pose.from_degrees(position, rotation))


def post(x, y, size=(0.1, 0.1, 1.0), yaw=0.0):
    return pe.Objects([[x, y, size[2] / 2]], [size], [yaw], [0], class_names=("post",))


@pytest.mark.parametrize(
    ("x", "y", "echo"),
    [
        (3.4, 0.0, 1.0),  # ahead, a metre away
        (4.44, 0.0, 1.0),  # its front is within two metres
        (4.56, 0.0, 0.0),  # it is not
        (3.4, 0.5, 1.0),  # 26.6 degrees aside
        (3.4, 0.72, 0.0),  # its nearer edge is 33.8 degrees aside
        (1.4, 0.0, 0.0),  # behind
    ],
)
def test_a_post_is_heard_in_the_cone(x, y, echo):
    assert kinds.measure_objects(ultrasonic(), post(x, y))[0] == echo
    near = ultrasonic(min_range_m=1.5)
    assert kinds.measure_objects(near, post(3.0, 0.0))[0] == 0.0


def test_a_wall_that_is_turned_away_returns_no_echo():
    """A plate at 40 degrees: its normal is beyond 25 degrees from every ray of the cone's half."""
    plate = (0.02, 0.6, 1.0)
    for degrees, echo in ((0, 1.0), (20, 1.0), (60, 0.0)):
        wall = post(3.6, 0.0, plate, math.radians(degrees))
        found = kinds.measure_objects(ultrasonic(max_incidence_deg=25), wall)[0]
        assert found == echo, degrees
        assert kinds.measure_objects(ultrasonic(), wall)[0] == 1.0


def test_objects_are_heard_where_points_of_their_surface_are():
    """An own lattice of the box's whole surface, in an own frame, decides; edges are left out."""
    sensor = ultrasonic(rotation=(0, 5, 12))
    rng = np.random.default_rng(5)
    turn = np.asarray(sensor.pose.ground_from_sensor)
    eye = np.asarray(sensor.pose.position)
    decided = 0
    for _ in range(150):
        x = rng.uniform(3.2, 5.0)
        y = rng.uniform(-1.6, 1.6)
        yaw = rng.uniform(-3, 3)
        size = rng.uniform(0.1, 0.8, 3)
        places = rng.uniform(-0.5, 0.5, (4000, 3))
        places[np.arange(4000), rng.integers(0, 3, 4000)] = rng.choice([-0.5, 0.5], 4000)
        c = math.cos(yaw)
        s = math.sin(yaw)
        surface = places * size @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (x, y, size[2] / 2)
        local = (surface - eye) @ turn
        far = np.linalg.norm(local, axis=1)
        azimuth = np.degrees(np.arctan2(local[:, 1], local[:, 0])) / 30
        rise = np.degrees(np.arcsin(local[:, 2] / far)) / 15
        out = np.maximum(np.hypot(azimuth, rise), far / 2.0)
        if abs(out.min() - 1.0) > 0.05:
            found = kinds.measure_objects(sensor, post(x, y, tuple(size), yaw))[0]
            assert found == (out.min() < 1.0)
            decided += 1
    assert decided > 100


def test_the_body_hides_some_of_the_cone():
    sensor = ultrasonic((2.32, 0.3, 0.5), (0, 0, 70))
    kind = kinds.KINDS["ultrasonic"]
    sample = kind.on_sample(every_voxel(SPACE), shapes.box_car(), 1)
    measured = sample.measure(sensor)
    free = kind.on_sample(every_voxel(SPACE), None, 1).measure(sensor)
    assert 0 < measured.m.sum() < free.m.sum()
    occlusion = sample.occlusion(measured)
    assert 0 < occlusion.occluded < occlusion.rays and set(occlusion.by_part) <= {"body", "cabin"}


def test_it_is_in_no_entropy_until_a_curve_is_given():
    roof = shapes.lidar_on_roof()
    sonar = ultrasonic()
    evaluator = pe.Evaluator(SPACE, pe.Prior.uniform(), shapes.box_car())
    alone, both = (evaluator.score(pe.Rig(s)) for s in ([roof], [roof, sonar]))
    assert both.entropy == alone.entropy and both.per_sensor["rear"].coverage > 0.0
    curve = pe.PerceptionModel(ultrasonic=pe.ApCurve(0.1, 0.4))
    own = pe.Evaluator(SPACE, pe.Prior.uniform(), shapes.box_car(), model=curve)
    assert own.entropy(pe.Rig([roof, sonar])) < alone.entropy


def test_the_ground_map_hears_posts_and_no_more():
    """A post of half a metre is heard in the cone, seen from above."""
    sensor = ultrasonic((0, 0, 0.3))
    grid = GroundGrid((-1.0, -2.0), (80, 80), 0.05)
    marked = kinds.KINDS["ultrasonic"].on_ground(kinds.GroundView(grid, 0.5)).mark(sensor)
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    far = np.hypot(x, y)
    aside = np.degrees(np.abs(np.arctan2(y, x)))
    assert marked.marked[(far > 0.1) & (far < 1.95) & (aside < 28)].all()
    outside = np.abs(y) - np.tan(math.radians(30.0)) * x
    assert not marked.marked[(far > 2.0 + 0.036) | (outside > 0.06)].any()


@pytest.mark.parametrize("side", [0.05, 0.1])
def test_the_near_field_is_tested_every_two_centimetres(side):
    """A square of which a place 2 cm or less from its edge is heard is marked."""
    sensor = ultrasonic((0, 0, 0.3))
    grid = GroundGrid((-1.0, -2.0), (round(4 / side), round(4 / side)), side)
    view = kinds.GroundView(grid, 0.5)
    marked = kinds.KINDS["ultrasonic"].on_ground(view).mark(sensor).marked
    fine = GroundGrid(grid.origin, (grid.shape[0] * 5, grid.shape[1] * 5), side / 5)
    middles = fine.middles(np.arange(fine.shape[0] * fine.shape[1]))
    x, y = middles.T
    heard = (np.hypot(x, y) < 1.999) & (np.degrees(np.abs(np.arctan2(y, x))) < 29.9) & (x > 0.1)
    share = heard.reshape(grid.shape[0], 5, grid.shape[1], 5).mean(axis=(1, 3))
    assert marked[share > 0.35].all()
    plain = np.hypot(grid.x[:, None], grid.y) < 2.0
    assert (marked & ~plain).any(), "squares whose middle is out of range have places in range"
