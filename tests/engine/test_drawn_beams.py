"""What is drawn of sensors: beams, frustums, views of radars, colours."""

import math
from dataclasses import replace

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.sensors import kind_of
from pe_tools.graphics import beams, kinds
from pe_tools.graphics import colors as tints
from pe_tools.graphics.colors import tints_of
from pe_tools.outputs import mounted_view
from tests.engine import shapes
from tests.engine.drawn import car, mounted

ChannelMode = beams.ChannelMode
BeamChoice = beams.BeamChoice

LENGTH_M = 15.0
COLOR = np.array([0.1, 0.2, 0.3, 0.5])
# A square picture with 90 degrees: its corners stand at one along each axis, sqrt(3) away.
SQUARE = pe.Camera("square", 1000, 1000, math.pi / 2)
WIDE = pe.Camera("wide", 1920, 1080, math.radians(60))
ARS = "Continental ARS408-21"
PARKING = "Parking module 2.5 m"
POSE = pe.Pose.from_degrees((1.0, 1.0, 0.7), (0, 4, -20))
CAR = shapes.box_car()
COVERED = replace(CAR, covers={"cabin": 1.0, "body": 2.0})
KINDS = ("lidar", "camera", "radar", "ultrasonic")


@pytest.fixture
def vehicle():
    return car()


def shown(sensor, vehicle, budget, channels=ChannelMode.ALL, number=1):
    return beams.shown_beams(beams.cast(sensor, vehicle), BeamChoice(budget, channels, number))


def test_agrees_with_the_engine_beam_by_beam(vehicle):
    sensor = mounted(position=(-0.3, 0.2, 1.8), rotation=(0, 5, 30))
    found = beams.cast(sensor, vehicle)
    field = pe.beam_field(sensor, vehicle)
    np.testing.assert_array_equal(found.occluded, field.occluded_by >= 0)
    np.testing.assert_array_equal(found.ends, field.ends)
    assert found.occluded.any()


@pytest.mark.parametrize("channels", [ChannelMode.FEW, ChannelMode.EVERY, ChannelMode.ALL])
@pytest.mark.parametrize(("height", "low", "high"), [(1.9, 0.1, 0.2), (1.52, 0.5, 0.6)])
def test_the_share_of_stopped_beams_is_the_true_one(channels, height, low, high, vehicle):
    """A beam more or less: well above the roof's corner, and right on it."""
    sensor = mounted(position=(1.9, 0.9, height), rotation=(0, 10, 30))
    field = pe.beam_field(sensor, vehicle)
    true = (field.occluded_by >= 0).mean()
    assert low < true < high
    found = shown(sensor, vehicle, budget=300, channels=channels, number=2)
    assert found.share == pytest.approx(true)
    assert abs(found.occluded.sum() - true * len(found.ends)) <= 1.0


def free_lines(sensor, found, vehicle=None):
    around = None if vehicle is None else vehicle.bounds
    lines = beams.free_lines(
        sensor, found, LENGTH_M, np.tile(COLOR, (len(found.ends), 1)), around=around
    )
    return lines.points.reshape(-1, 4, 3), lines.colors.reshape(-1, 4, 4)


def test_free_beams_end_at_the_ground_or_the_length(vehicle):
    sensor = mounted()
    points, _ = free_lines(sensor, shown(sensor, vehicle, 2000), vehicle)
    np.testing.assert_allclose(points[:, 0] - [0.0, 0.0, 1.9], 0.0, atol=1e-6)
    length = np.linalg.norm(points[:, 3] - points[:, 0], axis=1)
    at_ground = np.abs(points[:, 3, 2]) < 1e-5
    np.testing.assert_allclose(length[~at_ground], LENGTH_M, rtol=1e-6)
    assert at_ground.any() and (length[at_ground] < LENGTH_M).all()
    assert (points[:, 3, 2] > -1e-5).all()
    # 1.9 m down at 10 degrees: 1.9 / sin(10 deg)
    assert any(abs(length[at_ground] - 1.9 / math.sin(math.radians(10))) < 1e-4)


def test_stopped_beams_end_on_the_vehicle(vehicle):
    sensor = mounted(position=(0.0, 0.0, 2.4))
    found = shown(sensor, vehicle, 2000)
    lines = beams.occluded_lines(sensor, found, np.tile(COLOR, (len(found.ends), 1)))
    ends = lines.points.reshape(-1, 2, 3)[:, 1]
    assert len(ends) == found.occluded.sum() > 0
    np.testing.assert_allclose(ends[:, 2], 1.5, atol=1e-6)  # from above, only its roof is hit
    assert (np.abs(ends[:, 0]) <= 2.0).all() and (np.abs(ends[:, 1]) <= 1.0).all()


def rings(sensor, vehicle, rows):
    rows = np.array(rows)
    lines = beams.ground_rings(beams.cast(sensor, vehicle), rows, np.tile(COLOR, (len(rows), 1)))
    return lines.points.reshape(-1, 2, 3), lines.colors.reshape(-1, 2, 4)


def test_rings_lie_where_channels_meet_the_ground():
    points, colors = rings(mounted(), None, [2, 3])  # 10 and 25 degrees down from 1.9 m
    assert np.abs(points[..., 2]).max() < 1e-5
    radius = np.hypot(points[..., 0], points[..., 1])
    for degrees in (10.0, 25.0):
        far = 1.9 / math.tan(math.radians(degrees))
        ring = np.abs(radius - far).max(axis=1) < 1e-4
        assert ring.sum() == 360, "not closed"
        expected = COLOR[3] * (1.0 - np.hypot(far, 1.9) / beams.RING_FAR_M)
        np.testing.assert_allclose(colors[ring, :, 3], expected, rtol=1e-5)
    assert len(points) == 720


def test_frustum_corners():
    points = kinds.frustum_points(mounted(SQUARE, (1.0, 2.0, 3.0)), math.sqrt(3.0))
    expected = [(1, 2, 3), (2, 3, 4), (2, 1, 4), (2, 1, 2), (2, 3, 2)]
    np.testing.assert_allclose(points[:5], expected, atol=1e-12)
    assert (points[5:, 2] > 4.0).all()  # the mark is above the upper edge


def inside(sensor, points):
    """Whether ground points (N, 2) are in a camera's picture."""
    away = np.column_stack([points, np.zeros(len(points))]) - sensor.pose.position
    x, y, z = (away @ sensor.pose.ground_from_sensor).T
    side = math.tan(sensor.model.hfov / 2.0)
    up = side * sensor.model.height / sensor.model.width
    return (x > 0.0) & (np.abs(y) <= side * x) & (np.abs(z) <= up * x)


def in_outline(outline, points):
    """Whether points (N, 2) are inside a convex outline, counter-clockwise."""
    found = np.ones(len(points), bool)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = b - a
        to = points - a[:2]
        found &= along[0] * to[:, 1] - along[1] * to[:, 0] >= -1e-9
    return found


@pytest.mark.parametrize("rotation", [(0, 0, 0), (10, 45, -100), (0, 89, 0), (0, -5, 180)])
def test_a_footprint_is_the_ground_in_the_picture(rotation):
    """Against every place of a raster, whichever way the camera looks; the horizon included."""
    sensor = mounted(WIDE, (1.0, -0.5, 1.4), rotation)
    far_m = 12.0
    outline = kinds.footprint(sensor, far_m)
    grid = np.stack(np.meshgrid(*[np.linspace(-14.03, 13.91, 141)] * 2), axis=-1).reshape(-1, 2)
    distance = np.hypot(grid[:, 0] - 1.0, grid[:, 1] + 0.5)
    expected = inside(sensor, grid) & (distance < far_m)
    sure = np.abs(distance - far_m) > 0.02  # the circle has corners
    np.testing.assert_array_equal(in_outline(outline, grid)[sure], expected[sure])
    assert expected.any() and np.abs(outline[:, 2]).max() == 0.0


def mounted_preset(name):
    return pe.Sensor("one", catalog.load(name), POSE)


def local(sensor, directions):
    """Azimuths and elevations (N,) of directions, by dot products with the sensor's axes."""
    ahead, left, up = (directions @ axis for axis in sensor.pose.ground_from_sensor.T)
    return np.arctan2(left, ahead), np.arcsin(np.clip(up, -1.0, 1.0))


@pytest.mark.parametrize("name", [ARS, PARKING])
def test_rays_are_in_the_field_and_fill_it(name):
    sensor = mounted_preset(name)
    rays = kind_of(sensor).rays(sensor, 300)
    assert 200 < len(rays) <= 300
    azimuth, elevation = local(sensor, rays)
    (left, right), (low, high) = sensor.model.window
    assert (azimuth > left).all() and (azimuth < right).all()
    assert (elevation > low).all() and (elevation < high).all()
    assert azimuth.max() > 0.8 * right and elevation.max() > 0.7 * high
    if name == PARKING:
        assert ((azimuth / right) ** 2 + (elevation / high) ** 2 <= 1.0 + 1e-9).all()


def test_covers_let_radars_through_and_stop_sound():
    radar = mounted_preset(ARS)
    sonar = mounted_preset(PARKING)
    for sensor, is_free in ((radar, True), (sonar, False)):
        view = mounted_view(sensor, COVERED, 5.0, math.radians(3.0))
        assert (view.ends == 5.0).all() == is_free
        plain = mounted_view(sensor, CAR, 5.0, math.radians(3.0))
        assert (plain.ends < 5.0).any()


def rig_of(counts):
    """Sensors without a colour of their own, so many of each kind."""
    models = [catalog.load(catalog.names(kind)[0]) for kind in KINDS]
    return [
        pe.Sensor(f"{kind} {k}", model)
        for kind, model, count in zip(KINDS, models, counts, strict=False)
        for k in range(count)
    ]


def test_own_colours_are_kept_and_not_given_to_others():
    first, second, third = rig_of((3,))
    tint = tints_of("lidar")
    taken = replace(second, color=tint[0])
    colors = tints.sensor_colors([first, taken, third])
    rgb = tints.rgb_of
    assert colors == {first.name: rgb(tint[1]), taken.name: rgb(tint[0]), third.name: rgb(tint[2])}
    own = replace(third, color="#012345")
    assert tints.sensor_colors([own, taken])[own.name] == rgb("#012345")
    assert tints.color_text(rgb("#012345")) == "#012345"
    for wrong in ("red", "#12345", "#GG0000", "#ABCDEF", 7):
        with pytest.raises(pe.InputError, match="color: expected a colour such as"):
            replace(first, color=wrong)
