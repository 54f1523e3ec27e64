"""Objects drawn from the prior: where they stand, how large they are, what each counts."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.prior.classes import class_shape
from pe_core.scoring.sampling import DIMENSIONS, scrambled_sobol
from pe_core.scoring.targets import TargetRule, sample_objects
from pe_core.scoring.targets.scene_layout import (
    LabelledBoxes,
    LaidOutBoxes,
    ground_rectangles,
    overlap,
    scrambles,
)
from tests.engine import shapes

SPACE = pe.PerceptionSpace()
ROAD = pe.Prior.road()
FEW = TargetRule("objects", True, 64)
BOXES = [
    ("car", 10.0, 1.0, 0.8, 4.0, 2.0, 1.5, 0.3),
    ("car", -20.0, 3.0, 0.8, 4.2, 2.0, 1.6, 0.0),
    ("car", 0.5, 0.2, 0.8, 4.2, 2.0, 1.6, 0.0),
    ("tram", 500.0, 3.0, 2.0, 15.0, 2.5, 4.0, 0.0),
    ("pedestrian", 5.0, -3.0, 0.9, 0.6, 0.7, 1.8, 1.0),
]


def drawn(prior=ROAD, vehicle=None, targets=FEW, space=SPACE, **more):
    return sample_objects(prior, space, vehicle, targets, **more)


def own(found, name):
    """Which of the drawn objects are of a class."""
    return found.objects.labels == found.objects.class_names.index(name)


@pytest.fixture(scope="module")
def many():
    return drawn(targets=TargetRule("objects", True, 512))


def test_each_dimension_of_the_sequence_visits_every_interval_once():
    for shift in (0.5, 0.123):
        points = scrambled_sobol(256, (shift,) * DIMENSIONS)
        for column in points.T:
            assert sorted((column * 256).astype(int).tolist()) == list(range(256))


def test_pairs_of_dimensions_fill_the_square():
    """All are (t, 2)-nets of small t: no square of 1/8 by 1/8 is empty of 1024 points."""
    points = scrambled_sobol(1024, (0.5,) * DIMENSIONS)
    for a in range(DIMENSIONS):
        for b in range(a):
            cells = (points[:, a] * 8).astype(int) * 8 + (points[:, b] * 8).astype(int)
            assert np.bincount(cells, minlength=64).min() > 0, (a, b)


def test_no_two_of_a_scene_overlap_and_none_the_vehicle():
    car = shapes.box_car()
    dense = pe.Prior("road", ROAD.classes, density={"car": 60, "truck": 30})
    found = drawn(dense, car, TargetRule("objects", True, 8)).objects
    body = ground_rectangles(np.zeros((1, 2)), np.array([[4.6, 1.8, 1.0]]), np.zeros(1))
    for scene in range(8):
        there = np.flatnonzero(found.scenes == scene)
        ground = ground_rectangles(found.centers[there, :2], found.sizes[there], found.yaws[there])
        both = overlap(ground.among(), ground)
        np.fill_diagonal(both, False)
        assert len(there) > 90 and not both.any() and not overlap(ground, body).any()


def test_rectangles_overlap_where_they_have_ground_in_common():
    places = np.array([[0, 0], [3, 0], [0, 2], [2.5, 1.4], [0, 1.5]], dtype=float)
    sizes = np.array([[4, 2, 1], [2, 2, 1], [4, 2, 1], [1, 1, 1], [3, 0.1, 1]], dtype=float)
    yaws = np.array([0, 0, 0, math.pi / 4, math.pi / 2])
    ground = ground_rectangles(places, sizes, yaws)
    first = overlap(ground.at(0), ground).tolist()
    assert first == [True, False, False, False, True]  # itself; touching twice; near; crossing


def test_objects_are_met_where_the_prior_has_them(many):
    """The share of cars within 20 m ahead and behind, and 10 m beside, is the density's."""
    ground, _ = class_shape(ROAD.classes[0], SPACE)
    for axis, most in ((0, 20.0), (1, 10.0)):
        near = np.abs(SPACE.centers(axis)) < most
        expected = ground.sum(axis=1 - axis)[near].sum()
        found = np.mean(np.abs(many.objects.centers[own(many, "car"), axis]) < most)
        assert found == pytest.approx(expected, abs=0.02)


def test_sizes_scatter_round_their_means_and_stand_on_the_ground(many):
    for cls in ROAD.classes:
        sizes = many.objects.sizes[own(many, cls.name)]
        assert np.mean(sizes, axis=0) == pytest.approx(cls.size, rel=0.01)
        spread = np.array((cls.length_spread, cls.width_spread, cls.height_spread))
        most = np.minimum(2 * spread, np.array(cls.size) / 2) + 1e-4
        assert (np.abs(sizes - cls.size) <= most).all()
        assert np.std(sizes, axis=0)[1] == pytest.approx(0.88 * spread[1], rel=0.1)
    assert (many.objects.centers[:, 2] == many.objects.sizes[:, 2] / 2).all()


def test_cars_stand_along_the_road_and_pedestrians_anywhere(many):
    assert (many.objects.yaws[own(many, "car")] == 0.0).all()
    turns = np.sort(many.objects.yaws[own(many, "pedestrian")])
    even = math.pi * ((np.arange(len(turns)) + 0.5) / len(turns) - 0.5)
    assert turns == pytest.approx(even, abs=0.05)


def test_as_many_stand_in_a_scene_as_the_density_says(many):
    counts = np.bincount(many.objects.labels) / 512
    assert counts == pytest.approx([8.2, 5.1, 1.0, 2.4, 2.4], abs=0.002)
    by_scene = np.bincount(many.objects.scenes[own(many, "car")])
    assert set(by_scene.tolist()) == {8, 9} and many.scenes == 512


def test_classes_share_alike_however_many_there_are_and_focus_multiplies():
    found = drawn(pe.Prior.road([pe.Focus(3.0, x=(0, math.inf), classes=["car"])]))
    shares = [found.weights[own(found, c.name)].sum() for c in ROAD.classes]
    assert shares[1:] == pytest.approx([shares[1]] * 4) and found.weights.sum() == pytest.approx(1)
    ahead = own(found, "car") & (found.objects.centers[:, 0] > 0)
    behind = own(found, "car") & (found.objects.centers[:, 0] < 0)
    assert found.weights[ahead] / found.weights[behind][0] == pytest.approx(3.0)
    assert shares[0] == pytest.approx(2.0 * shares[1], rel=0.05)


def test_labelled_boxes_are_taken_as_they_are_each_once():
    """But for the one in the vehicle's place, and the one outside the space."""
    found = drawn(pe.Prior.from_boxes(BOXES), targets=TargetRule("objects")).objects
    assert found.class_names == ("car", "pedestrian", "tram") and found.labels.tolist() == [0, 0, 1]
    assert found.centers.tolist() == [[10, 1, 0.8], [-20, 3, 0.8], [5, -3, 0.9]]
    assert found.yaws == pytest.approx([0.3, 0.0, 1.0]) and found.scenes.tolist() == [0, 1, 2]
    assert found.sizes.tolist() == [[4, 2, 1.5], [4.2, 2, 1.6], [0.6, 0.7, 1.8]]


def test_scenes_of_labelled_boxes_are_drawn_from_them():
    boxes = [row for row in BOXES if row[0] != "tram"]
    prior = pe.Prior("boxes", boxes=pe.Boxes.of(boxes), density={"car": 1.5, "pedestrian": 0.5})
    found = drawn(prior, targets=TargetRule("objects", True, 16)).objects
    assert np.bincount(found.labels).tolist() == [24, 8]
    assert set(map(tuple, found.centers.tolist())) == {(10, 1, 0.8), (-20, 3, 0.8), (5, -3, 0.9)}
    assert len({(s, *c) for s, c in zip(found.scenes, found.centers.tolist(), strict=True)}) == 32


@pytest.mark.parametrize(
    ("prior", "told"),
    [
        (
            pe.Prior.uniform(),
            "prior: model: expected a prior with classes, because objects need them",
        ),
        ({"car": 3000}, "prior: density: expected objects that find room in the space without"),
        (dict.fromkeys(ROAD.class_names, 0.0), "expected at least one object in a scene"),
        ({"car": 1e6}, "prior: density: expected at most .* objects"),
    ],
)
def test_what_cannot_stand_is_reported_in_one_line(prior, told):
    if isinstance(prior, dict):
        prior = pe.Prior("road", ROAD.classes, density=prior)
    with pytest.raises(pe.InputError, match=told) as error:
        drawn(prior, targets=TargetRule("objects", True, 8))
    assert "\n" not in str(error.value)


def test_a_space_too_small_for_its_objects_is_reported():
    yard = pe.PerceptionSpace(x=(-6, 6), y=(-6, 6))
    share = ROAD.objects_at_once(yard)["car"] / 8.2
    crowded = pe.Prior("road", ROAD.classes[:1], density={"car": 15 / share})
    with pytest.raises(pe.InputError, match=r"in a scene, and no room for a car in 200 places"):
        drawn(crowded, targets=TargetRule("objects", True, 8), space=yard)


def test_a_prior_without_weight_on_the_objects_is_reported():
    nothing = pe.Prior.road([pe.Focus(0.0)])
    with pytest.raises(pe.InputError, match="some weight left on the objects, found none"):
        drawn(nothing)
    boxes = pe.Prior.from_boxes([("ufo", 9.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0)])
    with pytest.raises(pe.InputError, match="a number of 'ufo' in the space at once"):
        drawn(boxes)
    with pytest.raises(pe.InputError, match="size: expected three finite lengths above 0"):
        pe.ObjectClass(
            "flat",
            (4.0, 0.0, 1.5),
            height_spread=0.2,
            decay_x=30.0,
            laplace_y=1.0,
            gauss_y=0.5,
            laplace_share=0.0,
        )


def test_labelled_boxes_are_sampled_nearest_first():
    """Each of four boxes once, in the order of the sequence over the boxes by distance."""
    x = np.array([-8.0, 1.0, 4.0, -2.0])
    boxes = LaidOutBoxes(np.stack([x, 0.1 * x, x * 0.0], 1), np.ones((4, 3)), np.zeros(4))
    share = scrambled_sobol(4, scrambles(0.3, 0)[:1])[:, 0]
    expected = np.array([1.0, -2.0, 4.0, -8.0])[(4 * share).astype(int)]
    assert LabelledBoxes(boxes, 4, 0.3).proposed(0).centers[:, 0].tolist() == expected.tolist()
