"""Boxes to densities: held to every voxel centre tested, and counted by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.prior.boxes import voxel_of
from tests.engine import shapes
from tests.engine.refusals import wrongly_refused

SPACE = shapes.small_space(0.25)
ROTATED = [
    ("car", 3.01, -2.02, 0.81, 4.6, 1.9, 1.7, 33.0),
    ("car", -7.3, 4.1, 0.9, 4.1, 1.75, 1.63, -121.0),
    ("car", 0.07, 0.03, 0.9, 4.13, 1.91, 1.63, 0.0),
    ("car", 1.07, 5.03, 0.9, 4.13, 1.91, 1.63, 90.0),
    ("car", 1.07, 5.03, 0.9, 4.13, 1.91, 1.63, -180.0),
    ("car", 19.2, 9.3, 0.2, 6.1, 2.3, 3.1, 71.0),  # clipped by three faces
]
BY_HAND_SPACE = pe.PerceptionSpace((0.0, 3.0), (0.0, 2.0), (0.0, 2.0), 1.0)
ROW = ("car", 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.5)
IMPOSSIBLE = [
    ("model", {"model": "city"}),
    ("classes", {"model": "road"}),
    ("classes", {"model": "uniform", "classes": pe.Prior.road().classes}),
    ("boxes", {"model": "boxes"}),
    ("boxes", {"model": "road", "classes": pe.Prior.road().classes, "boxes": pe.Boxes.of([ROW])}),
    ("classes", {"model": "road", "classes": pe.Prior.road().classes[:1] * 2}),
]


def boxes(rows):
    """Boxes from rows (class, x, y, z, length, width, height, yaw in degrees)."""
    return pe.Boxes.of([(*row[:7], math.radians(row[7])) for row in rows])


def inside(row, space):
    """(nx, ny, nz) whether each voxel's centre is inside a box, tested one by one."""
    _, x, y, z, length, width, height, yaw = row
    dx, dy, dz = (
        g - c
        for g, c in zip(
            np.meshgrid(*(space.centers(a) for a in range(3)), indexing="ij"),
            (x, y, z),
            strict=True,
        )
    )
    c = math.cos(math.radians(yaw))
    s = math.sin(math.radians(yaw))
    u = c * dx + s * dy
    v = c * dy - s * dx
    return (abs(u) <= length / 2) & (abs(v) <= width / 2) & (abs(dz) <= height / 2)


@pytest.mark.parametrize("row", ROTATED, ids=lambda row: f"{row[7]:g} deg at {row[1]:g}")
def test_a_rotated_box_holds_the_voxels_whose_centres_are_inside(row):
    expected = inside(row, SPACE)
    (density,) = pe.Prior.from_boxes(boxes([row])).densities(SPACE)
    p = density.ground[:, :, None] * density.profile
    assert expected.any()
    np.testing.assert_allclose(p, expected / expected.sum(), rtol=1e-12, atol=0)


def test_a_class_is_its_ground_times_the_heights_of_all_its_boxes():
    counts = sum(inside(row, SPACE).astype(int) for row in ROTATED)
    (density,) = pe.Prior.from_boxes(boxes(ROTATED)).densities(SPACE)
    np.testing.assert_allclose(density.ground, counts.sum(axis=2) / counts.sum(), rtol=1e-12)
    np.testing.assert_allclose(density.profile, counts.sum(axis=(0, 1)) / counts.sum(), rtol=1e-12)


def test_every_class_sums_to_one_before_focus_and_shares_alike():
    prior = pe.Prior.from_boxes(boxes([*ROTATED, ("cone", 5, 5, 0.5, 0.4, 0.4, 1.0, 10)]))
    assert prior.model == "boxes" and prior.class_names == ("car", "cone")
    densities = prior.densities(SPACE)
    assert [d.ground.sum() for d in densities] == pytest.approx([0.5, 0.5])
    assert [d.profile.sum() for d in densities] == pytest.approx([1.0, 1.0])


def test_tables_in_memory_are_taken():
    rows = [
        ("car", 1.0, 2.0, 0.75, 4.0, 2.0, 1.5, 0.5),
        ("cone", 3.0, 2.0, 0.5, 0.4, 0.4, 1.0, 0.0),
    ]
    names = ["class", "x", "y", "z", "length", "width", "height", "yaw"]
    structured = np.array(rows, dtype=[("class", "U8"), *((n, "f8") for n in names[1:])])
    columns = {n: structured[n] for n in names}
    tables = [pe.Boxes.of(t) for t in (rows, structured, columns)]
    assert tables[0] == tables[1] == tables[2]
    assert pe.Prior.from_boxes(rows) == pe.Prior.from_boxes(tables[0])
    assert tables[0].yaw[0] == pytest.approx(0.5) and tables[0].x.dtype == np.float64


def test_yaws_wrap_and_are_what_a_file_gives_back(tmp_path):
    rng = np.random.default_rng(3)
    count = 500
    length = rng.uniform(0.1, 9.0, 500)
    place = rng.normal(0, 30, count)
    yaw = rng.uniform(-20, 20, count)
    names = rng.choice(["car", "a,b", 'say "x"', "#1", "Lkw-Anhänger", "two words"], count)
    table = pe.Boxes(
        names=names,
        x=place,
        y=-place,
        z=abs(place),
        length=length,
        width=length,
        height=length,
        yaw=yaw,
    )
    assert abs(table.yaw).max() <= math.pi
    np.testing.assert_allclose(np.cos(table.yaw), np.cos(yaw), atol=1e-10)
    pt.write_boxes(tmp_path / "boxes.csv", table)
    again = pt.read_boxes(tmp_path / "boxes.csv")
    assert again == table and np.array_equal(again.yaw, table.yaw)
    assert list(again.names) == list(names)


def counted(*boxes, space=BY_HAND_SPACE):
    """Boxes (x, y, z, length, width, height, yaw in degrees) as ground, profile and a report."""
    rows = [("car", *box[:6], math.radians(box[6])) for box in boxes]
    prior = pe.Prior.from_boxes(rows)
    (density,) = prior.densities(space)
    return density.ground, density.profile.tolist(), str(prior.report(space))


@pytest.mark.parametrize(
    ("x", "y", "z", "voxel"),
    [
        (0.2, 0.2, 0.2, (0, 0, 0)),
        (2.8, 1.8, 1.8, (2, 1, 1)),
        (0.0, 0.0, 0.0, (0, 0, 0)),  # on the lower corner
        (1.0, 1.0, 1.0, (1, 1, 1)),  # on a corner of eight: that of the upper one
        (2.9999, 0.1, 1.9, (2, 0, 1)),
    ],
)
def test_a_box_too_small_to_hold_a_centre_has_the_voxel_of_its_own(x, y, z, voxel):
    ground, profile, report = counted((x, y, z, 0.1, 0.1, 0.1, 30.0))
    i, j, k = voxel
    assert ground[i, j] == 1.0 and ground.sum() == 1.0
    assert profile[k] == 1.0 and report == "boxes: 1 box taken"


OUTSIDE = [(-0.2, 0.5, 0.5), (3.0, 0.5, 0.5), (0.5, -0.2, 0.5)]  # the space ends below 3
OUTSIDE += [(0.5, 2.0, 0.5), (0.5, 0.5, -0.2), (0.5, 0.5, 2.0)]
OUTSIDE = [(*center, 0.1, 0.1, 0.1, 0.0) for center in OUTSIDE]
OUTSIDE += [(9.0, 0.5, 0.5, 4.0, 1.0, 1.0, 0.0), (0.5, 0.5, 4.0, 1.0, 1.0, 2.0, 0.0)]


def test_a_box_outside_is_left_out_and_counted():
    inside = (1.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.0)
    for box in OUTSIDE:
        ground, profile, report = counted(inside, box)
        assert ground[1, 0] == 1.0 and profile == [1.0, 0.0], box
        assert -1 in [voxel_of(np.array(box[a]), BY_HAND_SPACE, a) for a in range(3)], box
        assert report == "boxes: 1 box taken, 1 left out (1 outside the space)"
    assert wrongly_refused(counted, [("boxes", box) for box in OUTSIDE], "boxes") == []


def changed(*changes):
    """Four boxes, some numbers of which are changed: (box, column, value)."""
    rows = [list(ROW) for _ in range(4)]
    for box, column, value in changes:
        rows[box][column] = value
    return rows


BAD_BOXES = [
    ("box 2: x", changed((2, 1, math.nan), (3, 1, math.nan))),
    ("box 1: width", changed((1, 5, -1.0), (3, 5, 0.0))),
    ("box 0: height", changed((0, 6, 0.0))),
    ("box 1: yaw", changed((1, 7, math.inf))),
    ("box 3: z", changed((3, 3, -2e9))),
    ("class", changed((1, 0, ""))),
    ("class", changed((1, 0, " car"))),
    ("box 1", [ROW, ROW[:-1]]),
    ("box 1", [ROW, "carriage"]),
    ("box 1", [ROW, 3]),
    ("table", "boxes.csv"),
    ("table", 3),
    ("y", {"class": ["car"], "x": [1.0]}),
]


def test_the_first_bad_box_is_named():
    assert wrongly_refused(pe.Prior.from_boxes, BAD_BOXES, "boxes") == []


def test_the_labels_origin_is_three_lengths_of_a_thousand_kilometres_at_most():
    for origin in ((1e6, -1e6, 0.0), None):
        assert replace(pe.Boxes.of([ROW]), origin=origin).origin == origin
    for origin in ((1.0, 2.0), (1_000_000.5, 0.0, 0.0), (0.0, 0.0, math.nan), (1, 2, 3, 4)):
        with pytest.raises(pe.InputError, match="boxes: origin"):
            replace(pe.Boxes.of([ROW]), origin=origin)


def test_boxes_are_equal_when_they_hold_the_same():
    one = pe.Boxes.of([ROW])
    same = pe.Boxes.of([ROW])
    assert one == same and hash(one) == hash(same) and one != "boxes"
    for column in range(1, 8):
        row = [v + 1.0 if k == column else v for k, v in enumerate(ROW)]
        assert pe.Boxes.of([row]) != one
    assert pe.Boxes.of([("bus", *ROW[1:])]) != one
    assert len(one) == 1 and one.source == "boxes"


def test_impossible_priors_are_refused():
    assert wrongly_refused(lambda v: pe.Prior(**v), IMPOSSIBLE, "prior") == []
