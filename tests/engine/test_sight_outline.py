"""Marching squares: closed rings, on the right side, where the field crosses the level."""

import numpy as np
import pytest

from pe_core.scoring.sight.grid_regions import outlines

X = Y = np.linspace(-5.0, 5.0, 101)


def signed_area(ring):
    x, y = ring[:, 0], ring[:, 1]
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2.0)


def lines_of(flags):
    count = np.arange(flags.shape[0], dtype=float), np.arange(flags.shape[1], dtype=float)
    return outlines(np.asarray(flags, dtype=float), 0.5, *count)


def test_a_cone_is_cut_in_a_circle():
    cone = 3.0 - np.hypot(X[:, None], Y)
    (ring,) = outlines(cone, 1.0, X, Y)
    assert np.hypot(*ring.T) == pytest.approx(2.0, abs=0.003)
    assert np.array_equal(ring[0], ring[-1])
    assert signed_area(ring) == pytest.approx(4 * np.pi, rel=0.003)


def test_a_hole_runs_the_other_way_round():
    ring_shaped = 1.0 - np.abs(np.hypot(X[:, None], Y) - 3.0)
    outer, inner = outlines(ring_shaped, 0.0, X, Y)
    assert signed_area(outer) == pytest.approx(16 * np.pi, rel=0.01)
    assert signed_area(inner) == pytest.approx(-4 * np.pi, rel=0.01)


def test_a_region_that_reaches_the_edge_is_closed_along_it():
    (ring,) = lines_of(np.ones((4, 3), bool))
    assert ring.min(axis=0) == pytest.approx([-0.5, -0.5])
    assert ring.max(axis=0) == pytest.approx([3.5, 2.5])
    assert signed_area(ring) == pytest.approx(4 * 3 - 4 * 0.125)


def test_two_corners_that_touch_are_apart():
    flags = np.zeros((5, 5), bool)
    flags[1, 1] = flags[2, 2] = True
    rings = lines_of(flags)
    assert len(rings) == 2
    assert all(signed_area(ring) == pytest.approx(0.5) for ring in rings)


def test_a_middle_that_is_inside_joins_two_corners():
    field = np.array([[-1.0, 3.0], [3.0, -1.0]])
    assert len(outlines(field, 0.0, np.arange(2.0), np.arange(2.0))) == 1
    assert len(outlines(-field, 0.0, np.arange(2.0), np.arange(2.0))) == 2
    hardly = np.array([[-1.0, 1.1], [1.1, -1.0]])
    assert len(outlines(hardly, 0.0, np.arange(2.0), np.arange(2.0))) == 1


def test_nothing_has_no_outline():
    assert lines_of(np.zeros((4, 4), bool)) == ()


def test_of_any_region_the_rings_are_closed_and_bound_its_area():
    """Of unit squares with corners cut off: each cell's area but for an eighth a corner or more."""
    rng = np.random.default_rng(5)
    for _ in range(30):
        flags = rng.random((12, 17)) < rng.random()
        padded = np.pad(flags, 2)
        rings = lines_of(padded)
        steps = [np.diff(ring, axis=0) for ring in rings]
        assert all(np.array_equal(ring[0], ring[-1]) for ring in rings)
        assert all((np.hypot(*step.T) < 1.01).all() for step in steps)
        area = sum(map(signed_area, rings))
        total = padded.astype(float)
        squares = total[:-1, :-1] + total[1:, :-1] + total[1:, 1:] + total[:-1, 1:]
        diagonal = (squares == 2) & (total[:-1, :-1] == total[1:, 1:])
        share = np.array([0.0, 0.125, 0.5, 0.875, 1.0])[squares.astype(int)]
        share[diagonal] = 0.25
        assert area == pytest.approx(share.sum())
