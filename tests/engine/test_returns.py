"""Beams that return as on the road: by hand, kernels against the definition, one door for all."""

from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scene.objects import Objects
from pe_core.scoring.targets import TargetRule
from pe_core.sensors import ObjectMeasurementCache
from pe_core.sensors.boxes import BodyParts
from pe_core.sensors.lidar.definition import count_beams, count_on_objects, count_on_parts
from pe_core.sensors.lidar.returns import ANY, SPREAD, SURFACES, return_probability
from pe_core.sensors.weather import Weather, with_returns

PUCK = catalog.load("Velodyne VLP-16 Puck")
UPRIGHT = (0.0, 0.0, 0.2)
TILTED = (0.04, -0.03, 0.5)
SMALL = pe.PerceptionSpace((-4.0, 8.0), (-4.0, 4.0), (0.0, 2.0), 0.5)


def lidars(returns, *rotations):
    sensors = [
        pe.Sensor(f"lidar {k}", PUCK, pe.Pose((0.1 + k, 0.2, 1.3), rpy))
        for k, rpy in enumerate(rotations)
    ]
    return with_returns(pe.Rig(sensors), returns)


def boxes(*distances, names=("car", "pedestrian"), labels=None):
    count = len(distances)
    centers = [(d, 0.0, 0.9) for d in distances]
    labels = np.zeros(count, int) if labels is None else labels
    sizes = [(0.5, 2.0, 1.8)] * count
    scenes = np.zeros(count, int)
    return Objects(
        np.array(centers),
        np.array(sizes),
        np.zeros(count),
        labels,
        class_names=names,
        scenes=scenes,
    )


def measured(objects, rig, traffic=True):
    return ObjectMeasurementCache(objects, None, traffic).measure(rig)["lidar 0"]


def test_the_share_that_returns_is_that_of_the_lidar_equation():
    distance = np.array([5.0, 56.2, 120.0])
    found = return_probability(distance, 56.2)
    exact = [NormalDist().cdf(2.0 * np.log(56.2 / d) / SPREAD) for d in distance]
    assert found == pytest.approx(exact, abs=1e-5) and found[1] == pytest.approx(0.5)


def test_an_open_body_takes_its_share_and_lets_the_rest_through():
    objects = boxes(20.0, 30.0, labels=np.array([0, 1]))
    alone = measured(objects, lidars("road", UPRIGHT), traffic=False)[1]
    behind = measured(objects, lidars("road", UPRIGHT))
    beams = measured(objects, lidars("all", UPRIGHT), traffic=False)
    fill, half = SURFACES["car"]
    expected = beams[0] * fill * return_probability(np.array([20.0]), half)[0]
    assert behind[0] == pytest.approx(expected, rel=0.02)  # hits differ in distance
    assert measured(objects, lidars("all", UPRIGHT))[1] == 0.0  # wholly behind the car
    assert behind[1] == pytest.approx((1.0 - fill) * alone, rel=1e-9)


def test_a_class_without_values_has_those_of_all():
    names = ("unheard of", "car")
    one, other = (
        measured(boxes(20.0, names=names, labels=np.array([k])), lidars("road", UPRIGHT))[0]
        for k in (0, 1)
    )
    assert SURFACES[ANY] != SURFACES["car"] and one != other


@pytest.mark.parametrize("rpy", [UPRIGHT, TILTED])
@pytest.mark.parametrize("traffic", [False, True])
def test_the_kernel_of_objects_is_the_definition(rpy, traffic):
    rig = lidars("road", rpy)
    objects = pe.ObjectEvaluator(
        pe.PerceptionSpace(), pe.Prior.road(), targets=TargetRule("objects", traffic, 16)
    ).drawn.objects
    defined = count_on_objects(rig.sensors[0], objects, None, traffic)
    assert measured(objects, rig, traffic) == pytest.approx(defined, rel=1e-9, abs=1e-9)
    assert (
        0.0
        < defined.sum()
        < count_on_objects(lidars("all", rpy).sensors[0], objects, None, traffic).sum()
    )


def test_all_voxels_and_a_sample_have_the_m_of_the_definition():
    rig = lidars("road", UPRIGHT, TILTED)
    grid = pe.Evaluator(SMALL, pe.Prior.uniform(), None, workers=1)
    centers = np.stack(
        np.meshgrid(*(SMALL.centers(a) for a in range(3)), indexing="ij"), -1
    ).reshape(-1, 3)
    m = sum(count_beams(s, centers, SMALL.interval, None) for s in rig)
    curve = pe.PerceptionModel().curve("lidar")
    precision = pe.metric.entropy.precision_of(m, curve)
    by_hand = float(np.mean(pe.metric.entropy.entropy_of(precision)))
    assert grid.entropy(rig) == pytest.approx(by_hand, abs=1e-6)
    sampled = pe.Evaluator(SMALL, pe.Prior.uniform(), None, samples=1024)
    assert sampled.entropy(rig) == pytest.approx(by_hand, abs=0.2)
    assert grid.entropy(rig) > grid.entropy(lidars("all", UPRIGHT, TILTED))


def test_cells_of_bodies_have_the_points_of_their_class():
    cells = boxes(12.0, 30.0, labels=np.array([0, 1]))
    zeros = np.zeros(2, int)
    parts = BodyParts(replace(cells, scenes=np.arange(2)), None, zeros, zeros)
    found, beams = (
        ObjectMeasurementCache(parts).measure(lidars(returns, UPRIGHT))["lidar 0"]
        for returns in ("road", "all")
    )
    sensor = lidars("road", UPRIGHT).sensors[0]
    assert found == pytest.approx(count_on_parts(sensor, parts, None)) and beams.min() > 0.0
    for k, name in enumerate(cells.class_names):
        fill, half = SURFACES[name]
        distance = np.linalg.norm(cells.centers[k] - sensor.pose.position)
        share = fill * return_probability(np.array([distance]), half)[0]
        assert found[k] == pytest.approx(beams[k] * share)


def test_weather_shortens_the_range_and_leaves_the_returns():
    study = pe.Study(lidars("all", UPRIGHT), returns="road")
    model = Weather("fog", fog_mor_m=50.0)(study.rig)[0].sensors[0].model
    assert model.returns == "road" and model.max_range < PUCK.max_range
