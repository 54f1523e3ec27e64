"""Plates in the corners of a view keep clear of each other."""

import pytest

from blender_addon import viewport

READOUT = (20.0, 40.0, 320.0, 240.0)


@pytest.fixture
def shown():
    viewport.reserve_plate(7, "live", READOUT)
    yield
    viewport.release_plate("live")
    viewport.release_plate("search")


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
    assert viewport.free_bottom(region, sides, 16.0, 6.0) == bottom


def test_what_is_not_drawn_any_more_leaves_its_room(shown):
    viewport.reserve_plate(7, "search", (20.0, 250.0, 320.0, 400.0))
    assert viewport.free_bottom(7, (0.0, 100.0), 16.0, 6.0) == 406.0
    viewport.reserve_plate(7, "search", None)
    assert viewport.free_bottom(7, (0.0, 100.0), 16.0, 6.0) == 246.0
