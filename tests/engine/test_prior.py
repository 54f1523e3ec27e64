"""The prior: normalised, against numerical integrals, focus, and the samples drawn from it."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.prior.classes import sampled_positions
from pe_core.scoring.sampling import draw
from tests.engine import shapes

SPACE = shapes.small_space()
DENSITY_SPACE = pe.PerceptionSpace((-60.0, 60.0), (-30.0, 30.0), (0.0, 5.0), 0.5)
FINE = 4000
"""Points to a box of the numerical integrals."""


def total(densities):
    return sum(d.ground.sum() * d.profile.sum() for d in densities)


def test_a_class_that_is_not_met_in_the_space_has_no_mass():
    high = pe.PerceptionSpace((-20, 20), (-10, 10), (3.5, 5.0), 0.5)
    densities = {d.name: d for d in pe.Prior.road().densities(high)}
    assert densities["cone"].ground.sum() == 0.0
    assert total(densities.values()) == pytest.approx(1.0)


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


def centre_density(cls, x, y):
    """``exp(-|x| / L) * mean over lanes of (w Laplace(y) + (1 - w) N(y))``, as documented."""
    along = np.exp(-np.abs(x) / cls.decay_x)
    across = np.zeros_like(y)
    for lane in cls.lanes:
        d = y - lane
        laplace = np.exp(-np.abs(d) / cls.laplace_y) / (2.0 * cls.laplace_y)
        normal = np.exp(-0.5 * (d / cls.gauss_y) ** 2) / (cls.gauss_y * math.sqrt(2.0 * math.pi))
        across += (cls.laplace_share * laplace + (1.0 - cls.laplace_share) * normal) / len(
            cls.lanes
        )
    return along, across


def covering(density, middles, size):
    """Integral of a density of centres over those whose box of that size holds each middle."""
    steps = (np.arange(FINE) + 0.5) / FINE - 0.5
    return np.array([density(m + size * steps).mean() * size for m in middles])


def expected_ground(cls):
    length, width, _ = cls.size
    none = np.zeros(1)
    along = covering(lambda x: centre_density(cls, x, none)[0], DENSITY_SPACE.centers(0), length)
    across = covering(lambda y: centre_density(cls, none, y)[1], DENSITY_SPACE.centers(1), width)
    ground = np.outer(along, across)
    return ground / ground.sum()


@pytest.mark.parametrize("prior", ["road", "highway"])
def test_ground_and_heights_of_every_class(prior):
    """Height: the share of objects taller than a voxel's centre, heights scattering normally."""
    prior = getattr(pe.Prior, prior)()
    total = sum(c.share for c in prior.classes)
    heights = np.linspace(-8.0, 8.0, 40_001)  # in spreads
    weights = np.exp(-0.5 * heights**2)
    for cls, density in zip(prior.classes, prior.densities(DENSITY_SPACE), strict=True):
        expected = expected_ground(cls) * cls.share / total
        np.testing.assert_allclose(density.ground, expected, rtol=2e-4, atol=1e-11)
        tall = cls.size[2] + cls.height_spread * heights
        profile = np.array([weights[tall > z].sum() for z in DENSITY_SPACE.centers(2)])
        np.testing.assert_allclose(density.profile, profile / profile.sum(), atol=2e-4)


def test_a_road_s_car_by_hand():
    """Beyond half a car's length the mass falls as exp(-x / 39.4): over 20 m to exp(-0.50761)."""
    ground = pe.Prior.road().densities(DENSITY_SPACE)[0].ground
    along = ground.sum(axis=1)
    # centres at 10.25 and 30.25 m ahead
    i = 120 + 20
    j = 120 + 60
    assert along[j] / along[i] == pytest.approx(math.exp(-20.0 / 39.4), rel=1e-9)
    assert along[j] == pytest.approx(along[239 - j], rel=1e-9)  # as often behind as ahead


def test_focus_regions_are_where_they_are_said():
    """A region of 3 x 2 voxels ahead on the right counts three times; its edge is no part of it."""
    space = pe.PerceptionSpace((0.0, 4.0), (-2.0, 2.0), (0.0, 1.0), 0.5)
    focus = pe.Focus(3.0, (1.0, 2.5), (-1.5, -0.5))
    (density,) = pe.Prior.uniform([focus]).densities(space)
    expected = np.ones((8, 8))
    expected[2:5, 1:3] = 3.0
    np.testing.assert_allclose(density.ground, expected / (64 + 6 * 2), rtol=1e-12)
    on_centres = pe.Focus(3.0, (1.25, 2.25), (-9.0, 9.0))
    (density,) = pe.Prior.uniform([on_centres]).densities(space)
    factor = density.ground[:, 0] / density.ground[0, 0]
    assert factor.tolist() == pytest.approx([1, 1, 1, 3, 1, 1, 1, 1])


def test_sampled_positions_reach_both_ends_of_the_space():
    """The lowest and the highest number below 1 are the space's corners, 1/2 its middle in x."""
    u = np.array([0.0, 0.5, np.nextafter(1.0, 0.0)])
    x, y = sampled_positions(pe.Prior.road().classes[0], DENSITY_SPACE, u, u)
    assert x == pytest.approx([-60.0, 0.0, 60.0], abs=1e-6)
    assert y[[0, 2]] == pytest.approx([-30.0, 30.0], abs=1e-6)


def test_densities_are_of_classes_that_the_prior_has():
    with pytest.raises(pe.InputError, match=r"prior: density: expected one of car.*found 'bus'"):
        pe.Prior("road", pe.Prior.road().classes, density={"bus": 1.0})
