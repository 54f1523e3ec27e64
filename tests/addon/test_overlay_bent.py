"""Views of cameras with lenses of their own: the outline, the ground, and what Blender shows."""

import math

import numpy as np
import pytest

from blender_addon.document.view_camera import WIDEST, shown_fov
from pe_core import Camera, FTheta, KannalaBrandt, Pinhole, Pose, Sensor
from pe_tools.graphics import kinds

LENS = FTheta(fx=1, fy=1, cx=640, cy=483, fov=None, k1=339.7, k2=-32.0, k3=48.3, k4=-7.2)
FISHEYE = Camera("fisheye", 1280, 966, lens=LENS)
OFF = Camera("off", 1000, 1000, lens=Pinhole(500.0, 500.0, 400.0, 500.0))


def test_a_fisheye_s_outline_reaches_behind_it():
    sensor = Sensor("eye", FISHEYE, Pose((2.0, 0.0, 1.0)))
    points = kinds.outline(sensor, 3.0) - (2.0, 0.0, 1.0)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 3.0)
    assert points[:, 0].min() < 0.0 < points[:, 1].max()
    assert len(kinds.frustum_lines(sensor, 3.0).points) > 100
    assert len(kinds.frustum_faces(sensor, 3.0).points) == 3 * 64


def test_the_ground_of_an_off_centre_pinhole():
    """From 2 m up and 45 deg down: from 2 m ahead, 0.8 of that to the left, 1.2 to the right."""
    outline = kinds.footprint(Sensor("eye", OFF, Pose((0.0, 0.0, 2.0))), 50.0)
    near = outline[np.isclose(outline[:, 0], 2.0)]
    assert near[:, 1].max() == pytest.approx(1.6) and near[:, 1].min() == pytest.approx(-2.4)
    assert np.hypot(outline[:, 0], outline[:, 1]).max() == pytest.approx(50.0)


def test_blender_shows_the_pinhole_round_the_field():
    assert shown_fov(OFF) == pytest.approx(2.0 * math.atan(600.0 / 500.0))
    assert shown_fov(FISHEYE) == WIDEST
    tele = Camera("tele", 640, 480, lens=KannalaBrandt(1000.0, 1000.0, 320.0, 240.0))
    assert tele.hfov < shown_fov(tele) < tele.hfov * 1.2
