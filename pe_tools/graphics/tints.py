"""Colours of sensors: a hue for each kind, a tint for each sensor, kept with the sensor.

Tints are for the viewport's dark grey; a light page draws them darker. Eleven of one kind, and most
mixes of eleven, are told apart by all eyes, those without one kind of cone included (Machado,
Oliveira and Fernandes, IEEE TVCG 15(6), 2009); none is near the colours of occluded beams and of
blind ground. A search for the largest smallest distance in CIE Lab chose them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from pe_core.base.arrays import Floats
from pe_core.scene import Sensor

from .colors import VIEWPORT, Palette, Rgb, linear_of_srgb, srgb_of_linear, with_alpha

TINTS = {
    "lidar": (
        *("#5fb8f7", "#578a94", "#75f3fd", "#758ae9", "#72a7ab", "#acc0e0"),
        *("#92cffe", "#8d93b3", "#98a8c7", "#899cfe", "#567bee"),
    ),
    "camera": (
        *("#e58ac8", "#aa6afd", "#af65c6", "#eeb4c8", "#b1787a", "#9178aa"),
        *("#bf6590", "#f8caeb", "#a699e4", "#bf9396", "#cd8aa8"),
    ),
    "radar": (
        *("#33cc8f", "#caf4e1", "#87a85e", "#98e2b4", "#7efc7c", "#b9dd9d"),
        *("#97c3b4", "#b0fccd", "#55a140", "#9ed2ce", "#b5e6db"),
    ),
}
"""Tints by kind, in the order in which sensors get them: blue, pink, green."""
OTHER_TINTS = (
    *("#88a64a", "#e5edbc", "#beb792", "#808a68", "#f5eaa6", "#d3b34d"),
    *("#9c9e71", "#a5b878", "#d3d4ae", "#d3f58a", "#dccc94"),
)
"""Yellow: tints of ultrasonic sensors and of kinds without a hue of their own."""
FACE_SHARE = 0.6
XYZ_OF_RGB = np.array(
    [(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)]
)
WHITE = np.array([0.9505, 1.0, 1.089])
"""sRGB's primaries and white, D65 (IEC 61966-2-1)."""
LIGHT, DARK = (54.5, 93.0), (16.0, 59.0)
"""Range of the tints' lightness L* on a dark ground, and on a light one."""
LESS, STEPS = 0.95, 60
"""Chroma is reduced by this factor until the colour can be shown; at most so often."""


def tints_of(kind: str) -> tuple[str, ...]:
    """Return the tints of a kind of sensor, the first ones farthest apart."""
    return TINTS.get(kind, OTHER_TINTS)


def free_tint(kind: str, taken: Iterable[str]) -> str:
    """Return the tint for a new sensor of a kind: the first that is taken least often."""
    counts = list(taken)
    return min(tints_of(kind), key=counts.count)


def is_foreign_tint(kind: str, color: str) -> bool:
    """Whether a colour is a tint of another kind."""
    every = {tint for tints in (*TINTS.values(), OTHER_TINTS) for tint in tints}
    return color in every and color not in tints_of(kind)


def rgb_of(color: str) -> Rgb:
    """Return the sRGB values of a colour such as "#5fb8f7", 0 to 1."""
    red, green, blue = (int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return red, green, blue


def color_text(color: Sequence[float]) -> str:
    """Return sRGB values, 0 to 1, as the text of a colour; an alpha is left out."""
    return "#" + "".join(f"{round(255.0 * min(max(v, 0.0), 1.0)):02x}" for v in color[:3])


def sensor_colors(sensors: Iterable[Sensor]) -> dict[str, Rgb]:
    """Return the colour of each sensor of a rig by name, for a dark background.

    Sensors without a colour of their own get the tints of their kind that no other sensor has.
    """
    rig = list(sensors)
    colors = {sensor.name: sensor.color for sensor in rig if sensor.color is not None}
    for sensor in rig:
        if sensor.color is None:
            colors[sensor.name] = free_tint(sensor.kind, colors.values())
    return {sensor.name: rgb_of(colors[sensor.name]) for sensor in rig}


def sensor_colors_on_paper(sensors: Iterable[Sensor]) -> dict[str, Rgb]:
    """Return the colour of each sensor of a rig by name, for a light background."""
    return {name: on_paper(color) for name, color in sensor_colors(sensors).items()}


def sensor_palette(color: Rgb, palette: Palette = VIEWPORT) -> Palette:
    """Return a palette in which all lines of one sensor have that sensor's colour.

    Opacities stay those of the palette, but for sides of views: sensors' colours are light, and
    `FACE_SHARE` of them hides as much. `occluded`, `blind` and the rig's own colours are kept.
    """
    hues = {
        name: with_alpha(color, getattr(palette, name)[3]) for name in ("free", "camera", "other")
    }
    face = with_alpha(color, palette.camera_face[3] * FACE_SHARE)
    return replace(palette, **hues, camera_face=face)


def on_paper(color: Rgb) -> Rgb:
    """Return the darker shade of a colour for a light background: the same hue, CIE Lab."""
    lightness, *chroma = lab_of(color).tolist()
    share = (min(max(lightness, LIGHT[0]), LIGHT[1]) - LIGHT[0]) / (LIGHT[1] - LIGHT[0])
    lightness = DARK[0] + share * (DARK[1] - DARK[0])
    for step in range(STEPS):
        linear = _linear_of_lab([lightness, *(LESS**step * each for each in chroma)])
        if ((linear >= -1e-4) & (linear <= 1.0 + 1e-4)).all():
            break
    red, green, blue = srgb_of_linear(np.clip(linear, 0.0, 1.0)).tolist()
    return red, green, blue


def lab_of(color: ArrayLike) -> Floats:
    """Return the CIE Lab values (3,) of an sRGB colour (3,)."""
    xyz = XYZ_OF_RGB @ linear_of_srgb(np.asarray(color, float)) / WHITE
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


def _linear_of_lab(lab: ArrayLike) -> Floats:
    """Return linear sRGB (3,) of CIE Lab (3,); beyond 0 to 1 where it cannot be shown."""
    lightness, a, b = np.asarray(lab, float)
    y = (lightness + 16.0) / 116.0
    f = np.array([y + a / 500.0, y, y - b / 200.0])
    xyz = np.where(f**3 > 0.008856, f**3, (f - 16.0 / 116.0) / 7.787) * WHITE
    return np.asarray(np.linalg.solve(XYZ_OF_RGB, xyz))
