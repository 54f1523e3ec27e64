"""LiDARs on corners, edges and faces of voxels, in exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

import pe_core as pe
from tests.engine.kernels import assert_defined, every_voxel, on_grid

SPACE = pe.PerceptionSpace((-6, 6), (-4, 4), (0, 4), 0.2)
NUDGE = np.array([21660, 33205, 54756]) / 2**40
"""By the tie rule a LiDAR stands this far above the round place where it is put, in voxels."""
PLACES = {
    "corner": (0.2, -0.4, 1.8),
    "corner, far from the origin": (5.8, 3.8, 3.6),
    "edge along x": (0.23, -0.4, 1.8),
    "edge along y": (0.2, -0.37, 1.8),
    "edge along z": (0.2, -0.4, 1.85),
    "face": (0.27, -0.33, 1.8),
    "centre": (0.3, -0.3, 1.9),
}
TURNED = [(0, 90, 0), (90, 0, 0), (90, 90, -90), (0, -90, 180), (-90, 0, 90), (30, 90, 0)]


def grazing_beams(rng, count):
    """Directions that pass the edges of a corner by a hundred-thousandth of the nudge, or less."""
    directions = NUDGE * -rng.uniform(0.1, 10.0, (count, 3))
    a, b = rng.permuted(np.tile(np.arange(3), (count, 1)), axis=1)[:, :2].T
    rows = np.arange(count)
    off = rng.uniform(-1e-5, 1e-5, count)
    directions[rows, b] = directions[rows, a] * (NUDGE[b] / NUDGE[a]) * (1.0 + off)
    return directions / np.linalg.norm(directions, axis=1)[:, None]


def around(position):
    """Indices (27, 3) of the voxel that holds a place, and of those round it."""
    here = np.floor(np.round((np.array(position) - SPACE.origin) / SPACE.interval, 6)).astype(int)
    return here + np.stack(np.unravel_index(np.arange(27), (3, 3, 3)), axis=1) - 1


def exact_count(directions, position, index):
    """Beams through a voxel, no rounding: the place is a decimal number of voxels."""
    low = []
    for k, (place, start) in enumerate(zip(position, SPACE.origin, strict=True)):
        cells = (Fraction(str(place)) - Fraction(start)) / Fraction("0.2")
        low.append(int(index[k]) - cells - Fraction(float(NUDGE[k])))
    return sum(_meets(beam, low) for beam in directions.tolist())


def _meets(beam, low):
    enter = Fraction(0)
    leave = None
    for d, near in zip(map(Fraction, beam), low, strict=True):
        t0, t1 = sorted((near / d, (near + 1) / d))
        enter = max(enter, t0)
        leave = t1 if leave is None else min(leave, t1)
    return enter < leave


@pytest.mark.parametrize("place", PLACES)
def test_no_beam_that_grazes_a_corner_goes_astray(place):
    """Definition, grid and sample, in the 27 voxels round the LiDAR, of 200 such beams each.

    Were crossing points kept to 1e-12 voxels alone, as elsewhere, a dozen would be in another
    voxel.
    """
    position = PLACES[place]
    beams = grazing_beams(np.random.default_rng(len(place)), 200)
    lidar = pe.Lidar.from_directions("grazing", beams, 50.0)
    sensor = pe.Sensor("s", lidar, pe.Pose(position))
    index = around(position)
    index = index[((index >= 0) & (index < SPACE.shape)).all(axis=1)]
    directions = pe.beam_field(sensor, None).directions
    expected = [exact_count(directions, position, own) for own in index]
    assert assert_defined(sensor, SPACE, index).tolist() == expected
    assert sum(expected) > 400


@pytest.mark.parametrize("height", [2.00831, 1.9], ids=["between centres", "on a centre"])
@pytest.mark.parametrize("rotation", [(0.0, 0.0, 12.5), (0.0, 45.0, 0.0), (45.0, 0.0, 0.0)])
def test_voxels_on_a_lidar_s_axis(rotation, height):
    """Through whose middle it runs, and which beams enter all round it."""
    lidar = pe.Lidar("steep", np.radians([-70.0, -40.0, -25.0, 0.0, 30.0, 60.0]), 120, 50.0)
    pose = pe.Pose.from_degrees((0.3, -0.3, height), rotation)
    sensor = pe.Sensor("s", lidar, pose)
    index = every_voxel(SPACE).index
    index = index[np.abs(SPACE.center_of(index) - pose.position).max(axis=1) < 0.8]
    assert assert_defined(sensor, SPACE, index).any()


@pytest.mark.parametrize("turn", TURNED)
@pytest.mark.parametrize("position", [(0.2, -0.4, 1.8), (0.3, -0.4, 1.8)], ids=["corner", "edge"])
def test_round_channels_turned_by_quarters(turn, position):
    """Their directions are such as (0.5, 0.75, 0.433): 2 : 3, and run through edges of voxels."""
    lidar = pe.Lidar("round", np.radians([-60.0, -30.0, 15.0, 30.0, 60.0]), 24, 50.0)
    sensor = pe.Sensor("s", lidar, pe.Pose.from_degrees(position, turn))
    index = every_voxel(SPACE).index
    index = index[np.abs(SPACE.center_of(index) - position).max(axis=1) < 1.7]
    expected = assert_defined(sensor, SPACE, index)
    further = pe.Pose.from_degrees(position, np.array(turn) + np.array([0, 0, 360]))
    found = on_grid(sensor.moved(further), SPACE)
    assert found[tuple(index.T)].tolist() == expected.tolist()


def test_no_direction_of_round_angles_has_the_ratio_of_two_nudges():
    """Told apart by more than a sweep's roundings add up to over the paper's 1600 planes."""
    angles, turns = (np.radians(np.arange(0.0, 91.0, step)) for step in (15.0, 30.0))
    beams = np.array(
        [(np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)) for e in angles for a in angles]
    )
    ratios = set()
    for turn in np.stack(np.meshgrid(turns, turns, turns), axis=-1).reshape(-1, 3):
        ratios |= fractions_of(np.abs(beams @ pe.Pose((0, 0, 0), tuple(turn)).ground_from_sensor.T))
    assert {Fraction(2, 3), Fraction(5, 2)} < ratios and len(ratios) > 20
    for a, b in ((0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)):
        planes = (1600, 800, 50)[a]
        for ratio in ratios:
            step = ratio * 2**40
            rounding = abs(round(step) - step) * planes / 2**40 + Fraction(2, 2**40)
            assert abs(Fraction(NUDGE[b]) - ratio * Fraction(NUDGE[a])) > rounding


def fractions_of(directions):
    """Ratios of two components that are ones of whole numbers up to 40."""
    found = set()
    for a, b in ((0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)):
        some = directions[(directions[:, a] > 1e-9) & (directions[:, b] > 1e-9)]
        for ratio in np.unique(np.round(some[:, b] / some[:, a], 12)).tolist():
            near = Fraction(ratio).limit_denominator(40)
            if abs(near - Fraction(ratio)) < 1e-11 and near.numerator <= 40:
                found.add(near)
    return found
