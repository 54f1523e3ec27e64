"""What an optimizer is told of a candidate that is no better: a lower bound of its entropy."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring import Evaluation
from pe_core.scoring.targets import ObjectEvaluator
from pe_core.search import SearchSpace
from tests.engine import shapes
from tests.thorough import tries

SPACE = shapes.small_space()
VEHICLE = pe.Vehicle(shapes.box((-2.0, -0.9, 0.2), (2.0, 0.9, 1.4)))


def sensors(rng):
    """Two LiDARs and a camera round the vehicle, some of them inside."""
    lidar, camera = shapes.small_lidar(24, 360), pe.catalog.load("Camera 60 deg")
    models = {"front": lidar, "rear": lidar, "camera": camera}
    return pe.Rig(
        [
            pe.Sensor(name, model, pe.Pose(rng.uniform((-2.5, -1, 0.5), (2.5, 1, 2)), (0, p, 0)))
            for (name, model), p in zip(models.items(), rng.uniform(-0.5, 0.5, 3), strict=True)
        ]
    )


def is_right_bound(found, exact, cutoff):
    """Check a evaluation against the entropy; return whether it is a lower bound."""
    if found.is_lower_bound:
        assert cutoff <= found.entropy <= exact
    else:
        assert found.entropy == exact
    assert (found.entropy < cutoff) == (exact < cutoff)
    return found.is_lower_bound


@pytest.mark.parametrize("blind", ["floor", "literal"])
def test_a_bound_is_one_and_is_reported_only_where_it_settles_the_matter(blind):
    rng = np.random.default_rng(5)
    model = pe.PerceptionModel(blind=blind)
    evaluator, plain = (
        pe.Evaluator(SPACE, pe.Prior.road(), VEHICLE, samples=4096, model=model) for _ in range(2)
    )
    bounds = 0
    for _ in range(10):
        rig = sensors(rng)
        exact = plain.entropy(rig)
        for cutoff in (exact - 1.0, exact - 0.01, exact, exact + 1e-6, exact + 1.0, math.inf):
            bounds += is_right_bound(evaluator.evaluate(rig, cutoff), exact, cutoff)
    assert bounds > 10


def test_after_a_bound_the_score_is_exact():
    rng = np.random.default_rng(6)
    first, second = sensors(rng), sensors(rng)
    evaluator = pe.Evaluator(SPACE, pe.Prior.road(), VEHICLE, samples=4096)
    start = evaluator.score(first).to_dict()
    assert evaluator.evaluate(second, cutoff=-10.0).is_lower_bound
    assert evaluator.score(first).to_dict() == start
    fresh = pe.Evaluator(SPACE, pe.Prior.road(), VEHICLE, samples=4096)
    assert evaluator.score(second).to_dict() == fresh.score(second).to_dict()


def test_a_search_finds_the_same_with_bounds_and_without():
    class Plain(pe.Evaluator):
        def evaluate(self, rig, cutoff):
            return Evaluation(super().entropy(rig), False)

    rig = sensors(np.random.default_rng(7))
    space = SearchSpace.on_vehicle(rig, VEHICLE)
    schedule = pe.Schedule(candidates=2)
    found = []
    for kind in (pe.Evaluator, Plain):
        evaluator = kind(SPACE, pe.Prior.road(), VEHICLE, samples=4096)
        steps = pe.optimize(evaluator, rig, space, 3, schedule, method="random")
        found.append([(s.entropy, s.improved, [b.pose for b in s.best]) for s in steps])
    assert found[0] == found[1]
    assert any(improved for _, improved, _ in found[0])


def test_a_lidar_beside_a_voxels_axis_warns_of_nothing():
    """A tilted LiDAR whose own axis runs through a sampled voxel divides by nearly nothing."""
    pose = pe.Pose((-0.34371, -0.18753, 1.58554), (0.0, -0.005813691738393112, 0.0))
    sensor = pe.Sensor("roof", pe.catalog.load("Pandar64"), pose)
    pe.Evaluator(pe.PerceptionSpace(), pe.Prior.road(), samples=32_768).entropy(pe.Rig([sensor]))


def on_objects(traffic=True, vehicle=VEHICLE, **options):
    """Score on a few scenes; every bound is tried."""
    rule = pe.TargetRule("objects", traffic, 8)
    evaluator = ObjectEvaluator(SPACE, pe.Prior.road(), vehicle, targets=rule, **options)
    evaluator._bounds_pay = lambda: True
    return evaluator


@pytest.mark.parametrize("traffic", [False, True])
@pytest.mark.parametrize("blind", ["floor", "literal"])
def test_a_bound_on_objects_is_one_and_never_rejects_what_is_better(traffic, blind):
    rng, model = np.random.default_rng(9), pe.PerceptionModel(blind=blind)
    evaluator, plain = (on_objects(traffic, model=model) for _ in range(2))
    bounds, elsewhere = 0, sensors(rng)
    for _ in range(tries(5, 10)):
        rig = sensors(rng)
        exact = plain.entropy(rig)
        for cutoff in (exact - 4.0, exact - 2.0, exact - 1.0, exact, exact + 1e-9, math.inf):
            evaluator.entropy(elsewhere)  # all sensors have moved
            bounds += is_right_bound(evaluator.evaluate(rig, cutoff), exact, cutoff)
    assert bounds > 5


def test_a_search_in_traffic_finds_the_same_with_bounds_and_without():
    class Plain(ObjectEvaluator):
        def evaluate(self, rig, cutoff=math.inf):
            return Evaluation(super().entropy(rig), False)

    rig = sensors(np.random.default_rng(7))
    space, found, bounds = SearchSpace.on_vehicle(rig, VEHICLE), [], []
    for kind in (ObjectEvaluator, Plain):
        rule = pe.TargetRule("objects", True, 8)
        evaluator = kind(SPACE, pe.Prior.road(), VEHICLE, targets=rule)
        bound_of = evaluator._lower_bound

        def noted(rig, cutoff, bound_of=bound_of):
            bounds.append((bound := bound_of(rig, cutoff)) >= cutoff)
            return bound

        evaluator._lower_bound = noted
        steps = pe.optimize(evaluator, rig, space, 3, method="random", evaluations=60)
        found.append([(s.entropy, s.improved, [b.pose for b in s.best]) for s in steps])
    assert found[0] == found[1]
    assert any(improved for _, improved, _ in found[0])
    assert any(bounds) and not all(bounds), "some candidates are settled by a bound, some are not"
