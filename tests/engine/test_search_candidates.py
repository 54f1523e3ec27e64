"""Every candidate of Algorithm 1, as an evaluator that records them saw it."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.search import pose_values
from tests.engine import shapes
from tests.engine.recording import Recorder, distance_to, flat

METRES = (1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625)
DEGREES = (30.0, 15.0, 7.5, 3.75, 1.875, 0.9375, 0.46875)
"""Half widths of the paper's neighbourhoods, round by round: the next, 0.0078125 m and 0.234375
degrees, would be at or below its 0.01 m and 0.3 degrees."""
ROUNDED_M = 0.5e-5
ROUNDED_DEG = 0.5e-4
"""What rounding a placement to 0.01 mm and 0.0001 degrees may add."""
AXES = ("x", "y", "z", "roll", "pitch", "yaw")
WIDE = dict.fromkeys("xyz", (-50.0, 50.0)) | dict.fromkeys(("roll", "pitch", "yaw"), (-9.0, 9.0))
START = pe.Pose.from_degrees((0.3, -0.2, 1.9), (2.0, -3.0, 40.0))


def rig_of(names):
    model = shapes.small_lidar(2, 4)
    return pe.Rig([pe.Sensor(name, model, START) for name in names])


def searched(landscape, bounds, rig=None, seed=0, **schedule):
    """The recorder and the steps of a whole search."""
    recorder = Recorder(landscape)
    schedule = pe.Schedule(**({"candidates": 40} | schedule))
    rig = rig or rig_of(bounds)
    steps = list(
        pe.optimize(recorder, rig, pe.SearchSpace(bounds), seed, schedule=schedule, method="random")
    )
    return recorder, steps


def rounds_of(steps):
    """Positions in the list of steps by round; the start, which is none's, left out."""
    numbers = np.array([s.round for s in steps[1:]])
    return [1 + np.flatnonzero(numbers == number) for number in range(numbers.max() + 1)]


def moves(recorder, steps, sensor, axis):
    """By round, how far each candidate is from the best placement before it [m or degrees]."""
    values = np.array(recorder.of(sensor)[axis])
    factor = 1.0 if axis in "xyz" else 180.0 / math.pi
    centers = [pose_values(s.best[sensor].pose)[axis] for s in steps]
    return [(values[some] - centers[some[0] - 1]) * factor for some in rounds_of(steps)]


def test_a_round_s_centre_stays_while_better_placements_are_found_in_it():
    """Downhill without end along x: the best runs away, the neighbourhood waits for the next round.

    Round the running best, a candidate could be more than 1 m from where the round began.
    """
    recorder, steps = searched(lambda rig: -rig["a"].pose.position[0], {"a": {"x": (-50.0, 50.0)}})
    first = rounds_of(steps)[0]
    assert sum(steps[i].improved for i in first) > 2
    for some, width in zip(moves(recorder, steps, "a", "x"), METRES, strict=True):
        assert np.abs(some).max() <= width + ROUNDED_M
    # what all rounds together allow: from 0.3 m, all their half widths
    assert 0.3 + 1.5 < steps[-1].best["a"].pose.position[0] <= 0.3 + sum(METRES) + 7 * ROUNDED_M


def test_candidates_are_the_documented_stream_of_uniform_numbers():
    """One number in [-1, 1) a free axis, sensors in the rig's order, axes in the order of AXES."""
    bounds = {"b": {"yaw": (-9.0, 9.0), "z": (0.0, 9.0)}, "a": {"pitch": (-9.0, 9.0)}}
    rig = rig_of(["a", "fixed", "b"])
    recorder, steps = searched(flat, bounds, rig, seed=5, candidates=20)
    rng = np.random.default_rng(5)
    roll, pitch, yaw = START.rotation_deg
    for number, (metres, degrees) in enumerate(zip(METRES, DEGREES, strict=True)):
        for k in range(1 + 20 * number, 21 + 20 * number):
            first, second, third = (rng.uniform(-1.0, 1.0) for _ in range(3))
            own = recorder.rigs[k]
            assert own["a"].pose.position == START.position
            assert own["a"].pose.rotation_deg == pytest.approx(
                (roll, pitch + degrees * first, yaw), abs=ROUNDED_DEG * 1.001
            )
            assert own["b"].pose.position == pytest.approx(
                (0.3, -0.2, 1.9 + metres * second), abs=ROUNDED_M * 1.001
            )
            assert own["b"].pose.rotation_deg == pytest.approx(
                (roll, pitch, yaw + degrees * third), abs=ROUNDED_DEG * 1.001
            )
            assert own["fixed"] is rig["fixed"]
    assert len(steps) == len(recorder.rigs) == 141


def test_coordinates_are_clipped_to_their_bounds():
    """x from 0.3 may go 0.25 m up and 0.5 m down: of the first round's draws within 1 m, 3 in 8
    are held at the upper bound and 2 in 8 at the lower."""
    bounds = {"a": {"x": (-0.2, 0.55), "pitch": (math.radians(-9.0), math.radians(12.0))}}
    recorder, _ = searched(flat, bounds, candidates=4000)
    x = np.array(recorder.of("a")["x"])
    assert (x.min(), x.max()) == (-0.2, 0.55)
    first = x[1:4001]
    assert (first == 0.55).mean() == pytest.approx(3 / 8, abs=0.03)
    assert (first == -0.2).mean() == pytest.approx(2 / 8, abs=0.03)
    pitch = np.degrees(recorder.of("a")["pitch"])[1:4001]
    assert (pitch.min(), pitch.max()) == pytest.approx((-9.0, 12.0), abs=1e-9)
    # from -3 degrees: 15 of the 30 upwards and 6 of the 30 downwards are inside
    assert (pitch > 11.99995).mean() == pytest.approx(15 / 60, abs=0.03)
    assert (pitch < -8.99995).mean() == pytest.approx(24 / 60, abs=0.03)


def test_a_candidate_has_to_be_below_the_best_so_far():
    recorder, steps = searched(distance_to({"x": 2.0}), {"a": WIDE})
    assert recorder.cutoff[0] == math.inf
    assert recorder.cutoff[1:] == [before.entropy for before in steps[:-1]]


def test_where_a_sensor_may_go_when_nobody_says():
    """With a vehicle its outline, from 0.2 m above ground to 0.75 m above its top; without one
    1 m from the start; angles all round, pitch from straight up to straight down."""
    rig = rig_of(["a"])
    pi = math.pi
    on_car = pe.SearchSpace.on_vehicle(rig, shapes.box_car(), AXES).bounds["a"]
    turns = {"roll": (-pi, pi), "pitch": (-pi / 2, pi / 2), "yaw": (-pi, pi)}
    car = {"x": (-2.3, 2.3), "y": (-0.9, 0.9), "z": (0.2, 2.15)}
    free = {"x": (-0.7, 1.3), "y": (-1.2, 0.8), "z": (0.9, 2.9)}
    in_the_air = pe.SearchSpace.on_vehicle(rig, None, AXES).bounds["a"]
    for axis in AXES:
        assert on_car[axis] == pytest.approx((car | turns)[axis])
        assert in_the_air[axis] == pytest.approx((free | turns)[axis])


@pytest.mark.parametrize(
    ("axis", "start", "rounding"),
    [("x", START.position[0], 0.5e-5), ("pitch", START.rpy[1], math.radians(0.5e-4))],
)
def test_a_start_may_lie_beyond_its_bounds_by_what_rounding_does(axis, start, rounding):
    """0.5 of 0.01 mm and of 0.0001 degrees: a search leaves placements there."""
    for low, high in ((start + 0.98 * rounding, 5.0), (-5.0, start - 0.98 * rounding)):
        pe.SearchSpace({"a": {axis: (low, high)}}).checked(rig_of(["a"]))
    for low, high in ((start + 1.02 * rounding, 5.0), (-5.0, start - 1.02 * rounding)):
        with pytest.raises(pe.InputError, match=f"bounds of {axis}: expected bounds around"):
            pe.SearchSpace({"a": {axis: (low, high)}}).checked(rig_of(["a"]))


@pytest.mark.parametrize(
    ("axis", "bounds", "message"),
    [
        (
            "x",
            (0.4, 2.0),
            "a: bounds of x: expected bounds around the start, 0.3 m, found 0.4 m to",
        ),
        ("x", (-2.0, 0.2), "found -2 m to 0.2 m"),
        ("pitch", (0.0, 1.0), "the start, -3 deg, found 0 deg to 57.2958 deg"),
        ("up", (0.0, 1.0), "a: .*: expected some of x, y, z, roll, pitch, yaw, found 'up'"),
    ],
)
def test_bounds_that_leave_out_the_start_are_one_line(axis, bounds, message):
    with pytest.raises(pe.InputError, match=message):
        pe.SearchSpace({"a": {axis: bounds}}).checked(rig_of(["a"]))


def test_a_sensor_that_is_not_in_the_rig_is_one_line():
    with pytest.raises(pe.InputError, match=r"search space: sensor: .* found 'mast'"):
        pe.SearchSpace({"mast": {}}).checked(rig_of(["a"]))


def on_the_car(seed=0, position=(-0.43, 0.0, 1.8), **options):
    """The steps of a short search of a LiDAR on the box car."""
    car = shapes.box_car()
    space = shapes.small_space()
    rig = pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180), position)])
    bounds = pe.SearchSpace.on_vehicle(rig, car, **options)
    evaluator = pe.Evaluator(space, pe.Prior.road(), car, samples=1024)
    schedule = pe.Schedule(10)
    return list(pe.optimize(evaluator, rig, bounds, seed, schedule=schedule, method="random"))


def test_the_roof_is_found_unprompted():
    """From below the roof, where the body hides everything, the search climbs out of the car."""
    last = on_the_car(position=(-0.3, 0.1, 1.1), free=("z",))[-1]
    assert last.best["roof"].pose.position[2] > 1.4
