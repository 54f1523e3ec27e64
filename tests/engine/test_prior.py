"""The prior: normalised, boxes on the ground, focus weights, and the samples drawn from it."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.sampling import draw, r3_sequence
from pe_core.weights import outside_masses
from tests.engine import shapes

SPACE = shapes.small_space()


def total(densities):
    return sum(d.ground.sum() * d.profile.sum() for d in densities)


@pytest.mark.parametrize("prior", [pe.Prior.road(), pe.Prior.uniform()], ids=["road", "uniform"])
def test_the_prior_sums_to_one(prior):
    assert total(prior.densities(SPACE)) == pytest.approx(1.0)


def test_classes_of_the_road_share_alike_and_stand_on_the_ground():
    densities = {d.name: d for d in pe.Prior.road().densities(SPACE)}
    assert list(densities) == ["car", "pedestrian", "cyclist", "truck", "cone"]
    for density in densities.values():
        assert density.ground.sum() == pytest.approx(0.2)
        assert (np.diff(density.profile) <= 0).all()
    z = SPACE.centers(2)
    assert densities["car"].profile[z > 2.6].sum() < 1e-4
    assert densities["truck"].profile[z > 2.6].sum() > 0.05


def test_the_road_is_met_more_often_near_than_far():
    ground = pe.Prior.road().densities(pe.PerceptionSpace(interval=0.5))[0].ground
    middle = ground[:, 80]
    assert middle[160] > 2 * middle[10] > 0
    np.testing.assert_allclose(ground, ground[::-1, ::-1], rtol=1e-9)


def test_focus_weights_multiply_and_are_normalised():
    ahead = pe.Focus(2.0, x=(0.0, math.inf))
    cones = pe.Focus(3.0, classes=("cone",))
    plain = pe.Prior.road().densities(SPACE)
    focused = pe.Prior.road([ahead, cones]).densities(SPACE)
    assert total(focused) == pytest.approx(1.0)
    ratio = focused[4].ground / plain[4].ground
    assert ratio[60, 5] / ratio[10, 5] == pytest.approx(2.0)
    cars = focused[0].ground / plain[0].ground
    assert ratio[60, 5] / cars[60, 5] == pytest.approx(3.0)


def test_bad_focus_is_refused():
    with pytest.raises(pe.InputError, match="factor"):
        pe.Focus(-1.0)
    with pytest.raises(pe.InputError, match="focus: x"):
        pe.Focus(1.0, x=(3.0, 3.0))
    with pytest.raises(pe.InputError, match=r"car, pedestrian.*'horse'"):
        pe.Prior.road([pe.Focus(1.0, classes=("horse",))])
    with pytest.raises(pe.InputError, match="some weight left"):
        pe.Prior.road([pe.Focus(0.0)]).densities(SPACE)


def test_the_vehicle_s_own_volume_carries_no_weight():
    densities = pe.Prior.uniform().densities(SPACE)
    tops = shapes.box_car().top(SPACE)
    columns = np.isfinite(tops)
    z = SPACE.centers(2)
    inside = sum(int((z < top).sum()) for top in tops[columns])
    assert inside > 0
    assert outside_masses(densities, SPACE, tops)[0] == pytest.approx(1 - inside / SPACE.size)


def test_samples_follow_the_prior_and_each_of_its_classes():
    densities = pe.Prior.road().densities(SPACE)
    sample = draw(densities, SPACE, 50_000)
    assert len(sample.index) == 50_000
    assert sample.classes.sum(axis=1) == pytest.approx(1.0)
    for density, likely in zip(densities, sample.classes.T, strict=True):
        assert likely.sum() / 50_000 == pytest.approx(0.2, abs=2e-3)
        drawn = np.bincount(sample.index[:, 0], likely, SPACE.shape[0]) / likely.sum()
        assert np.abs(drawn - density.ground.sum(axis=1) / density.ground.sum()).max() < 2e-3
        heights = np.bincount(sample.index[:, 2], likely, SPACE.shape[2]) / likely.sum()
        assert np.abs(heights - density.profile).max() < 5e-3


def test_no_sample_lies_inside_the_vehicle():
    tops = shapes.box_car().top(SPACE)
    sample = draw(pe.Prior.uniform().densities(SPACE), SPACE, 20_000, tops)
    assert (sample.centers[:, 2] >= tops[sample.index[:, 0], sample.index[:, 1]]).all()


def test_the_sequence_fills_space_evenly():
    points = r3_sequence(4096, np.array([0.5, 0.5, 0.5]))
    counts = np.histogramdd(points, bins=(8, 8, 8), range=[(0, 1)] * 3)[0]
    assert counts.min() >= 4 and counts.max() <= 12  # 8 on average; chance would give 1 to 20


def test_too_few_samples_are_refused():
    with pytest.raises(pe.InputError, match="samples: expected at least 1024, found 10"):
        pe.Evaluator(SPACE, pe.Prior.road(), samples=10)
