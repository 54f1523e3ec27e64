"""Views of radars and ultrasonic sensors, held to rays of their own: rays, ego masks, solids."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.sensors import kind_of
from pe_core.sensors.field_of_view import FREE
from pe_tools.outputs.solid import free_solid, mounted_view, whole_solid
from tests.engine import shapes

ARS, PARKING = "Continental ARS408-21", "Parking module 2.5 m"
POSE = pe.Pose.from_degrees((1.0, 1.0, 0.7), (0, 4, -20))
CAR = shapes.box_car()
COVERED = replace(CAR, covers={"cabin": 1.0, "body": 2.0})


def mounted(name):
    return pe.Sensor("one", catalog.load(name), POSE)


def local(sensor, directions):
    """Azimuths and elevations (N,) of directions, by dot products with the sensor's axes."""
    ahead, left, up = (directions @ axis for axis in sensor.pose.ground_from_sensor.T)
    return np.arctan2(left, ahead), np.arcsin(np.clip(up, -1.0, 1.0))


@pytest.mark.parametrize("name", [ARS, PARKING])
def test_rays_are_in_the_field_and_fill_it(name):
    sensor = mounted(name)
    rays = kind_of(sensor).rays(sensor, 300)
    assert 200 < len(rays) <= 300
    azimuth, elevation = local(sensor, rays)
    (left, right), (low, high) = sensor.model.window
    assert (azimuth > left).all() and (azimuth < right).all()
    assert (elevation > low).all() and (elevation < high).all()
    assert azimuth.max() > 0.8 * right and elevation.max() > 0.7 * high
    if name == PARKING:
        assert ((azimuth / right) ** 2 + (elevation / high) ** 2 <= 1.0 + 1e-9).all()


@pytest.mark.parametrize("name", [ARS, PARKING])
def test_an_ego_mask_is_that_of_single_rays(name):
    sensor = mounted(name)
    mask = kind_of(sensor).ego_mask(sensor, CAR)
    up, across = np.meshgrid(mask.elevations, mask.azimuths, indexing="ij")
    flat = [np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)]
    rays = np.stack(flat, axis=-1).reshape(-1, 3) @ sensor.pose.ground_from_sensor.T
    faces = CAR.first_hit(sensor.pose.position, rays).face
    expected = np.where(faces >= 0, np.asarray(CAR.parts)[faces], FREE).reshape(up.shape)
    np.testing.assert_array_equal(mask.parts, expected)
    assert 0.02 < (mask.parts >= 0).mean() < 0.98


def test_covers_let_radars_through_and_stop_sound():
    """In the mask, in the solid and in the lines alike."""
    radar, sonar = mounted(ARS), mounted(PARKING)
    assert (kind_of(radar).ego_mask(radar, COVERED).parts == FREE).all()
    assert (kind_of(sonar).ego_mask(sonar, COVERED).parts >= 0).any()
    for sensor, is_free in ((radar, True), (sonar, False)):
        view = mounted_view(sensor, COVERED, 5.0, math.radians(3.0))
        shares = free_solid("free", view).volume / whole_solid("whole", view).volume
        assert (shares == pytest.approx(1.0)) == is_free
        plain = mounted_view(sensor, CAR, 5.0, math.radians(3.0))
        assert free_solid("free", plain).volume < 0.95 * whole_solid("whole", plain).volume
