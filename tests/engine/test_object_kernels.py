"""What measures objects again and again is held to the definition, to the last beam and bit."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import sensors as kinds
from tests.engine import shapes
from tests.engine.test_object_oracle import CAMERAS, VIEWS, random_objects

ELEVATIONS = np.radians(np.linspace(-25.0, 15.0, 20))
SPREAD = np.linspace(-4.0, 4.0, 20)
LIDARS = {
    "regular": pe.Lidar("regular", ELEVATIONS, 150, 60.0),
    "more than a word": pe.Lidar("tall", np.radians(np.linspace(-30.0, 20.0, 70)), 90, 60.0),
    "fans": pe.Lidar("fans", ELEVATIONS, 150, 60.0, np.radians(np.round(SPREAD))),
    "a fan a channel": pe.Lidar("many", ELEVATIONS, 150, 60.0, np.radians(SPREAD)),
    "limited": pe.Lidar("limited", ELEVATIONS, 150, 60.0, None, (-1.0, 0.8)),
    "ranged": pe.Lidar("ranged", ELEVATIONS, 150, 15.0, min_range=6.0),
    "steep": pe.Lidar("steep", np.radians([-90.0, -80.0, -30.0, 0.0, 89.5]), 60, 60.0),
    "a pattern": pe.Lidar.from_directions(
        "pattern", np.random.default_rng(3).normal((2, 0, -0.2), (1, 1, 0.3), (1500, 3)), 60.0
    ),
}


def round_objects(rng):
    """Boxes of round measures at round places along the axes: faces in line with the sensor."""
    some = random_objects(rng, 40, 10, nearest=1.0, farthest=20.0)
    centers, sizes = (np.round(w * 2.0) / 2.0 for w in (some.centers, some.sizes))
    yaws = np.round(some.yaws * 2.0 / math.pi) * math.pi / 2.0
    centers[:, 2] = np.maximum(centers[:, 2], 0.5)
    names = some.class_names
    return pe.Objects(centers, np.maximum(sizes, 0.5), yaws, some.labels, names, some.scenes)


def places(rng):
    """Sensors upright at a free and at a round place, and tilted, and what is round them."""
    free = pe.Pose.from_degrees(rng.uniform((-3, -2, 1.6), (3, 2, 2.5)), (0, 0, 37.3))
    yield free, random_objects(rng, 60, 15, nearest=4.0, farthest=25.0)
    whole = np.round(rng.uniform((-3, -2, 1.6), (3, 2, 2.5)) * 2.0) / 2.0
    yield pe.Pose.from_degrees(whole, (0, 0, 90)), round_objects(rng)
    tilted = pe.Pose.from_degrees((0.3, 0.2, 1.9), rng.uniform(-1, 1, 3) * (20, 20, 180))
    yield tilted, random_objects(rng, 60, 15, nearest=4.0, farthest=25.0)


def measured(sensor, objects, vehicle, traffic):
    """By the kernel, after it has seen the sensor elsewhere."""
    kernel = kinds.kind_of(sensor).on_objects(kinds.ObjectView(objects, vehicle, traffic))
    kernel.measure(sensor.moved(pe.Pose((0.0, 0.0, 2.0))))
    return kernel.measure(sensor)


@pytest.mark.parametrize("name", LIDARS)
def test_a_lidar_s_kernel_counts_what_the_definition_does(name):
    rng = np.random.default_rng(sorted(LIDARS).index(name))
    for pose, objects in places(rng):
        sensor, found = pe.Sensor("s", LIDARS[name], pose), []
        for on_car, traffic in VIEWS.values():
            vehicle = shapes.box_car() if on_car else None
            counts = measured(sensor, objects, vehicle, traffic)
            assert counts.tolist() == pe.measure_objects(sensor, objects, vehicle, traffic).tolist()
            found.append(counts.sum())
        assert found[0] > found[3] > 0  # something hides something


TILTS = ((0, 3, 0), (0, 90, 0), (90, 0, 0), (180, 0, 0), (0, -30, 90), (0, 1e-7, 0), (1e-4, 0, 45))


@pytest.mark.parametrize("rotation", TILTS)
def test_a_tilted_lidar_at_round_angles_among_round_objects(rotation):
    """Sides then run along planes of channels, or nearly."""
    objects = round_objects(np.random.default_rng(11))
    pose = pe.Pose.from_degrees((0.5, -1.0, 2.0), rotation)
    sensor = pe.Sensor("s", LIDARS["regular"], pose)
    for vehicle in (None, shapes.box_car()):
        counts = measured(sensor, objects, vehicle, False)
        assert counts.tolist() == pe.measure_objects(sensor, objects, vehicle).tolist()
    assert np.count_nonzero(counts) > 5


def test_a_sensor_over_and_in_objects_of_a_scene():
    """Such scenes are compared beam by beam, the others are not."""
    some = random_objects(np.random.default_rng(4), 40, 10, nearest=4.0, farthest=25.0)
    centers, sizes = some.centers.copy(), some.sizes.copy()
    centers[[3, 20]] = (0.0, 0.0, 0.5), (0.1, 0.0, 1.5)
    sizes[[3, 20]] = (4.0, 2.0, 1.0), (1.0, 1.0, 2.0)
    objects = pe.Objects(centers, sizes, some.yaws, some.labels, some.class_names, some.scenes)
    sensor = pe.Sensor("s", LIDARS["regular"], pe.Pose((0.0, 0.0, 1.5)))
    for traffic in (False, True):
        counts = measured(sensor, objects, None, traffic)
        assert counts.tolist() == pe.measure_objects(sensor, objects, None, traffic).tolist()
    assert counts[20] == sensor.model.beam_count
    assert counts[3] > 0 or objects.scenes[3] == objects.scenes[20]


def test_the_paper_s_lidar_on_a_few_hundred_objects():
    """As many channels and azimuths as the benchmarks have; nearly all of it by runs."""
    some = random_objects(np.random.default_rng(6), 60, 20, nearest=5.0, farthest=90.0)
    sensor = shapes.lidar_on_roof(rotation=(0.0, 0.0, 10.01))
    for traffic in (False, True):
        counts = measured(sensor, some, shapes.box_car(), traffic)
        expected = pe.measure_objects(sensor, some, shapes.box_car(), traffic)
        assert counts.tolist() == expected.tolist()


@pytest.mark.parametrize("name", [*CAMERAS, "ranged"])
def test_a_camera_s_kernel_measures_what_the_definition_does(name):
    """To the bit, level and tilted, low over the car so that it hides much."""
    ranged = pe.Camera("ranged", 200, 130, math.radians(60.0), None, 8.0, 20.0)
    camera, rng = CAMERAS.get(name, ranged), np.random.default_rng(8)
    hiding = 0
    for rotation in ((0.0, 0.0, 10.0), (5.0, 15.0, 130.0), (-20.0, 30.0, 250.0)):
        sensor = pe.Sensor("s", camera, pe.Pose.from_degrees((-0.3, 0.1, 1.45), rotation))
        some = random_objects(rng, 80, 20, nearest=5.0, farthest=25.0)
        found = []
        for on_car, traffic in VIEWS.values():
            vehicle = shapes.box_car() if on_car else None
            m = measured(sensor, some, vehicle, traffic)
            assert m.tolist() == pe.measure_objects(sensor, some, vehicle, traffic).tolist()
            found.append(m.sum())
        assert found[0] > found[1] > 0
        hiding += found[2] < found[0]
    assert hiding
