"""Plates over a view keep clear of each other, of the vehicle, and of most of the view."""

import itertools
from types import SimpleNamespace

import pytest

from blender_addon.engine import graphics
from blender_addon.live import readout
from blender_addon.operators import camera_strip, sensor_pictures
from blender_addon.overlay import labels, strip
from blender_addon.view import plates, viewport
from blender_addon.view.plates import Plate, PlateSize, Room
from blender_addon.view.viewport import FAINT, INK

VIEWS = [(700, 500), (1000, 640), (1280, 720), (1600, 900), (2560, 1440), (500, 1200)]
SIDEBARS = [0.0, 200.0, 330.0]
"""Widths at a scale of 1 [px]."""
TOOLBAR = 60.0
CARS = [None, (0.35, 0.3, 0.65, 0.7), (0.1, 0.05, 0.95, 0.75), (-1.0, -1.0, 2.0, 2.0)]
"""Boxes of the vehicle, as shares of the view: none, in the middle, near, and all round the eye."""
RED = (1.0, 0.2, 0.2, 1.0)
LEGENDS = [
    graphics.ColorKey("Requirements", classes=((RED, "met"), (RED, "not met"), (RED, "no longer"))),
    graphics.ColorKey("Entropy [nats]", (RED, INK), ("-10", "0", "16"), values=("seen", "unseen")),
    graphics.ColorKey("Expected AP of one more sensor", (RED, INK), ("0.61", "0.64")),
    graphics.ColorKey("Beams", classes=((RED, "free"), (RED, "occluded by the vehicle"))),
]
ROWS = [
    readout.TextRow(17.0, (("1.510 nats", INK), ("no difference shown", INK))),
    readout.TextRow(11.0, (("± 0.021 on 65,536 voxels, at rest, beams follow", FAINT),)),
    *[readout.TextRow(11.0, (("Better behind, within 10 m by 0.41 nats", INK),))] * 3,
]
TIME = graphics.TimeStrip(
    "child crosses from behind a parked car: confirmed 1.2 s before",
    names=("front_camera", "roof_lidar", "corner_left"),
    cells=graphics.LayerShape(),
    marks=(),
    first_s=-3.0,
    ends=(-3.0, 0.0),
)
PICTURES = [(1920, 1080)] * 4


def room_of(view, scale, sidebar, car):
    """The room of a view as Blender's regions leave it."""
    width, height = view
    right = width - sidebar * scale
    left = (TOOLBAR + 14.0) * scale
    box = (left, 37.0 * scale, right - 14.0 * scale, height - 110.0 * scale)
    blenders = [
        (right - plates.BESIDE_GIZMOS * scale, height - plates.GIZMOS * scale, right, height),
        (right, 0.0, width, height),
    ]
    vehicle = car and (car[0] * width, car[1] * height, car[2] * width, car[3] * height)
    return Room(box, scale, blenders, vehicle, plates.MAX_SHARE * max(right, 0.0) * height)


def plates_in(view, room):
    """All kinds of plates, in the sizes that their drawers give them."""
    region = SimpleNamespace(width=view[0], height=view[1])
    rows = camera_strip.rows_in(region, PICTURES, room)
    cameras = [camera_strip.size_of_row(row, room.scale) for row in rows]
    title = sensor_pictures.title_size("Cameras alone: 12.3 m² unseen to 12 m ahead", room)
    largest = sensor_pictures.size_in(region, (20.0, 24.0), room)
    birds = [
        PlateSize(max(s * largest.width, title.width), s * largest.height + title.height)
        for s in (1.0, 0.6, 0.3)
    ]
    return {
        plates.DRIVE_BY: [strip.strip_plate(TIME, room, seconds=1.0, note="")],
        plates.CAMERAS: [Plate(plates.CAMERAS, (*cameras, title), print)],
        plates.READOUT: [readout.plate_of(ROWS, room)],
        plates.BIRDS_EYE: [Plate(plates.BIRDS_EYE, (*birds, title), print)],
        plates.LEGEND: labels.legend_plates(LEGENDS, room),
    }


def area(box):
    return (box[2] - box[0]) * (box[3] - box[1])


def is_within(box, room):
    left, bottom, right, top = room.box
    return left <= box[0] and bottom <= box[1] and box[2] <= right + 1e-6 and box[3] <= top + 1e-6


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("view", VIEWS)
def test_no_plate_is_over_another_or_over_the_car_or_a_quarter_of_the_view(view, scale):
    """Of every subset of plates, beside every sidebar."""
    for sidebar, car in itertools.product(SIDEBARS, CARS):
        room = room_of(view, scale, sidebar, car)
        known = plates_in(view, room)
        for count in range(1, len(known) + 1):
            for kinds in itertools.combinations(known, count):
                shown = [plate for kind in kinds for plate in known[kind]]
                found = plates.laid_out(shown, room)
                assert_clear(shown, found, room)


def assert_clear(shown, found, room):
    """Hold a layout to what it promises."""
    boxes = [placed.box for placed in found if placed is not None]
    assert sum(map(area, boxes)) <= room.area
    for one, other in itertools.combinations(boxes, 2):
        assert not graphics.boxes_overlap(one, other)
    for plate, placed in zip(shown, found, strict=True):
        if placed is None:
            continue
        box, step = placed
        assert is_within(box, room)
        assert (box[2] - box[0], box[3] - box[1]) == pytest.approx(plate.sizes[step])
        assert not any(graphics.boxes_overlap(box, each) for each in room.taken)
        if room.vehicle and graphics.boxes_overlap(box, room.vehicle):
            assert plate.kind == plates.READOUT and step == len(plate.sizes) - 1


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_where_there_is_room_all_plates_are_whole(scale):
    view = (2560.0 * scale, 1440.0 * scale)
    room = room_of(view, scale, 200.0, CARS[1])
    known = plates_in(view, room)
    shown = [known[kind][0] for kind in (plates.READOUT, plates.CAMERAS, plates.LEGEND)]
    assert [placed.step for placed in plates.laid_out(shown, room)] == [0, 0, 0]


@pytest.mark.parametrize("view", VIEWS)
def test_the_readout_is_the_last_that_folds(view):
    """Alone it is as large as among all the others, and it is never lost where it alone is not."""
    for scale, car in itertools.product((1.0, 1.5, 2.0), CARS):
        room = room_of(view, scale, 200.0, car)
        known = plates_in(view, room)
        (alone,) = plates.laid_out(known[plates.READOUT], room)
        among = plates.laid_out([each for row in known.values() for each in row], room)
        assert (among[2] is None) == (alone is None)


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


@pytest.mark.parametrize("behind", [(0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (1.0, 1.0, 1.0)])
def test_text_on_plates_can_be_read_whatever_is_behind_them(behind):
    """WCAG's 4.5 to 1: colours of texts, of sensors, of bodies, and any other."""
    plate = viewport.over(viewport.PLATE, behind)
    steps = [k / 4.0 for k in range(5)]
    colors = [viewport.INK, viewport.FAINT, strip.STALE, readout.ALERT]
    colors += [*readout.SENSE_COLORS.values(), *itertools.product(steps, steps, steps, [0.5, 1.0])]
    for color in colors:
        drawn = viewport.readable(color)
        assert viewport.contrast(drawn, plate) >= 4.5
    for named in (viewport.INK, viewport.FAINT, strip.STALE, readout.ALERT):
        assert viewport.readable(named) == named


def test_contrast_is_that_of_the_standard():
    """WCAG 2.2: black on white is 21; #767676 is the darkest grey that is 4.5 on white."""
    white = (1.0, 1.0, 1.0)
    assert viewport.contrast((0.0, 0.0, 0.0), white) == pytest.approx(21.0)
    grey = [0x76 / 255.0] * 3
    assert viewport.contrast(grey, white) == pytest.approx(4.54, abs=0.01)
