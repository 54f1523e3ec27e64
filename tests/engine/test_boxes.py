"""Boxes to densities: held to every voxel centre tested, clipped, thin, counted."""

import math
import pickle

import numpy as np
import pytest

import pe_core as pe
from tests.engine import shapes

SPACE = shapes.small_space(0.25)


def boxes(*rows):
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
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    u, v = c * dx + s * dy, c * dy - s * dx
    return (abs(u) <= length / 2) & (abs(v) <= width / 2) & (abs(dz) <= height / 2)


ROTATED = [
    ("car", 3.01, -2.02, 0.81, 4.6, 1.9, 1.7, 33.0),
    ("car", -7.3, 4.1, 0.9, 4.1, 1.75, 1.63, -121.0),
    ("car", 0.07, 0.03, 0.9, 4.13, 1.91, 1.63, 0.0),
    ("car", 1.07, 5.03, 0.9, 4.13, 1.91, 1.63, 90.0),
    ("car", 1.07, 5.03, 0.9, 4.13, 1.91, 1.63, -180.0),
    ("car", 19.2, 9.3, 0.2, 6.1, 2.3, 3.1, 71.0),  # clipped by three faces
]


@pytest.mark.parametrize("row", ROTATED, ids=lambda row: f"{row[7]:g} deg at {row[1]:g}")
def test_a_rotated_box_holds_the_voxels_whose_centres_are_inside(row):
    expected = inside(row, SPACE)
    (density,) = pe.Prior.from_boxes(boxes(row)).densities(SPACE)
    p = density.ground[:, :, None] * density.profile
    assert expected.any()
    np.testing.assert_allclose(p, expected / expected.sum(), rtol=1e-12, atol=0)


def test_a_class_is_its_ground_times_the_heights_of_all_its_boxes():
    counts = sum(inside(row, SPACE).astype(int) for row in ROTATED)
    (density,) = pe.Prior.from_boxes(boxes(*ROTATED)).densities(SPACE)
    np.testing.assert_allclose(density.ground, counts.sum(axis=2) / counts.sum(), rtol=1e-12)
    np.testing.assert_allclose(density.profile, counts.sum(axis=(0, 1)) / counts.sum(), rtol=1e-12)


def test_every_class_sums_to_one_before_focus_and_shares_alike():
    prior = pe.Prior.from_boxes(boxes(*ROTATED, ("cone", 5, 5, 0.5, 0.4, 0.4, 1.0, 10)))
    assert prior.model == "boxes" and prior.class_names == ("car", "cone")
    densities = prior.densities(SPACE)
    assert [d.ground.sum() for d in densities] == pytest.approx([0.5, 0.5])
    assert [d.profile.sum() for d in densities] == pytest.approx([1.0, 1.0])


def test_focus_weighs_the_classes_of_the_boxes():
    table = boxes(*ROTATED, ("tram", 5, 5, 0.5, 0.4, 0.4, 1.0, 10))
    focused = pe.Prior.from_boxes(table, [pe.Focus(3.0, classes=("tram",))]).densities(SPACE)
    assert [d.ground.sum() for d in focused] == pytest.approx([0.25, 0.75])
    with pytest.raises(pe.InputError, match="classes: expected one of car, tram, found 'cone'"):
        pe.Prior.from_boxes(table, [pe.Focus(3.0, classes=("cone",))])


def test_boxes_outside_the_space_are_counted():
    table = boxes(*ROTATED, ("car", 30, 0, 1, 4, 2, 1.5, 0), ("tram", 0, 0, 9, 4, 2, 1.5, 0))
    prior = pe.Prior.from_boxes(table)
    report = prior.report(SPACE)
    assert str(report) == "boxes: 6 boxes taken, 2 left out (2 outside the space)"
    densities = prior.densities(SPACE)  # trams are not met in it
    assert [d.ground.sum() for d in densities] == pytest.approx([1.0, 0.0])
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar())])
    for samples in (0, 2048):
        score = pe.Evaluator(SPACE, prior, samples=samples).score(rig)
        assert list(score.per_class) == ["car"] and math.isfinite(score.entropy)
    with pytest.raises(pe.InputError, match=r"^boxes: boxes: expected a box in .*all 8 outside$"):
        prior.densities(pe.PerceptionSpace((50, 60), (0, 10), (0, 5), 0.5))


def test_a_prior_of_boxes_is_a_value():
    prior = pe.Prior.from_boxes(boxes(*ROTATED))
    same, other = (pe.Prior.from_boxes(boxes(*rows)) for rows in (ROTATED, ROTATED[1:]))
    assert prior == same and hash(prior) == hash(same) and prior != other
    again = pickle.loads(pickle.dumps(prior))
    assert again == prior
    for a, b in zip(again.densities(SPACE), prior.densities(SPACE), strict=True):
        assert np.array_equal(a.ground, b.ground) and np.array_equal(a.profile, b.profile)
    with pytest.raises(ValueError, match="read-only"):
        prior.boxes.x[0] = 1.0


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
    count, length = 500, rng.uniform(0.1, 9.0, 500)
    place, yaw = rng.normal(0, 30, count), rng.uniform(-20, 20, count)
    names = rng.choice(["car", "a,b", 'say "x"', "#1", "Lkw-Anhänger", "two words"], count)
    table = pe.Boxes(names, place, -place, abs(place), length, length, length, yaw)
    assert abs(table.yaw).max() <= math.pi
    np.testing.assert_allclose(np.cos(table.yaw), np.cos(yaw), atol=1e-10)
    pe.write_boxes(tmp_path / "boxes.csv", table)
    again = pe.read_boxes(tmp_path / "boxes.csv")
    assert again == table and np.array_equal(again.yaw, table.yaw)
    assert list(again.names) == list(names)
