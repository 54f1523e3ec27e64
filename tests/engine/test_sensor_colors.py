"""Sensors' colours: a hue a kind, tints that all eyes tell apart, kept with the sensor."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.study import study_from_dict, study_to_dict
from pe_tools.graphics import PAPER, VIEWPORT, tints
from pe_tools.graphics.tints import tints_of

EYES = {
    "all cones": np.eye(3),
    "no long": [(0.152, 1.053, -0.205), (0.115, 0.786, 0.099), (-0.004, -0.048, 1.052)],
    "no middle": [(0.367, 0.861, -0.228), (0.280, 0.673, 0.047), (-0.012, 0.043, 0.969)],
    "no short": [(1.256, -0.077, -0.179), (-0.078, 0.931, 0.148), (0.005, 0.691, 0.304)],
}
"""Linear sRGB as it is seen: Machado, Oliveira and Fernandes, 2009, severity 1."""
TO_XYZ = np.array([(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)])
WHITE = np.array([0.9505, 1.0, 1.089])
MIN_DISTANCE = 6.4
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
    "viewport": (lambda color: color, VIEWPORT, (0.22, 0.22, 0.22)),
    "paper": (tints.on_paper, PAPER, (0.97, 0.97, 0.97)),
}
KINDS = ("lidar", "camera", "radar", "ultrasonic")
MIXES = ((11,), (0, 11), (0, 0, 11), (0, 0, 0, 11), (5, 6), (3, 8), (1, 6, 4), (4, 4, 2, 1))
"""Rigs of eleven sensors, by kind: one kind alone, LiDARs and cameras, and mixes."""


def rig_of(counts):
    """Sensors without a colour of their own, so many of each kind."""
    models = [catalog.load(catalog.names(kind)[0]) for kind in KINDS]
    return [
        pe.Sensor(f"{kind} {k}", model)
        for kind, model, count in zip(KINDS, models, counts, strict=False)
        for k in range(count)
    ]


@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("shade", SHADES)
def test_eleven_sensors_are_told_apart_and_from_what_is_occluded_or_blind(shade, eyes):
    shown, palette, _ = SHADES[shade]
    for counts in MIXES:
        own = [shown(color) for color in tints.sensor_colors(rig_of(counts)).values()]
        assert len(own) == 11
        for one, other in combinations([*own, palette.occluded, palette.blind], 2):
            if (one, other) != (palette.occluded, palette.blind):
                apart = np.linalg.norm(lab(one, EYES[eyes]) - lab(other, EYES[eyes]))
                assert apart > MIN_DISTANCE, (counts, one, other)


@pytest.mark.parametrize("shade", SHADES)
def test_each_stands_out_from_its_ground(shade):
    shown, _, ground = SHADES[shade]
    own = [shown(tints.rgb_of(tint)) for kind in KINDS for tint in tints_of(kind)]
    assert len(own) == 44 and min(contrast(color, ground) for color in own) > MIN_CONTRAST


def hue(color):
    """Hue of CIE Lab [deg]."""
    _, a, b = lab(color, EYES["all cones"])
    return np.degrees(np.arctan2(b, a))


def test_a_kind_has_its_hue_and_paper_keeps_it():
    for kind, middle in zip(KINDS, (250.0, 340.0, 150.0, 95.0), strict=True):
        for tint in map(tints.rgb_of, tints_of(kind)):
            assert abs((hue(tint) - middle + 180.0) % 360.0 - 180.0) < 55.0
            shift = (hue(tints.on_paper(tint)) - hue(tint) + 180.0) % 360.0 - 180.0
            assert abs(shift) < 8.0


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


def test_a_study_file_keeps_a_sensor_s_colour_and_its_score():
    plain = {"name": "top", "model": "Pandar64", "position": [0.0, 0.0, 1.7]}
    data = {"sensor": [plain | {"color": "#5fb8f7"}, plain | {"name": "low"}]}
    study = study_from_dict(data)
    assert [sensor.color for sensor in study.rig] == ["#5fb8f7", None]
    assert [row.get("color") for row in study_to_dict(study)["sensor"]] == ["#5fb8f7", None]
    with pytest.raises(pe.InputError, match=r"sensor.*color: expected .*found 'blue'"):
        study_from_dict({"sensor": [plain | {"color": "blue"}]})
