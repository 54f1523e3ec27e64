"""Housings: what the catalogue says of them, and which parts of the body reach into one."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.catalog.housings import read_housing
from pe_core.scene.rig import SEAT_M, Housing, cuts_body
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

CAN = Housing("cylinder", (0.2, 0.2, 0.3), (0.0, 0.0, 0.1), "a test")
CRATE = Housing("box", (0.2, 0.4, 0.3), (0.1, 0.0, 0.15), "a test")
UPRIGHT = pe.Pose((0.0, 0.0, 0.0))
BAD = [
    ("housing", "round"),
    ("housing.shape", {"shape": "ball"}),
    ("housing.diameter", {"shape": "box", "diameter": 1}),
    ("housing.size", {"shape": "box", "size": [1, 2], "source": "a"}),
    ("housing.diameter", {"shape": "cylinder", "height": 1, "source": "a"}),
    ("housing.source", {"shape": "box", "size": [1, 2, 3]}),
]


def one_triangle(corners):
    """A vehicle of one triangle."""
    return pe.Vehicle(np.array([corners], dtype=float), part_names=("skin",))


def is_cut(housing, vehicle, pose=UPRIGHT):
    """Whether it is, to the last micrometre."""
    return bool(cuts_body(pose, housing, vehicle, seat=1e-9))


def test_parts_are_named_that_reach_in_and_no_others():
    vehicle = shapes.box_car()  # the cabin's roof is at 1.4 m, its front at x = 0.8
    assert cuts_body(pe.Pose((0.0, 0.0, 1.45)), CAN, vehicle) == ("cabin",)
    assert cuts_body(pe.Pose((0.75, 0.0, 0.95)), CAN, vehicle) == ("body", "cabin")
    assert cuts_body(pe.Pose((0.0, 0.0, 1.6)), CAN, vehicle) == ()


def test_a_housing_on_the_skin_stands_on_it():
    """The optical centre is 0.1 m above the base, so the base is on the roof at 1.5 m."""
    vehicle = shapes.box_car()
    assert cuts_body(pe.Pose((0.0, 0.0, 1.5)), CAN, vehicle) == ()
    assert cuts_body(pe.Pose((0.0, 0.0, 1.5 - 0.9 * SEAT_M)), CAN, vehicle) == ()
    assert cuts_body(pe.Pose((0.0, 0.0, 1.5 - 1.1 * SEAT_M)), CAN, vehicle) == ("cabin",)


def test_a_cylinder_is_round_and_a_box_is_not():
    """A skin across the corner at 45 degrees: 0.12 m from the axis."""
    far = 0.12 * math.sqrt(2.0)
    across = one_triangle([(far, 0.0, -5.0), (0.0, far, -5.0), (far / 2, far / 2, 5.0)])
    square = Housing("box", (0.2, 0.2, 0.3), (0.0, 0.0, 0.1), "a test")
    assert is_cut(square, across)
    assert not is_cut(CAN, across)


def test_the_optical_centre_is_the_sensor_s_place():
    """CRATE looks ahead from the middle of its front: behind it is its body, ahead nothing."""
    ahead = one_triangle([(0.01, -1, -1), (0.01, 1, -1), (0.01, 0, 1)])
    behind = one_triangle([(-0.19, -1, -1), (-0.19, 1, -1), (-0.19, 0, 1)])
    assert not is_cut(CRATE, ahead)
    assert is_cut(CRATE, behind)
    turned = pe.Pose.from_degrees((0.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    assert is_cut(CRATE, ahead, turned)
    assert not is_cut(CRATE, behind, turned)


@pytest.mark.parametrize("housing", [CAN, CRATE], ids=["cylinder", "box"])
def test_a_triangle_meets_it_when_a_point_of_the_triangle_is_inside(housing):
    """Against points sown densely over random triangles, small and large, tilted and level."""
    rng = np.random.default_rng(5)
    steps = 160
    weights = np.array(
        [(i, j, steps - i - j) for i in range(steps + 1) for j in range(steps + 1 - i)]
    )
    weights = weights / steps
    met = 0
    for number in range(400):
        size = (0.05, 0.2, 0.6)[number % 3]
        corners = rng.normal(0.0, 0.1, 3) + rng.normal(0.0, size, (3, 3))
        corners[:, 2] = np.where(number % 5 == 0, corners[0, 2], corners[:, 2])
        pose = pe.Pose(rng.normal(0.0, 0.05, 3), rng.normal(0.0, 2.0, 3))
        points = (weights @ corners - np.array(pose.position)) @ pose.ground_from_sensor
        depth = depths(housing, points - housing.center)
        spacing = np.ptp(corners, axis=0).max() * 2.0 / steps
        found = is_cut(housing, one_triangle(corners), pose)
        if depth.max() > 1e-6:
            assert found, number
        elif depth.max() < -spacing:
            assert not found, number
        met += found
    assert 80 < met < 320


def depths(housing, points):
    """How deep points lie inside the housing, its middle the origin; negative outside [m]."""
    half = np.array(housing.size) / 2.0
    if housing.shape == "box":
        return (half - np.abs(points)).min(axis=1)
    away = np.hypot(points[:, 0], points[:, 1])
    return np.minimum(half[0] - away, half[2] - np.abs(points[:, 2]))


def test_housings_of_the_catalogue_are_read_and_say_their_source():
    known = [name for name in pe.catalog.names() if pe.catalog.housing(name)]
    assert {"Pandar64", "Velodyne VLP-16 Puck", "Hesai QT128C2X"} <= set(known)
    for name in known:
        housing = pe.catalog.housing(name)
        assert housing.source, name
        assert 0.05 < min(housing.size) <= max(housing.size) < 0.3, name
        assert 0.0 < housing.optical_center[2] < housing.size[2], name
    puck = pe.catalog.housing("Velodyne VLP-16 Puck")
    assert puck.size == (0.1033, 0.1033, 0.0717)
    assert puck.optical_center == (0.0, 0.0, 0.0377)


def test_what_a_box_s_table_leaves_out_is_assumed():
    box = read_housing("x", {"shape": "box", "size": [0.1, 0.2, 0.06], "source": "a test"})
    assert box.optical_center == (0.05, 0.0, 0.03)
    can = {"shape": "cylinder", "diameter": 0.1, "height": 0.08, "source": "a test"}
    assert read_housing("x", can).optical_center == (0.0, 0.0, 0.04)


def test_a_wrong_table_is_refused():
    camera = {"kind": "camera", "width": 640, "height": 480, "hfov_deg": 60.0}

    def made(table):
        pe.catalog.from_table("x", camera | {"housing": table})

    assert wrongly_refused(made, BAD, "x") == []
