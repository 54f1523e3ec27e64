"""Vehicles of fewer triangles: how many, what is kept, and that the error told is a bound."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.scene.vehicle import closest_points
from pe_tools.graphics.simplify import simplified
from tests.engine import shapes


def ball(times, radius=1.0, center=(0.0, 0.0, 0.0)):
    """Triangles of a ball: a refined cube, blown up."""
    triangles = shapes.refined(shapes.box((-1, -1, -1), (1, 1, 1)), times)
    size = np.sqrt((triangles**2).sum(axis=-1, keepdims=True))
    return triangles / size * radius + np.asarray(center)


def surface_points(triangles, count, seed=0):
    """Points spread over triangles, by area."""
    rng = np.random.default_rng(seed)
    a = triangles[:, 0]
    b = triangles[:, 1]
    c = triangles[:, 2]
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    some = rng.choice(len(triangles), count, p=areas / areas.sum())
    u, v = rng.random((2, count, 1))
    flip = u + v > 1.0
    u = np.where(flip, 1.0 - u, u)
    v = np.where(flip, 1.0 - v, v)
    return a[some] + u * (b - a)[some] + v * (c - a)[some]


def farthest(points, triangles):
    """Greatest distance of points from a surface."""
    nearest = [np.linalg.norm(closest_points(p, triangles) - p, axis=1).min() for p in points]
    return max(nearest)


def car_with_rod():
    """A ball, a pane before it, and a rod and a bolt thinner than any cube of the grid."""
    pane = shapes.refined(shapes.box((1.2, -0.5, -0.5), (1.21, 0.5, 0.5)), 4)
    rod = shapes.refined(shapes.box((0.0, 0.0, 1.1), (0.002, 0.002, 2.1)), 3)
    bolt = shapes.refined(shapes.box((3.0, 0.0, 0.0), (3.001, 0.001, 0.001)), 2)
    groups = (ball(5), pane, rod, bolt)
    parts = np.repeat(np.arange(4), [len(g) for g in groups]).astype(np.int32)
    names = ("body", "pane", "rod", "bolt")
    return pe.Vehicle(np.concatenate(groups), parts, names, ("pane",), clearance=0.03)


@pytest.mark.parametrize("wanted", [1000, 3000, 10_000])
def test_triangles_are_about_as_many_as_wanted(wanted):
    small, error = simplified(pe.Vehicle(ball(6)), wanted)
    assert 0.6 * wanted < len(small.triangles) <= wanted
    assert 0.0 < error < 3.0 * np.sqrt(4 * np.pi / wanted)


@pytest.mark.parametrize("wanted", [1000, 4000])
def test_no_point_is_farther_than_the_error_told(wanted):
    car = car_with_rod()
    small, error = simplified(car, wanted)
    assert farthest(surface_points(car.triangles, 100), small.triangles) <= error
    assert farthest(surface_points(small.triangles, 100), car.triangles) <= error
    each = [surface_points(car.triangles[car.parts == part], 20) for part in range(4)]
    for part, points in enumerate(each):
        assert farthest(points, small.triangles[small.parts == part]) <= error


def test_parts_glass_and_clearance_are_kept():
    car = car_with_rod()
    small, _ = simplified(car, 1500)
    assert (small.part_names, small.glass, small.clearance) == (
        car.part_names,
        car.glass,
        car.clearance,
    )
    assert set(small.parts.tolist()) == {0, 1, 2, 3}


def test_rays_meet_it_where_they_met_it_before():
    """From outside, straight at the middle: no hole, and off by no more than the error told."""
    car = pe.Vehicle(ball(6))
    small, error = simplified(car, 2000)
    beams = -surface_points(ball(3), 60)
    beams /= np.linalg.norm(beams, axis=1, keepdims=True)
    for beam in beams:
        ray = beam[None]
        before = car.first_hit(tuple(-3.0 * beam), ray).distance[0]
        after = small.first_hit(tuple(-3.0 * beam), ray).distance[0]
        assert abs(after - before) <= 2.0 * error
