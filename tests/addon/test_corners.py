"""Plates in the corners of a view keep clear of each other."""

import pytest

from blender_addon import corners

READOUT = (20.0, 40.0, 320.0, 240.0)


@pytest.fixture
def shown():
    corners.reserve(7, "live", READOUT)
    yield
    corners.forget("live")
    corners.forget("search")


@pytest.mark.parametrize(
    ("region", "sides", "bottom"),
    [
        (7, (400.0, 600.0), 16.0),  # beside it
        (7, (300.0, 500.0), 246.0),  # above it
        (7, (325.0, 500.0), 246.0),  # within the gap
        (8, (300.0, 500.0), 16.0),  # another view
    ],
)
def test_a_plate_stands_above_what_it_would_cover(shown, region, sides, bottom):
    assert corners.bottom_above(region, sides, 16.0, 6.0) == bottom


def test_what_is_not_drawn_any_more_leaves_its_room(shown):
    corners.reserve(7, "search", (20.0, 250.0, 320.0, 400.0))
    assert corners.bottom_above(7, (0.0, 100.0), 16.0, 6.0) == 406.0
    corners.reserve(7, "search", None)
    assert corners.bottom_above(7, (0.0, 100.0), 16.0, 6.0) == 246.0
