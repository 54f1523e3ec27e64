"""The sequence behind samples, zones, weights and what scores leave out, each worked by hand."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.base.values import rounded
from pe_core.scoring import draw
from pe_core.scoring.sampling import outside_masses, outside_profile, scrambled_sobol
from pe_core.scoring.score import ZONES, column_zones, zone_masks
from tests.engine import shapes

BITS = 32
WORD = (1 << BITS) - 1
SOBOL = [
    # The first eight points in eighths, by the numbers of Joe and Kuo: the van der Corput sequence,
    # then the polynomials x + 1 (m = 1) and x^2 + x + 1 (m = 1, 3).
    (0, 0, 0),
    (4, 4, 4),
    (2, 6, 6),
    (6, 2, 2),
    (1, 5, 3),
    (5, 1, 7),
    (3, 3, 5),
    (7, 7, 1),
]
INSIDE = ("x", "y", "zones")
SPACE = pe.PerceptionSpace((0.0, 3.0), (0.0, 1.0), (0.0, 4.0), 1.0)
"""Three columns of four voxels, their centres at heights 0.5, 1.5, 2.5, 3.5."""
BOXES = [
    # class, x, y, z, length, width, height, yaw: low ones in the first two columns, a tall one
    ("car", 0.5, 0.5, 1.0, 1.0, 1.0, 2.0, 0.0),
    ("car", 1.5, 0.5, 1.0, 1.0, 1.0, 2.0, 0.0),
    ("truck", 2.5, 0.5, 2.0, 1.0, 1.0, 4.0, 0.0),
]


def mirrored(word):
    return int(f"{word:032b}"[::-1], 2)


def owen(word, seed):
    """Laine and Karras' hash with Vegdahl's constants, as Burley (2020) prints it, bit by bit."""
    x = mirrored(word)
    x ^= (x * 0x3D20ADEA) & WORD
    x = (x + seed) & WORD
    x = (x * ((seed >> 16) | 1)) & WORD
    x ^= (x * 0x05526C56) & WORD
    x ^= (x * 0x53A22864) & WORD
    return mirrored(x)


def seed_of(shift, dimension):
    """The shift in 32 bits, told apart by dimension, mixed as MurmurHash3 ends."""
    seed = (int(shift * 2**32) + (dimension + 1) * 0x9E3779B9) & WORD
    seed = ((seed ^ (seed >> 16)) * 0x85EBCA6B) & WORD
    seed = ((seed ^ (seed >> 13)) * 0xC2B2AE35) & WORD
    return seed ^ (seed >> 16)


@pytest.mark.parametrize("shift", [(0.5, 0.5, 0.5), (0.0, 0.25, 0.999), (0.1, 0.7, 0.3)])
def test_points_are_sobol_s_scrambled_by_the_hash(shift):
    found = scrambled_sobol(8, shift)
    for row, eighths in zip(found.tolist(), SOBOL, strict=True):
        for dimension, (value, eighth) in enumerate(zip(row, eighths, strict=True)):
            word = owen(eighth << (BITS - 3), seed_of(shift[dimension], dimension))
            assert value == word / 2.0**32


def test_each_dimension_is_a_net_of_its_own_far_into_the_sequence():
    """Of 2^14 points exactly one lies in each of 2^14 slices; of the first two in each box, too."""
    points = scrambled_sobol(1 << 14, (0.3, 0.6, 0.9))
    for column in points.T:
        assert len(np.unique(np.floor(column * (1 << 14)))) == 1 << 14
    boxes = np.floor(points[:, :2] * [1 << 9, 1 << 5]).astype(int)
    assert len(np.unique(boxes, axis=0)) == 1 << 14


@pytest.mark.parametrize(
    INSIDE,
    [
        (5.0, 5.0, {"front", "left", "near"}),
        (-5.0, -5.0, {"rear", "right", "near"}),
        (0.0, 3.0, {"left", "near"}),  # on a border: neither side
        (3.0, 0.0, {"front", "near"}),
        (6.0, 8.0, {"front", "left", "mid"}),  # 10 m away
        (-6.0, 7.99, {"rear", "left", "near"}),
        (24.0, -32.0, {"front", "right", "mid"}),  # 40 m away
        (-24.0, -32.01, {"rear", "right", "far"}),
    ],
)
def test_zones_of_a_point(x, y, zones):
    masks = zone_masks(np.array([x]), np.array([y]))
    assert tuple(masks) == ZONES
    assert {name for name, mask in masks.items() if mask[0]} == zones


def test_zones_of_columns():
    """Columns at x = -1, 1 and y = -1, 1, 3."""
    space = pe.PerceptionSpace((-2.0, 2.0), (-2.0, 4.0), (0.0, 2.0), 2.0)
    masks = column_zones(space)
    assert masks["front"].tolist() == [[False] * 3, [True] * 3]
    assert masks["left"].tolist() == [[False, True, True]] * 2


def roof(height):
    """A plate over the first column."""
    return pe.Vehicle(shapes.box((0.0, 0.0, height - 0.1), (1.0, 1.0, height)))


def test_what_lies_outside_the_vehicle():
    """Cars are in two layers, half of them each: a top at 1.5 m leaves the voxel centred there."""
    car, truck = pe.Prior.from_boxes(BOXES).densities(SPACE)
    tops = np.array([[-np.inf], [1.5], [1.5000001]])
    assert outside_profile(car, SPACE, tops).ravel().tolist() == [1.0, 0.5, 0.0]
    assert outside_profile(truck, SPACE, tops).ravel().tolist() == [1.0, 0.75, 0.5]
    # cars: 1/4 in each of the first two columns; the truck 1/2 in the third
    assert outside_masses([car, truck], SPACE, tops) == pytest.approx([0.25 + 0.125, 0.25])
    assert outside_masses([car, truck], SPACE, None) == pytest.approx([0.5, 0.5])
    with pytest.raises(pe.InputError, match="prior: weights: expected some weight outside"):
        outside_masses([car, truck], SPACE, np.full((3, 1), 9.0))


@pytest.mark.parametrize("height", [1.5, 1.51])
def test_a_voxel_whose_centre_is_on_the_roof_counts(height):
    """Of 8 units, cars 2 x 2 of 1, the truck 4 of 1: the first column keeps one or none."""
    kept = 1 if height == 1.5 else 0
    prior = pe.Prior.from_boxes(BOXES)
    vehicle = roof(height)
    rig = pe.Rig([pe.Sensor("s", shapes.small_lidar(), pe.Pose((1.5, 0.5, 9.0)))])
    grid = pe.Evaluator(SPACE, prior, vehicle).score(rig)
    assert grid.per_class["car"].share == pytest.approx((2 + kept) / (6 + kept))
    assert grid.ground_map.mass.ravel() * 8 == pytest.approx([kept, 2, 4])
    sampled = pe.Evaluator(SPACE, prior, vehicle, samples=4096).score(rig)
    assert sampled.per_class["car"].share == pytest.approx((2 + kept) / (6 + kept), abs=0.01)
    sample = draw(prior.densities(SPACE), SPACE, 4096, vehicle.top(SPACE))
    assert sorted(set(sample.index[sample.index[:, 0] == 0, 2].tolist())) == [1] * kept


def test_a_sample_is_drawn_where_the_prior_lies_and_knows_the_classes():
    """Columns hold 1/4, 1/4, 1/2; cars in the lower two layers, the truck in all four."""
    sample = draw(pe.Prior.from_boxes(BOXES).densities(SPACE), SPACE, 4096)
    assert sample.names == ("car", "truck") and len(sample.index) == 4096
    i, _, k = sample.index.T
    assert np.bincount(i).tolist() == pytest.approx([1024, 1024, 2048], abs=8)
    for column, layers in ((0, [512, 512]), (1, [512, 512]), (2, [512] * 4)):
        assert np.bincount(k[i == column]).tolist() == pytest.approx(layers, abs=12)
    assert (sample.classes == np.where(i[:, None] < 2, [1.0, 0.0], [0.0, 1.0])).all()
    assert (sample.centers == sample.index + 0.5).all()
    assert (np.diff(i) >= 0).all()  # nearest first
    assert np.bincount(sample.run).tolist() == [256] * 16


def test_a_voxel_of_two_classes_is_each_s_by_its_share():
    """A car and three trucks in one voxel, the classes alike: 1/2 and 1/2; cars doubled: 2/3."""
    both = [("car", 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.0)]
    both += [("truck", 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.0)] * 3
    for factor, share in ((1.0, 1 / 2), (2.0, 2 / 3)):
        prior = pe.Prior.from_boxes(both, [pe.Focus(factor, classes=("car",))])
        sample = draw(prior.densities(SPACE), SPACE, 1024)
        assert set(map(tuple, sample.index.tolist())) == {(0, 0, 0)}
        np.testing.assert_allclose(sample.classes, [[share, 1.0 - share]] * 1024)


@pytest.mark.parametrize("samples", [0, 2048], ids=["grid", "sampled"])
def test_a_class_without_any_mass_is_left_out(samples):
    prior = pe.Prior.road([pe.Focus(0.0, classes=("truck", "cone"))])
    rig = shapes.roof_rig()
    score = pe.Evaluator(shapes.small_space(), prior, samples=samples).score(rig)
    assert list(score.per_class) == ["car", "pedestrian", "cyclist"]
    assert sum(part.share for part in score.per_class.values()) == pytest.approx(1.0)


@pytest.mark.parametrize("samples", [0, 2048], ids=["grid", "sampled"])
def test_a_zone_without_any_mass_is_left_out(samples):
    """A space ahead on the left, nearer than 40 m."""
    space = pe.PerceptionSpace((12.0, 20.0), (2.0, 8.0), (0.0, 2.0), 1.0)
    rig = shapes.roof_rig()
    score = pe.Evaluator(space, pe.Prior.road(), samples=samples).score(rig)
    assert list(score.per_zone) == ["front", "left", "mid"]
    assert all(part.share == 1.0 for part in score.per_zone.values())


def test_scores_are_rounded_to_nine_decimals_without_a_negative_zero():
    assert rounded(1.23456789049) == 1.23456789
    assert rounded(np.float64(0.9999999996)) == 1.0
    assert math.copysign(1.0, rounded(-1e-12)) == 1.0
