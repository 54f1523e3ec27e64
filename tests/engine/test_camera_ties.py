"""Cameras at round places: what rounding must not decide."""

import math
from itertools import product

import numpy as np
import pytest

import pe_core as pe
from pe_tools.verify import oracle
from tests.engine import shapes
from tests.engine.kernels import FLAT, every_voxel, on_grid, on_sample
from tests.thorough import pairs

SPACE = pe.PerceptionSpace((-3, 3), (-2, 2), (0, 2), 0.2)
VOXELS = every_voxel(SPACE)
CENTERS = VOXELS.centers
SHEET = np.array([[-2.0, -1.0, 0.5], [2.0, -1.0, 0.5], [2.0, 1.0, 0.5], [-2.0, 1.0, 0.5]])
BOX = pe.Vehicle(shapes.box((-0.8, -0.6, 0.0), (0.6, 0.6, 0.7)), clearance=0.0)


def in_every_way(sensor, vehicle=None):
    """Areas by the definition, on a sample and on the grid."""
    sample = on_sample(sensor, SPACE, VOXELS.index, vehicle)
    grid = on_grid(sensor, SPACE, vehicle, 7).reshape(-1)
    return pe.measure(sensor, CENTERS, SPACE.interval, vehicle), sample, grid


@pytest.mark.parametrize("yaw", [0, 45, 90, 135, 180, -60])
@pytest.mark.parametrize("pitch", [0, 30, 45, 90])
def test_a_voxel_with_a_corner_in_the_camera_s_plane_is_not_seen(pitch, yaw):
    """The camera stands on a corner, where many voxels have one: in front a voxel is whole."""
    for turns in (-1, 0, 1):
        sensor = shapes.camera(120.0, (0.2, -0.4, 1.0), (0, pitch, yaw + 360 * turns))
        c, s = (f(math.radians(yaw)) for f in (math.cos, math.sin))
        p = math.cos(math.radians(pitch))
        q = math.sin(math.radians(pitch))
        forward = np.array([c * p, s * p, -q])
        lowest = (CENTERS - sensor.pose.position) @ forward - 0.1 * np.abs(forward).sum()
        on_plane = np.abs(lowest) < 1e-9
        assert on_plane.sum() > 5 or yaw == -60 or pitch == 30
        for areas in in_every_way(sensor):
            assert not areas[on_plane].any()
            assert not areas[lowest < 0.0].any()
            assert areas[lowest > 1e-9].any()


def test_voxels_round_a_camera_on_a_corner():
    """By the oracle, at 216 orientations: the eight at the corner are never seen, others are."""
    corner = np.array([0.2, -0.4, 1.0])
    centers = corner + 0.2 * (np.array(list(product((-1, 0, 1), repeat=3))) + 0.5)
    touching = (np.abs(centers - corner) < 0.11).all(axis=1)
    seen = 0
    for turn in product((0, 45, 90, 150, 180, 270), repeat=3):
        sensor = shapes.camera(100.0, corner, turn)
        areas = pe.measure(sensor, centers, 0.2)
        pose = sensor.pose
        camera_size = (1920, 1080)
        hfov = math.radians(100.0)
        origin = corner
        rpy = pose.rpy
        expected = [
            oracle.pixel_area(camera_size, hfov, origin, rpy, center=center, side=0.2)
            for center in centers
        ]
        np.testing.assert_allclose(areas, expected, rtol=1e-9, atol=1e-6)
        assert not areas[touching].any()
        assert ((areas > 0.0) == (np.array(expected) > 1e-6)).all()
        seen += np.count_nonzero(areas)
    assert seen > 300


@pytest.mark.parametrize("height", [1.3, 0.0], ids=["from above", "from below"])
@pytest.mark.parametrize("move", [0.0, 0.1, 0.2])
def test_a_centre_on_a_surface_is_seen_and_one_behind_it_is_not(height, move):
    """A level sheet through the centres of a layer, from either side; moved by half voxels too."""
    by = np.array([move, -move, 0.0])
    sheet = pe.Vehicle((SHEET + by)[[[0, 1, 2], [0, 2, 3]]])
    pitch = 30.0 if height > 0.5 else -30.0
    sensor = shapes.camera(90.0, np.array([-1.8, 0.0, height]) + by, (0.0, pitch, 0.0))
    off = CENTERS - by
    over = (np.abs(off[:, 0]) < 1.7) & (np.abs(off[:, 1]) < 0.7)
    on_it = over & (np.abs(off[:, 2] - 0.5) < 1e-9)
    behind = over & ((off[:, 2] - 0.5) * (height - 0.5) < -0.01)
    for free, areas in zip(in_every_way(sensor), in_every_way(sensor, sheet), strict=True):
        assert (free[on_it] > 0.0).sum() > 20 and (free[behind] > 0.0).sum() > 20
        assert areas[on_it].tolist() == free[on_it].tolist()
        assert not areas[behind].any()


@pytest.mark.parametrize(
    ("position", "yaw"),
    pairs([(-1.3, -0.6, 0.7), (1.1, 0.5, 0.7), (0.6, -1.2, 1.1)], [0, 90, 180, 45]),
)
def test_rays_along_a_box_s_edges_and_sides(position, yaw):
    """Camera, edges and centres in one plane: definition, grid and sample as the oracle has it."""
    sensor = shapes.camera(110.0, position, (0.0, 0.0, yaw))
    free = pe.measure(sensor, CENTERS, SPACE.interval)
    asked = np.flatnonzero(free)[::7]
    origin = np.array(position)
    hidden = [oracle.hidden(origin, c, 0.2, BOX.triangles) for c in CENTERS[asked]]
    for areas in in_every_way(sensor, BOX):
        assert (areas[asked] == 0.0).tolist() == hidden


def test_voxels_on_the_border_are_hidden_where_the_vehicle_is_below_the_picture():
    """A wall that ends 6 % below the picture: the coarse map of it is empty as well."""
    sensor = shapes.camera(60.0, (-1.5, 0.1, 1.0))
    edge = 1.0 - 0.6 * math.tan(sensor.model.vfov / 2.0) * 1.06
    wall = pe.Vehicle(shapes.box((-0.9, -2.0, 0.0), (-0.899, 2.0, edge)))
    free = in_every_way(sensor)
    areas = in_every_way(sensor, wall)
    gone = (free[0] > 0.0) & (areas[0] == 0.0)
    assert gone.sum() > 3
    for found in areas[1:]:
        assert ((found > 0.0) == (areas[0] > 0.0)).all()
        np.testing.assert_allclose(found, areas[0], rtol=FLAT)
