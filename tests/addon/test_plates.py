"""Plates in the corners of a view keep clear of each other."""

import pytest

from blender_addon import viewport
from blender_addon.engine import graphics
from blender_addon.overlay.labels import arranged

READOUT = (20.0, 40.0, 320.0, 240.0)
CAR = (500.0, 150.0, 900.0, 560.0)
GIZMOS = (940.0, 200.0, 1040.0, 860.0)
SIDEBAR = (1040.0, 0.0, 1600.0, 860.0)
ROOM = (130.0, 32.0, 1008.0, 640.0)
LEGENDS = [(350.0, 158.0), (350.0, 88.0), (350.0, 88.0)]


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


@pytest.mark.parametrize("readout", [[], [(130.0, 70.0, 620.0, 330.0)]])
def test_in_a_narrow_view_no_legend_is_lost_or_over_the_car(readout):
    """At a scale of 2 the first was over the car, and two of three were not drawn."""
    taken = [GIZMOS, SIDEBAR, *readout]
    boxes = arranged(LEGENDS, ROOM, taken, CAR, gap=12.0)
    for k, box in enumerate(boxes):
        assert (box[2] - box[0], box[3] - box[1]) == LEGENDS[k]
        assert box[0] >= ROOM[0] and box[1] >= ROOM[1] and box[2] <= ROOM[2] and box[3] <= ROOM[3]
        others = [*taken, *boxes[:k]]
        assert not any(graphics.boxes_overlap(box, other) for other in others)
        if not readout:
            assert not graphics.boxes_overlap(box, CAR)
