"""Algorithm 1: schedule, bounds, seeds, and that it finds what it should."""

import math
from itertools import pairwise

import pytest

import pe_core as pe
from tests.engine import shapes

SPACE = shapes.small_space()


def evaluator():
    return pe.Evaluator(SPACE, pe.Prior.road(), shapes.box_car(), samples=1024)


def start(**options):
    return pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180), **options)])


def short(candidates=10):
    return pe.Schedule(candidates=candidates)


def test_the_paper_s_schedule_has_seven_rounds():
    scales = pe.Schedule().scales
    assert scales == [2.0**-k for k in range(7)]
    assert scales[-1] / 2 * 1.0 <= 0.01 and scales[-1] / 2 * 30.0 <= 0.3


def test_the_same_seed_gives_the_same_steps_and_another_does_not():
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car())

    def run(seed):
        steps = pe.optimize(evaluator(), start(), space, seed, short(), method="random")
        return [(s.entropy, s.best.sensors[0].pose) for s in steps]

    assert run(1) == run(1)
    assert run(1) != run(2)


def test_entropy_never_rises_and_the_count_is_exact():
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car())
    steps = list(pe.optimize(evaluator(), start(), space, 0, short(), method="random"))
    assert len(steps) == 71
    assert [s.evaluations for s in steps] == list(range(1, 72))
    assert steps[-1].fraction == 1.0
    entropies = [s.entropy for s in steps]
    assert entropies == sorted(entropies, reverse=True)
    assert entropies[-1] < entropies[0]
    improved = [b.entropy < a.entropy for a, b in pairwise(steps)]
    assert improved == [s.improved for s in steps[1:]]
    assert steps[-1].entropy == evaluator().entropy(steps[-1].best)


def test_fixed_axes_stay_and_bounds_hold():
    limits = {"roof": {"x": (-0.5, 0.0), "pitch": (math.radians(-1), math.radians(2))}}
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car(), ("x", "pitch"), limits)
    for step in pe.optimize(evaluator(), start(), space, 3, short(20), method="random"):
        pose = step.best.sensors[0].pose
        assert -0.5 <= pose.position[0] <= 0.0
        assert pose.position[1:] == (0.0, 1.8)
        roll, pitch, yaw = pose.rotation_deg
        assert (roll, yaw) == (0.0, 0.0) and -1 <= pitch <= 2


def test_placements_are_rounded_so_that_files_hold_them():
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car())
    *_, last = pe.optimize(evaluator(), start(), space, 0, short(), method="random")
    pose = last.best.sensors[0].pose
    assert pose.position == tuple(round(v, 5) for v in pose.position)
    assert pose.rotation_deg == tuple(round(v, 4) for v in pose.rotation_deg)


def test_default_bounds_are_the_vehicle_s_outline_and_some_headroom():
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car())
    bounds = space.bounds["roof"]
    assert set(bounds) == {"x", "y", "z", "pitch"}
    assert bounds["x"] == (-2.3, 2.3)
    assert bounds["z"] == pytest.approx((0.2, 1.4 + 0.75))
    outside = pe.SearchSpace.on_vehicle(start(position=(3.0, 0.0, 3.0)), shapes.box_car())
    assert outside.bounds["roof"]["x"] == (-2.3, 3.0)


def test_the_roof_is_found_unprompted():
    """From below the roof, where the body hides everything, the search climbs out of the car."""
    rig = start(position=(-0.3, 0.1, 1.1))
    space = pe.SearchSpace.on_vehicle(rig, shapes.box_car(), ("z",))
    *_, last = pe.optimize(evaluator(), rig, space, 0, short(30), method="random")
    assert last.best.sensors[0].pose.position[2] > 1.4


def test_nothing_free_is_one_step():
    space = pe.SearchSpace.on_vehicle(start(), shapes.box_car(), ())
    assert len(list(pe.optimize(evaluator(), start(), space, 0, short(), method="random"))) == 1


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"roof": {"x": (1.0, 2.0)}}, "bounds around the start, -0.43 m, found 1 m to 2 m"),
        ({"roof": {"tilt": (0.0, 1.0)}}, "'tilt'"),
        ({"mast": {"x": (0.0, 1.0)}}, "'mast'"),
    ],
)
def test_impossible_search_spaces_are_refused(bounds, message):
    if "tilt" in bounds.get("roof", {}):
        with pytest.raises(pe.InputError, match=message):
            pe.SearchSpace(bounds).checked(start())
        return
    with pytest.raises(pe.InputError, match=message):
        next(pe.optimize(evaluator(), start(), pe.SearchSpace(bounds), 0, short(), method="random"))
