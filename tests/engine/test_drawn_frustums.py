"""Frustums are true to lens and pitch; footprints are the ground in the picture."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.graphics import colors, frustums, kinds
from tests.engine.drawn import mounted

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
