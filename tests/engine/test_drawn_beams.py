"""Beams and frustums shown: a fair sample that ends where beams do."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_tools.graphics import beams, colors, frustums, kinds
from tests.engine.drawn import box, car, lidar, mounted

ChannelMode, BeamChoice = beams.ChannelMode, beams.BeamChoice

LENGTH_M = 15.0


@pytest.fixture
def vehicle():
    return car()


def shown(sensor, vehicle, budget, channels=ChannelMode.ALL, number=1):
    return beams.shown_beams(beams.cast(sensor, vehicle), BeamChoice(budget, channels, number))


def elevations_of(found):
    return {round(v, 6) for v in np.degrees(np.arcsin(found.directions[:, 2]))}


@pytest.mark.parametrize("budget", [1, 4, 5, 50, 401, 3600, 10_000])
@pytest.mark.parametrize("channels", list(ChannelMode))
def test_no_more_beams_than_the_budget(budget, channels, vehicle):
    for body in (vehicle, None):
        assert 0 < len(shown(mounted(), body, budget, channels).ends) <= budget


def test_agrees_with_the_engine_beam_by_beam(vehicle):
    sensor = mounted(position=(-0.3, 0.2, 1.8), rotation=(0, 5, 30))
    found, field = beams.cast(sensor, vehicle), pe.beam_field(sensor, vehicle)
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
    found = shown(sensor, vehicle, 300, channels, 2)
    assert found.share == pytest.approx(true)
    assert abs(found.occluded.sum() - true * len(found.ends)) <= 1.0


def test_few_stopped_beams_are_neither_lost_nor_a_fan():
    """A post stops one beam in some hundreds: of 300 shown one or two are, never none."""
    post = box((2.0, -0.02, 0.5), (2.04, 0.02, 2.5))
    sensor = mounted(lidar(azimuths=7200))
    true = (pe.beam_field(sensor, post).occluded_by >= 0).mean()
    assert 0.0 < true < 0.005
    for channels in (ChannelMode.FEW, ChannelMode.ALL):
        assert 1 <= shown(sensor, post, 300, channels).occluded.sum() <= 2


def test_one_channel_shows_its_own_share(vehicle):
    """The lowest channel's, which the roof stops; not that of the whole sensor."""
    sensor = mounted(position=(0.0, 0.0, 1.6))
    lowest = shown(sensor, vehicle, 200, ChannelMode.ONE, 1)
    assert elevations_of(lowest) == {-40.0} and lowest.occluded.all() and lowest.share == 1.0
    highest = shown(sensor, vehicle, 200, ChannelMode.ONE, 5)
    assert elevations_of(highest) == {10.0} and not highest.occluded.any()
    assert elevations_of(shown(sensor, vehicle, 200, ChannelMode.ONE, 99)) == {10.0}


def test_every_nth_channel_is_counted_from_below():
    assert elevations_of(shown(mounted(), None, 60, ChannelMode.EVERY, 2)) == {-40.0, -10.0, 10.0}


def test_few_channels_are_spread_over_the_angles_not_over_their_numbers():
    """A Pandar64 has most of its channels near the horizon; the few reach from top to bottom."""
    pandar = catalog.load("Pandar64")
    found = np.degrees(
        pandar.elevations[beams.channels_of(pandar, BeamChoice(5000, ChannelMode.FEW))]
    )
    assert len(found) == beams.A_FEW
    assert (found.min(), found.max()) == pytest.approx((-25.0, 15.0))
    assert np.diff(np.sort(found)).max() < 12.0


def test_a_rosette_shows_all_over_its_picture():
    """Each beam of it is a channel: a few of those would show nothing."""
    angles = np.linspace(0.0, 20.0, 3000)
    away = np.column_stack([np.ones(3000), 0.2 * np.sin(angles), 0.2 * np.cos(7.0 * angles)])
    rosette = pe.Lidar.from_directions("rosette", away, 50.0)
    assert len(shown(mounted(rosette), None, 200, ChannelMode.FEW).ends) == 200


def test_a_preview_casts_few_beams_of_every_channel(vehicle):
    sensor = mounted(catalog.load("Pandar64"))
    found = beams.cast(sensor, vehicle, beams.PREVIEW_BEAMS)
    assert len(found.rows) == 64 and 10_000 < len(found.ends) <= beams.PREVIEW_BEAMS
    fine = beams.cast(sensor, vehicle)
    assert abs(found.occluded.mean() - fine.occluded.mean()) < 0.01


def test_buried_lidar_shows_only_stopped_beams(vehicle):
    found = shown(mounted(position=(0.0, 0.0, 0.9)), vehicle, 200)
    assert found.occluded.all() and 0 < len(found.ends) <= 200


COLOR = np.array([0.1, 0.2, 0.3, 0.5])


def free_lines(sensor, found, vehicle=None):
    around = None if vehicle is None else vehicle.bounds
    lines = beams.free_lines(sensor, found, LENGTH_M, np.tile(COLOR, (len(found.ends), 1)), around)
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


def test_free_beams_are_faint_over_the_vehicle_and_fade_beyond(vehicle):
    sensor = mounted(lidar(elevations_deg=(0,)))
    points, found = free_lines(sensor, shown(sensor, vehicle, 8), vehicle)
    ahead = points[0]  # out of the car's surroundings at its front and half a metre
    assert ahead[1, 0] == pytest.approx(2.0 + beams.SURROUNDINGS_M)
    np.testing.assert_array_equal(points[:, 1], points[:, 2])
    alpha = found[..., 3]
    assert (alpha[:, 0] < 0.2 * alpha[:, 1]).all(), "the car is hidden"
    np.testing.assert_allclose(alpha[:, 3], 0.0, atol=1e-6)
    np.testing.assert_allclose(found[..., :3], np.broadcast_to(np.float32(COLOR[:3]), (8, 4, 3)))


def test_stopped_beams_end_on_the_vehicle(vehicle):
    sensor = mounted(position=(0.0, 0.0, 2.4))
    found = shown(sensor, vehicle, 2000)
    lines = beams.occluded_lines(sensor, found, np.tile(COLOR, (len(found.ends), 1)))
    ends = lines.points.reshape(-1, 2, 3)[:, 1]
    assert len(ends) == found.occluded.sum() > 0
    np.testing.assert_allclose(ends[:, 2], 1.5, atol=1e-6)  # from above, only its roof is hit
    assert (np.abs(ends[:, 0]) <= 2.0).all() and (np.abs(ends[:, 1]) <= 1.0).all()


def test_beams_that_are_stopped_at_once_still_show(vehicle):
    sensor = mounted(position=(2.0, 0.0, 0.9))
    found = shown(sensor, vehicle, 500)
    assert found.ends[found.occluded].min() < 0.1
    lines = beams.occluded_lines(sensor, found, np.tile(COLOR, (len(found.ends), 1)))
    length = np.linalg.norm(np.diff(lines.points.reshape(-1, 2, 3), axis=1)[:, 0], axis=1)
    assert length.min() >= beams.STUB_M - 1e-5


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


def test_rings_break_where_the_vehicle_stops_beams(vehicle):
    points, _ = rings(mounted(position=(0.0, 0.0, 1.7)), vehicle, [2])
    assert 0 < len(points) < 360
    assert (np.linalg.norm(points[:, 1] - points[:, 0], axis=1) < 1.0).all()


# A square picture with 90 degrees: its corners stand at one along each axis, sqrt(3) away.
SQUARE = pe.Camera("square", 1000, 1000, math.pi / 2)
WIDE = pe.Camera("wide", 1920, 1080, math.radians(60))


def test_frustum_corners():
    points = frustums.frustum_points(mounted(SQUARE, (1.0, 2.0, 3.0)), math.sqrt(3.0))
    expected = [(1, 2, 3), (2, 3, 4), (2, 1, 4), (2, 1, 2), (2, 3, 2)]
    np.testing.assert_allclose(points[:5], expected, atol=1e-12)
    assert (points[5:, 2] > 4.0).all()  # the mark is above the upper edge


def test_frustum_of_a_turned_camera():
    """Yaw 90 degrees looks to the left, pitch 90 degrees straight down."""
    left = frustums.frustum_points(mounted(SQUARE, (0, 0, 0), (0, 0, 90)), math.sqrt(3.0))
    np.testing.assert_allclose(left[1:5, 1], 1.0, atol=1e-12)
    down = frustums.frustum_points(mounted(SQUARE, (0, 0, 0), (0, 90, 0)), math.sqrt(3.0))
    np.testing.assert_allclose(down[1:5, 2], -1.0, atol=1e-12)


def test_frustum_is_as_wide_as_the_picture():
    points = frustums.frustum_points(mounted(WIDE, (0, 0, 0)), 2.0)
    assert points[1, 1] / points[1, 0] == pytest.approx(math.tan(math.radians(30)))
    assert points[1, 2] / points[1, 1] == pytest.approx(1080 / 1920)
    np.testing.assert_allclose(np.linalg.norm(points[1:5], axis=1), 2.0)


def test_a_drawing_is_lines_and_faces_in_the_right_shapes():
    drawing = kinds.drawing_of("camera")
    lines, faces = (
        f(mounted(SQUARE), 2.0, colors.VIEWPORT) for f in (drawing.lines, drawing.faces)
    )
    assert lines.points.shape == (22, 3) and faces.points.shape == (12, 3)
    for each in (lines, faces):
        assert each.points.dtype == each.colors.dtype == np.float32
        assert each.colors.shape == (len(each.points), 4)
        assert each.points.flags.c_contiguous and each.colors.flags.c_contiguous


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
        along, to = b - a, points - a[:2]
        found &= along[0] * to[:, 1] - along[1] * to[:, 0] >= -1e-9
    return found


@pytest.mark.parametrize(
    "rotation", [(0, 0, 0), (0, 20, 40), (10, 45, -100), (0, 89, 0), (0, -5, 180), (90, 10, 0)]
)
def test_a_footprint_is_the_ground_in_the_picture(rotation):
    """Against every place of a raster, whichever way the camera looks; the horizon included."""
    sensor, far_m = mounted(WIDE, (1.0, -0.5, 1.4), rotation), 12.0
    outline = frustums.footprint(sensor, far_m)
    grid = np.stack(np.meshgrid(*[np.linspace(-14.03, 13.91, 141)] * 2), axis=-1).reshape(-1, 2)
    distance = np.hypot(grid[:, 0] - 1.0, grid[:, 1] + 0.5)
    expected = inside(sensor, grid) & (distance < far_m)
    sure = np.abs(distance - far_m) > 0.02  # the circle has corners
    np.testing.assert_array_equal(in_outline(outline, grid)[sure], expected[sure])
    assert expected.any() and np.abs(outline[:, 2]).max() == 0.0


def test_a_camera_that_looks_up_or_is_below_the_ground_has_no_footprint():
    assert not len(frustums.footprint(mounted(WIDE, (0, 0, 1.4), (0, -40, 0)), 20.0))
    below = frustums.footprint(mounted(WIDE, (0, 0, -0.1)), 20.0)
    assert not len(below)
    assert not len(frustums.footprint_lines(below, (1.0, 1.0, 1.0, 1.0)).points)
    assert not len(frustums.footprint_faces(below, (1.0, 1.0, 1.0, 1.0)).points)


def test_the_area_of_a_footprint_is_filled_once():
    outline = frustums.footprint(mounted(WIDE, (0, 0, 1.4), (0, 30, 10)), 20.0)
    x, y = outline[:, 0], outline[:, 1]
    area = 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    a, b, c = (
        frustums.footprint_faces(outline, (1, 1, 1, 1)).points.reshape(-1, 3, 3).transpose(1, 0, 2)
    )
    filled = 0.5 * float(np.abs(np.cross(b - a, c - a)[:, 2]).sum())
    assert filled == pytest.approx(area, rel=1e-5) and area > 1.0
