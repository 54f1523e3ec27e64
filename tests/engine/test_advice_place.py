"""Ask a place: m as it is defined, what hides it, and why a sensor misses it."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import average_precision, entropy_of, late_fusion, precision_of
from pe_tools import advice
from pe_tools.verify import oracle
from tests.engine import shapes
from tests.thorough import tries

SPACE = pe.PerceptionSpace((-20, 20), (-10, 10), (0, 5), 0.5)


def one_beam(position=(0.0, 0.0, 1.25), elevations=(0.0,), max_range=15.0, **options):
    """A LiDAR of few channels, a beam a degree."""
    model = pe.Lidar("beam", np.radians(elevations), 360, max_range, **options)
    return pe.Sensor("beam", model, pe.Pose(position))


def ask(sensors, point, vehicle=None, space=SPACE):
    return advice.ask_place(pe.Rig(sensors), space, pe.Prior.uniform(), vehicle, point=point)


def test_one_beam_by_hand():
    """A cube from y = -0.5 to 0 at x = 10 takes the beams at -1 and -2 degrees (y = -0.35).

    That at -3 passes at -0.52; that at 0 runs along a face which belongs to the next cube.
    """
    place = ask([one_beam()], (10.1, -0.1, 1.25))
    assert place.center == (10.25, -0.25, 1.25)
    own = place.sensors[0]
    assert (own.m, own.unhidden, own.reason, own.occluded_by) == (2.0, 2.0, "sees", None)
    assert own.ap == pytest.approx(0.152 * math.log(2) + 0.659)
    assert place.ap == pytest.approx(own.ap) and place.seen and not place.in_vehicle
    assert place.entropy == pytest.approx(2 * math.log(1 / own.ap - 1) + 1 + math.log(2 * math.pi))
    assert place.density == pytest.approx(1.0)
    assert place.text == (
        "10.25 m ahead, 0.25 m right, 1.25 m up: seen by 1 of 1 sensor; together AP 0.76, "
        "H 0.48 nats",
        "objects are as likely here as on average",
        "beam: sees it with 2 beams, AP 0.76",
    )


TWO_CHANNELS = one_beam(elevations=(0.0, 6.0))
AHEAD = one_beam(horizontal_fov=(math.radians(-30), math.radians(30)), max_range=20.0)
REASONS = [
    (TWO_CHANNELS, (10, 0, 1.25), "sees"),
    (TWO_CHANNELS, (15.9, 0, 1.25), "out of range"),  # the cube begins at 15.5 m
    (TWO_CHANNELS, (15.2, 9.9, 1.25), "out of range"),
    (TWO_CHANNELS, (10, 0, 4.0), "out of view"),  # 15 degrees up
    (TWO_CHANNELS, (10, 0, 1.7), "between beams"),  # 2 degrees: between the channels at 0 and 6
    (TWO_CHANNELS, (-0.2, 0, 3.0), "out of view"),  # over the LiDAR
    (AHEAD, (5, 5, 1.25), "out of view"),
    (AHEAD, (-5, 0, 1.25), "out of view"),
    (AHEAD, (12.6, 8.3, 1.25), "out of view"),  # 32.9 degrees, and 1.6 to its corners
    (AHEAD, (12.6, -8.3, 1.25), "out of view"),
    (AHEAD, (12.6, 7.8, 1.25), "sees"),  # 31.3 degrees: its corner reaches in
]


def test_why_a_lidar_misses_a_place():
    found = [ask([sensor], point).sensors[0] for sensor, point, _ in REASONS]
    assert [own.reason for own in found] == [reason for _, _, reason in REASONS]
    assert all((own.m > 0) == (own.reason == "sees") for own in found)
    assert {own.occluded_by for own in found} == {None}


def test_in_the_vehicle_nothing_counts():
    place = ask([one_beam()], (0, 0, 0.2), shapes.box_car())
    assert place.in_vehicle and place.density == 0.0
    assert not ask([one_beam()], (0, 0, 1.6), shapes.box_car()).in_vehicle  # over the roof, 1.4 m


def test_density_is_relative_to_the_mean():
    """Twice as much ahead of x = 0: 4/3 there, 2/3 behind."""
    prior = pe.Prior.uniform([pe.Focus(2.0, x=(0.0, math.inf))])
    rig = pe.Rig([one_beam()])
    ahead, behind = (
        advice.ask_place(rig, SPACE, prior, vehicle=None, point=(x, 0)) for x in (5, -5)
    )
    assert ahead.density == pytest.approx(4 / 3) and behind.density == pytest.approx(2 / 3)


def random_rig(rng):
    """Two LiDARs and two cameras on and round the car, some of them tilted."""
    sensors = []
    for k in range(4):
        position = rng.uniform((-2.5, -1.2, 0.3), (2.5, 1.2, 2.0))
        rotation = (*rng.uniform(-20, 20, 2), rng.uniform(-180, 180))
        if k < 2:
            model = shapes.small_lidar(16, 720, max_range=18.0)
            sensors.append(shapes.lidar_on_roof(model, position, rotation, f"lidar {k}"))
        else:
            sensors.append(shapes.camera(80.0, position, rotation, f"camera {k}"))
    return pe.Rig(sensors)


@pytest.mark.parametrize("seed", range(tries(3, 6)))
def test_m_is_the_definition_s_and_ap_and_h_are_the_equations(seed):
    rng = np.random.default_rng(seed)
    car = shapes.box_car()
    model = pe.PerceptionModel()
    rig = random_rig(rng)
    for point in rng.uniform((-19, -9, 0), (19, 9, 4), (12, 3)):
        place = advice.ask_place(rig, SPACE, pe.Prior.road(), car, point=point)
        center = np.array([place.center])
        precisions = {}
        assert np.abs(center - point).max() <= SPACE.interval / 2 + 1e-9
        for sensor, own in zip(rig, place.sensors, strict=True):
            assert own.m == pe.measure(sensor, center, SPACE.interval, car)[0]
            assert own.unhidden == pe.measure(sensor, center, SPACE.interval)[0]
            assert own.ap == average_precision(own.m, model.curve(own.kind))
            assert (own.reason == "sees") == (own.m > 0)
            assert (own.reason == "occluded") == (own.m == 0 < own.unhidden)
            precisions[sensor.group] = precisions.get(sensor.group, 0.0) + own.m
        fused = late_fusion(
            [precision_of(m, model.curve(rig.groups[g][0].kind)) for g, m in precisions.items()]
        )
        assert place.entropy == pytest.approx(float(entropy_of(fused)), abs=1e-8)
        assert place.ap == pytest.approx(1 / (1 + float(fused) ** -0.5), abs=1e-8)


def test_what_hides_from_a_camera_is_what_brute_force_meets():
    car = shapes.box_car()
    rng = np.random.default_rng(1)
    tried = 0
    for _ in range(80):
        point = rng.uniform((-9, -9, 0), (9, 9, 1))
        position = rng.uniform((-2, -1, 1.5), (2, 1, 2))
        yaw = math.degrees(math.atan2(point[1] - position[1], point[0] - position[0]))
        place = ask([shapes.camera(90.0, position, (0, 20, yaw))], point, car)
        if place.sensors[0].reason == "occluded":
            ray = np.array(place.center) - position
            ray = ray[None] / np.linalg.norm(ray)
            (face,) = oracle.first_hits(position, ray, car.triangles)[1]
            assert place.sensors[0].occluded_by == car.part_names[car.parts[face]]
            tried += 1
    assert tried > 10


def test_what_hides_from_a_lidar_is_what_most_of_its_beams_meet():
    car = shapes.box_car()
    rng = np.random.default_rng(2)
    tried = 0
    for _ in range(40):
        point = rng.uniform((-6, -6, 0), (6, 6, 1))
        position = rng.uniform((-2, -1, 1.5), (2, 1, 2))
        sensor = shapes.lidar_on_roof(shapes.small_lidar(16, 180), position)
        place = ask([sensor], point, car)
        if place.sensors[0].reason == "occluded":
            count = np.zeros(2)
            for beam in beams_near(sensor, place.center):
                if pe.measure(one_way(sensor, beam), [place.center], SPACE.interval)[0]:
                    (face,) = oracle.first_hits(position, beam[None], car.triangles)[1]
                    count[car.parts[face]] += 1
            assert place.sensors[0].occluded_by == car.part_names[int(np.argmax(count))]
            tried += 1
    assert tried > 3


def beams_near(sensor, center):
    """Beams that pass the voxel's centre within its circumscribed sphere: no other may meet it."""
    offset = np.array(center) - sensor.pose.position
    beams = sensor.model.directions
    aside = np.linalg.norm(np.cross(beams, offset), axis=1)
    return beams[(aside <= SPACE.interval * math.sqrt(3.0) / 2.0 + 1e-9) & (beams @ offset > -0.5)]


def one_way(sensor, beam):
    """A LiDAR of one of a sensor's beams."""
    model = pe.Lidar.from_directions("one", beam[None], sensor.model.max_range)
    return pe.Sensor("one", model, sensor.pose)
