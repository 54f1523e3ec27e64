"""Sensors' colours are told apart by all eyes, and none is that of what the vehicle stops."""

from itertools import combinations

import numpy as np
import pytest

from pe_tools.graphics import PAPER, VIEWPORT, colors

EYES = {
    "all cones": np.eye(3),
    "no long": [(0.152, 1.053, -0.205), (0.115, 0.786, 0.099), (-0.004, -0.048, 1.052)],
    "no middle": [(0.367, 0.861, -0.228), (0.280, 0.673, 0.047), (-0.012, 0.043, 0.969)],
    "no short": [(1.256, -0.077, -0.179), (-0.078, 0.931, 0.148), (0.005, 0.691, 0.304)],
}
"""Linear sRGB as it is seen: Machado, Oliveira and Fernandes, 2009, severity 1."""
TO_XYZ = np.array([(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)])
WHITE = np.array([0.9505, 1.0, 1.089])
MIN_DISTANCE = 18.0
"""In CIE Lab; some 2 can just be told side by side."""
MIN_CONTRAST = 3.0
"""Of what is drawn beside its ground: WCAG 2.1, 1.4.11."""


def linear(color):
    """Linear light of an sRGB colour (IEC 61966-2-1)."""
    color = np.asarray(color[:3], float)
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def lab(color, eyes):
    """CIE Lab of a colour as some eyes see it."""
    xyz = TO_XYZ @ np.clip(np.asarray(eyes) @ linear(color), 0.0, 1.0) / WHITE
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


def contrast(color, ground):
    """Contrast ratio of WCAG."""
    low, high = sorted(float(TO_XYZ[1] @ linear(each)) for each in (color, ground))
    return (high + 0.05) / (low + 0.05)


SHADES = {
    "viewport": (colors.SENSOR_COLORS, VIEWPORT.stopped, (0.22, 0.22, 0.22)),
    "paper": (colors.SENSOR_COLORS_ON_PAPER, PAPER.stopped, (0.97, 0.97, 0.97)),
}


@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("shade", SHADES)
def test_any_two_are_reported_apart_and_from_what_is_stopped(shade, eyes):
    own, stopped, _ = SHADES[shade]
    for one, other in combinations([*own, stopped], 2):
        apart = np.linalg.norm(lab(one, EYES[eyes]) - lab(other, EYES[eyes]))
        assert apart > MIN_DISTANCE, (one, other)


@pytest.mark.parametrize("shade", SHADES)
def test_each_stands_out_from_its_ground(shade):
    own, _, ground = SHADES[shade]
    assert min(contrast(color, ground) for color in own) > MIN_CONTRAST


def test_shades_are_of_the_same_sensors():
    assert len(colors.SENSOR_COLORS) == len(colors.SENSOR_COLORS_ON_PAPER)
    assert colors.sensor_color_on_paper(8) == colors.SENSOR_COLORS_ON_PAPER[1]
