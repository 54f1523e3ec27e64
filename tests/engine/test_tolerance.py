"""Mounting errors and failures: what is drawn, what a candidate is worth, what a study says."""

import math
from itertools import combinations

import numpy as np
import pytest

import pe_core as pe
from pe_core.geometry.poses import rotate
from pe_core.search import RobustFigure
from pe_core.search.tolerance import FRESH, mounted_off, with_error
from pe_core.study.study_file import study_from_dict
from tests.engine import shapes

USUAL = pe.Tolerance(0.01, math.radians(0.3))
BOTH = pe.Tolerance(0.02, math.radians(1.0), 2, failures=True)
NOSE = (2.21663, 0.31663, 1.0947), (19.4249, -30.1023, 50.1524)
"""The first draw of the second sensor."""
ROUNDING_M = 0.51e-5
ROUNDING_RAD = math.radians(0.51e-4)
SENSOR = {"name": "roof", "model": "Pandar64", "position": [0.0, 0.0, 2.0]}
TWO = [SENSOR, SENSOR | {"name": "nose"}]


def rig():
    """Two LiDARs and a camera on the box car, the second LiDAR turned all ways."""
    model = shapes.small_lidar(8, 90)
    return pe.Rig(
        [
            shapes.lidar_on_roof(model),
            shapes.lidar_on_roof(model, (2.2, 0.3, 1.1), (20.0, -30.0, 50.0), "nose"),
            shapes.camera(),
        ]
    )


@pytest.fixture(scope="module")
def evaluator():
    space = shapes.small_space()
    return pe.Evaluator(space, pe.Prior.road(), shapes.box_car(), samples=1024)


def errors(tolerance, seed=0, start=None):
    """(draws, sensors, 6) errors of the first combination, measured from the rigs themselves."""
    start = start or rig()
    found = []
    for each in mounted_off(start, tolerance, seed)[: tolerance.draws]:
        rows = []
        for sensor, meant in zip(each, start, strict=True):
            moved = np.array(sensor.pose.position) - np.array(meant.pose.position)
            back = meant.pose.ground_from_sensor.T
            turn = rotate(back, sensor.pose.ground_from_sensor.T).T
            small = turn[2, 1], turn[0, 2], turn[1, 0]  # roll, pitch, yaw of a small turn
            rows.append([*moved, *np.arcsin(small)])
        found.append(rows)
    return np.array(found)


# --- what is drawn --------------------------------------------------------------------------------


@pytest.mark.parametrize("draws", [2, 8, 30])
def test_errors_have_a_mean_of_zero_and_the_sigma_asked_for_in_each_coordinate(draws):
    found = errors(pe.Tolerance(0.01, math.radians(0.3), draws))
    scale = np.array([0.01] * 3 + [math.radians(0.3)] * 3)
    assert np.abs(found.mean(axis=0) / scale).max() < 0.02
    assert np.abs(np.sqrt((found**2).mean(axis=0)) / scale - 1.0).max() < 0.02


def test_a_coordinate_s_errors_are_the_middles_of_equal_shares():
    found = np.sort(errors(pe.Tolerance(0.1, 0.0, 4)), axis=0)[:, :, :3]
    middles = np.array([-1.15034938, -0.31863936, 0.31863936, 1.15034938])  # of the eighths
    middles = 0.1 * middles / math.sqrt(np.mean(middles**2))
    assert np.abs(found - middles[:, None, None]).max() <= ROUNDING_M


def test_no_two_sensors_or_coordinates_have_the_same_errors():
    found = errors(pe.Tolerance(0.01, 0.01, 16)).reshape(16, -1)
    assert all(
        np.abs(found[:, a] - found[:, b]).max() > 1e-3 for a, b in combinations(range(18), 2)
    )


def test_errors_follow_from_seed_and_stream_and_from_nothing_else():
    first = mounted_off(rig(), USUAL, 5)
    assert [s.pose for r in first for s in r] == [
        s.pose for r in mounted_off(rig(), USUAL, 5) for s in r
    ]
    for seed, stream in ((6, 0), (5, FRESH)):
        assert first[0]["roof"].pose != mounted_off(rig(), USUAL, seed, stream)[0]["roof"].pose
    alone = pe.Rig([rig()["roof"]])
    poses = [r["roof"].pose for r in mounted_off(alone, USUAL, 5)]
    assert poses == [r["roof"].pose for r in first[: USUAL.draws]]


def test_errors_are_the_same_numbers_everywhere():
    pose = mounted_off(rig(), USUAL, 0)[0]["nose"].pose
    assert pose.position == NOSE[0] and pose.rotation_deg == NOSE[1]


def test_a_turn_is_in_the_sensor_s_own_frame():
    """An error of yaw turns a sensor about its own upward axis, wherever that points."""
    pose = rig()["nose"].pose
    turned = with_error(pose, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.1]))
    ahead, up = (np.stack([p.ground_from_sensor[:, k] for p in (pose, turned)]) for k in (0, 2))
    assert np.abs(up[0] - up[1]).max() <= 2 * ROUNDING_RAD
    assert ahead[0] @ ahead[1] == pytest.approx(math.cos(0.1), abs=1e-6)
    assert turned.position == pose.position and abs(turned.rpy[0] - pose.rpy[0]) > 0.01


# --- what a candidate is worth --------------------------------------------------------------------


@pytest.mark.parametrize(
    "tolerance", [BOTH, pe.Tolerance(failures=True), pe.Tolerance(0.05, draws=2, worst=True)]
)
def test_a_candidate_is_worth_the_mean_or_the_worst_of_its_cases(tolerance, evaluator):
    fresh = pe.Evaluator(evaluator.space, evaluator.prior, evaluator.vehicle, samples=1024)
    each = [fresh.entropy(case) for case in tolerance.cases(rig(), 3)]
    expected = max(each) if tolerance.worst else sum(each) / len(each)
    objective = RobustFigure(evaluator, tolerance, 3)
    assert objective(rig()) == pytest.approx(expected, abs=1e-9)


def test_failures_are_the_loss_of_each_sensor():
    lost = pe.Tolerance(failures=True).cases(rig())
    assert [[s.name for s in each] for each in lost] == [
        ["nose", "camera"],
        ["roof", "camera"],
        ["roof", "nose"],
    ]
    assert len(BOTH.cases(rig())) == 2 * 3
    assert [len(each) for each in rig().without_each()] == [2, 2, 2]


def test_a_search_minimises_what_placements_are_worth_mounted_off(evaluator):
    bounds = {"roof": {"z": (1.5, 2.2), "pitch": (-0.2, 0.2)}}
    objective = RobustFigure(evaluator, BOTH)
    schedule = pe.Schedule(4)
    *_, last = pe.optimize(
        objective, rig(), pe.SearchSpace(bounds), seed=1, schedule=schedule, method="random"
    )
    assert last.entropy == objective(last.best) < objective(rig())


# --- studies --------------------------------------------------------------------------------------


def read(sensors=TWO, **optimize):
    return study_from_dict({"sensor": sensors, "optimize": optimize}, "study.toml")


def test_failures_need_a_second_sensor():
    expected = "failures: expected a rig of at least two sensors, found one"
    with pytest.raises(pe.InputError, match=expected):
        read([SENSOR], tolerance={"failures": True})
