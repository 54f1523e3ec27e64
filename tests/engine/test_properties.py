"""What must hold for any rig: on random ones, most of them at round places, where ties are."""

from contextlib import contextmanager

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.camera.definition import NUDGE as CAMERA_NUDGE
from pe_core.sensors.lidar.definition import NUDGE as LIDAR_NUDGE
from tests.engine import kernels
from tests.engine.kernels import FLAT, every_voxel
from tests.engine.random_rigs import RIGS, free_scene, round_scene

SINGLE = 4e-6
"""Rounding of areas in single precision, relative: they go with the cube of a sum of two."""
NUDGES = (LIDAR_NUDGE, CAMERA_NUDGE)
STEPS = (-3.0, -1.0, -0.5, 0.0, 0.5, 1.0)

each_rig = pytest.mark.parametrize("number", range(RIGS))


def on_grid(scene):
    """m of every sensor, (nx, ny, nz) each, as the grid's kernels have it."""
    return [kernels.on_grid(sensor, scene.space, scene.vehicle) for sensor in scene.rig]


def on_sample(scene):
    """The same as the kernels of samples have it, asked for every voxel."""
    index = every_voxel(scene.space).index
    shape = scene.space.shape
    found = (kernels.on_sample(s, scene.space, index, scene.vehicle) for s in scene.rig)
    return [m.reshape(shape) for m in found]


def defined(scene):
    """The same by the definition."""
    centers = every_voxel(scene.space).centers
    side = scene.space.interval
    found = [pe.measure(s, centers, side, scene.vehicle) for s in scene.rig]
    return [m.reshape(scene.space.shape) for m in found]


def assert_alike(found, expected, tolerance):
    """Beams are the same, the same voxels are in view, and areas are within a tolerance."""
    lidar, *cameras = zip(found, expected, strict=True)
    assert (lidar[0] == lidar[1]).all()
    for areas, others in cameras:
        assert ((areas > 0.0) == (others > 0.0)).all()
        np.testing.assert_allclose(areas, others, rtol=tolerance)


def outside(scene):
    """Voxels above the vehicle's top. Rounding decides where a centre lies exactly on that."""
    tops = -np.inf if scene.vehicle is None else scene.vehicle.top(scene.space)[..., None]
    return scene.space.centers(2) >= tops


def entropy(scene):
    return pe.Evaluator(scene.space, pe.Prior.uniform(), scene.vehicle, workers=1).entropy(
        scene.rig
    )


@each_rig
def test_grid_and_sample_equal_the_definition(number):
    scene = round_scene(number)
    grid = on_grid(scene)
    by_definition = defined(scene)
    assert_alike(grid, by_definition, FLAT)
    assert_alike(on_sample(scene), by_definition, FLAT)


@each_rig
def test_grid_and_sample_agree_anywhere(number):
    scene = free_scene(number)
    assert_alike(on_grid(scene), on_sample(scene), FLAT)


@each_rig
def test_full_turns_change_nothing(number):
    scene = round_scene(number)
    turned = scene.turned(np.random.default_rng(number).permutation([1, -1, 2]))
    assert_alike(on_grid(turned), on_grid(scene), SINGLE)
    assert entropy(turned) == pytest.approx(entropy(scene), abs=1e-8)


@each_rig
def test_moving_everything_by_halves_of_voxels_changes_nothing(number):
    scene = round_scene(number)
    moved = scene.moved(np.random.default_rng(number).choice(STEPS, 3))
    assert_alike(on_grid(moved), on_grid(scene), SINGLE)
    if (outside(moved) == outside(scene)).all():
        assert entropy(moved) == pytest.approx(entropy(scene), abs=1e-8)


@contextmanager
def other_nudges(turned):
    """What decides ties, mirrored or turned as well: x, y, z of the nudges become others.

    A camera's aim is nudged towards the camera, on whichever side: signs are a LiDAR's alone.
    """
    before = [nudge.copy() for nudge in NUDGES]
    try:
        LIDAR_NUDGE[:] = turned(LIDAR_NUDGE)
        CAMERA_NUDGE[:] = np.abs(turned(CAMERA_NUDGE))
        yield
    finally:
        for nudge, kept in zip(NUDGES, before, strict=True):
            nudge[:] = kept


@pytest.mark.parametrize("number", range(2, RIGS, 3))
def test_round_places_mirrored_and_turned(number):
    """The mirrored and the turned map, once what decides ties is mirrored and turned as well.

    By itself it is not: a voxel owns its lower faces wherever the rig is.
    """
    scene = round_scene(number)
    found = on_grid(scene)
    with other_nudges(lambda nudge: nudge * [1, -1, 1]):
        mirrored = on_grid(scene.mirrored(nudge_too=True))
    assert_alike([m[:, ::-1] for m in mirrored], found, SINGLE)
    with other_nudges(lambda nudge: nudge[[1, 0, 2]] * [-1, 1, 1]):
        turned = on_grid(scene.quarter_turned())
    assert_alike([m[::-1].transpose(1, 0, 2) for m in turned], found, SINGLE)


@each_rig
def test_a_mirrored_rig_gives_the_mirrored_map(number):
    scene = free_scene(number)
    mirrored = scene.mirrored()
    assert_alike([m[:, ::-1] for m in on_grid(mirrored)], on_grid(scene), SINGLE)
    one, other = (
        pe.Evaluator(s.space, pe.Prior.uniform(), s.vehicle, workers=1).score(s.rig)
        for s in (scene, mirrored)
    )
    assert other.entropy == pytest.approx(one.entropy, abs=1e-6)
    assert other.coverage == pytest.approx(one.coverage, abs=1e-9)
    expected = one.ground_map.entropy[:, ::-1]
    np.testing.assert_allclose(other.ground_map.entropy, expected, atol=1e-3)
