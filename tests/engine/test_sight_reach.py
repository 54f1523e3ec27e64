"""Reach and expected AP: by hand, and held to the definition."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.metric.entropy import ap_of_entropy, average_precision, entropy_of, sigma_of
from pe_core.scoring import sight
from tests.engine import shapes
from tests.engine.kernels import on_sample
from tests.thorough import tries

SPACE = pe.PerceptionSpace((-60, 60), (-20, 20), (1, 2), 0.5)
UNIFORM = pe.Prior.uniform()


def dense_lidar(max_range, azimuths, position=(0.03, 0.01, 1.52)):
    """Beams so close that nearly every voxel has one, up to where they are half a metre apart."""
    channels = np.linspace(-35, 35, azimuths * 70 // 360 + 1)
    model = pe.Lidar("dense", np.radians(channels), azimuths, max_range)
    return pe.Sensor("dense", model, pe.Pose(position))


def test_a_lidar_reaches_as_far_as_its_beams():
    reach = sight.Sight(SPACE, UNIFORM).reach(pe.Rig([dense_lidar(15.0, 240)]), "any", bearings=36)
    assert reach.distance == pytest.approx(np.full(36, 15.0), abs=1.0)
    assert np.array_equal(reach.per_sensor["dense"], reach.distance)
    assert reach.bearings[:2] == pytest.approx([0.0, math.radians(10.0)])


def test_a_camera_reaches_as_far_as_the_definition_has_it():
    """Ahead, where the mean AP of voxels over the height falls below the value asked for."""
    rig = pe.Rig([shapes.camera(60.0, (0.0, 0.0, 1.5))])
    own = sight.Sight(SPACE, UNIFORM)
    curve = kinds.PerceptionModel().camera
    for ap in (0.5, 0.55, 0.6):
        x = SPACE.centers(0)
        x = x[x > 0.0]
        centers = np.array([(w, 0.25, z) for w in x for z in (1.25, 1.75)])
        m = kinds.measure(rig["camera"], centers, 0.5).reshape(-1, 2)
        mean = average_precision(m, curve).mean(axis=1)
        farthest = x[mean >= ap].max()
        reach = own.reach(rig, "any", ap=ap, bearings=360)
        assert reach.distance[0] == pytest.approx(farthest, abs=1.0)
        assert 5.0 < farthest < 55.0
        assert reach.distance[180] == 0.0  # behind it


def test_a_reach_is_that_of_every_voxel_in_the_sector():
    """All voxels within 7.5 degrees of a bearing, weighed as its sector and those beside it."""
    space = pe.PerceptionSpace((-45, 45), (-15, 15), (0, 3), 0.25)
    prior = pe.Prior.road()
    car = shapes.box_car()
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(96, 900), (0.0, 0.0, 1.9))])
    own = sight.Sight(space, prior, car)
    found = own.reach(rig, "pedestrian", ap=0.5)
    assert own.reach_ahead(rig, "pedestrian") == (found.distance[0], False)
    density = prior.densities(space)[1]
    x = space.centers(0)[:, None]
    y = space.centers(1)
    for bearing in (2, 36, 0, 70)[: tries(2, 4)]:
        angle = found.bearings[bearing]
        aside = np.abs(np.remainder(np.arctan2(y, x) - angle + np.pi, 2.0 * np.pi) - np.pi)
        steps = np.floor(np.degrees(aside) / 5.0 + 0.5)
        columns = np.argwhere((steps <= 1) & (np.hypot(x, y) > 3.0))
        weight = np.where(steps == 0, 2.0, 1.0)[tuple(columns.T)] / np.hypot(x, y)[tuple(columns.T)]
        ap = np.zeros(len(columns))
        for k in np.flatnonzero(density.profile > 1e-3):
            index = np.column_stack([columns, np.full(len(columns), k)])
            m = on_sample(rig["roof"], space, index, car)
            ap += density.profile[k] * average_precision(m, kinds.PerceptionModel().lidar)
        ring = np.hypot(x, y)[tuple(columns.T)].astype(int)
        mean = np.convolve(np.bincount(ring, ap * weight), np.ones(5))
        mean /= np.convolve(np.bincount(ring, weight), np.ones(5)) + 1e-9
        last = np.flatnonzero(mean[2:-2] >= 0.5).max()
        assert 20 < last < 44
        assert found.distance[bearing] == pytest.approx(last + 1.0, abs=1.5)


def test_the_blind_zone_near_by_does_not_end_a_reach():
    """Channels from 4 to 2 degrees down see objects of the uniform layer from some metres on."""
    elevations = np.radians(np.linspace(-4.0, 0.0, 200))
    model = pe.Lidar("far", elevations, 1440, 30.0)
    rig = pe.Rig([pe.Sensor("far", model, pe.Pose((0.0, 0.0, 2.6)))])
    own = sight.Sight(SPACE, UNIFORM)
    assert own.ground(rig, 1.5, step=0.5, within=3.0).coverage.max() == 0.0
    assert own.reach(rig, "any", bearings=4).distance[0] == pytest.approx(30.0, abs=1.0)


def test_ap_of_an_entropy_undoes_the_equations():
    ap = np.array([0.001, 0.2, 0.5, 0.999])
    assert ap_of_entropy(entropy_of(sigma_of(ap) ** -2)) == pytest.approx(ap, rel=1e-12)


def test_expected_ap_is_the_prior_s_mean():
    """Against every voxel of a space, measured by the definition."""
    space = shapes.small_space()
    prior = pe.Prior.road()
    rig = shapes.roof_rig()
    index = np.indices(space.shape).reshape(3, -1).T
    m = kinds.measure(rig["roof"], space.center_of(index), space.interval)
    ap = average_precision(m, kinds.PerceptionModel().lidar).reshape(space.shape)
    found = sight.Sight(space, prior).expected_ap(rig)
    for density in prior.densities(space):
        p = density.ground[:, :, None] * density.profile
        assert found[density.name] == pytest.approx((p * ap).sum() / p.sum(), abs=0.005)
    assert set(found) == set(prior.class_names)
