"""Plates in the corners of a view keep clear of each other."""

import pytest

from blender_addon import viewport
from blender_addon.engine import graphics
from blender_addon.live import readout
from blender_addon.overlay.labels import Surroundings, arranged, folded
from blender_addon.viewport import INK

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


@pytest.mark.parametrize("area", [1e9, 60_000.0])
@pytest.mark.parametrize("car", [CAR, (150.0, 40.0, 1000.0, 560.0), None])
def test_plates_fold_before_they_cover_the_car_or_a_quarter_of_the_view(car, area):
    """The last folds first; what is not over the car stays whole."""
    around = Surroundings(ROOM, [GIZMOS, SIDEBAR], car, 12.0)
    title = 25.0
    placed = folded(LEGENDS, title, around, area)
    shown = [each.box for each in placed if each is not None]
    assert not any(car and graphics.boxes_overlap(box, car) for box in shown)
    whole = [each is not None and not each.is_folded for each in placed]
    assert whole == sorted(whole, reverse=True), "a later one is whole, an earlier one folded"
    covered = sum((box[2] - box[0]) * (box[3] - box[1]) for box in shown)
    assert covered <= area or not any(whole)
    assert all(whole) == (area == 1e9 and car in (CAR, None))


def test_a_readout_too_wide_goes_on_below_and_loses_no_word():
    rows = [
        readout.TextRow(10.0, (("1.510", INK), ("no difference shown", INK))),
        readout.TextRow(10.0, (("at rest, beams and maps follow", INK), ("and more", INK)), 0.3),
    ]
    for widest in (1.0, 90.0, 140.0, 1e4):
        found = readout.wrapped(rows, widest, 1.0)
        said = " ".join(text for row in found for text, _ in row.words)
        assert said == "1.510 no difference shown at rest, beams and maps follow and more"
        assert len(found) >= len(rows)
    assert readout.wrapped(rows, 1e4, 1.0) == rows
    assert len(readout.wrapped(rows, 90.0, 1.0)) > len(rows)
